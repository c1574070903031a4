#pragma once
/// Landmarks as they lie along a path that nobody doubts: the map of dead reckoning, and of the true path.
#include <memory>

#include "core/estimate.hpp"
#include "core/observations.hpp"

namespace noctule::filters {
class SlamFilter;
}

namespace noctule::experiment {

/// FastSLAM 1 with one particle and odometry that does not err.
class PathMapper {
 public:
  explicit PathMapper(const Pose2& start);
  ~PathMapper();

  /// \param pose of the base at the sightings, in the map
  void take(const LandmarkDetections& sightings, const Pose2& pose);
  [[nodiscard]] LandmarkMap map() const;

 private:
  std::unique_ptr<filters::SlamFilter> filter_;
  Pose2 at_;
};

}  // namespace noctule::experiment
