#pragma once
/// Scans and where the base was at each, for mapping.
#include <optional>
#include <vector>

#include "core/observations.hpp"
#include "eval/trajectory.hpp"
#include "mapping/contour_mapper.hpp"

namespace noctule::modules {

/// Poses over time, of an estimate, of the truth or of dead reckoning.
class Trajectory {
 public:
  /// How a pose is found between those that are known.
  enum class Between {
    nothing,  ///< only at the very times of known poses
    hold,     ///< the latest one: odometry that says nothing means no motion
    linear    ///< between neighbours at most half a second apart
  };

  explicit Trajectory(Between between) : between_(between) {}

  /// The first pose, unless there is one already.
  void begin(std::int64_t utime, const Pose2& pose) {
    if (poses_.empty()) add(utime, pose);
  }
  /// A pose of a time before the latest is ignored, one of the same time replaces it.
  void add(std::int64_t utime, const Pose2& pose);
  /// The latest pose moved by an increment; the first one moves `start`.
  void move(const Odometry& odometry, const Pose2& start);
  void clear() { poses_.clear(); }

  [[nodiscard]] std::optional<Pose2> at(std::int64_t utime) const;
  [[nodiscard]] const std::vector<eval::TimedPose>& poses() const { return poses_; }

 private:
  Between between_;
  std::vector<eval::TimedPose> poses_;
};

/// The scans whose pose the trajectory knows.
[[nodiscard]] std::vector<mapping::PosedScan> posed_scans(const std::vector<UltrasonicScan>& scans,
                                                          const Trajectory& trajectory);

}  // namespace noctule::modules
