#pragma once
/// A robot with ultrasonic rangers, and perhaps a camera, in a polygonal room: the sequence of what it measures.
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/source.hpp"
#include "sim/camera.hpp"
#include "sim/drive.hpp"
#include "sim/sonar.hpp"

namespace noctule::sim {

/// Yields an Odometry and the GroundTruth after each motion, and at each stop, when the scan is complete, the
/// GroundTruth and the UltrasonicScan. A camera adds a CameraImage, at each stop or while moving. The true motion is
/// the same for every seed; odometry and ranges are noisy, and the covariance reported with an increment is that of the
/// noise in it.
class Simulator : public ObservationSource {
 public:
  /// \throws InputError when the parameters are not sound
  Simulator(const WorldParameters&, const RobotParameters&, std::uint64_t seed);

  [[nodiscard]] std::optional<Observation> next() override;
  [[nodiscard]] const KnownWorld& world() const override { return known_; }

 private:
  void move();
  void listen();
  [[nodiscard]] CameraImage shoot(const Motion* motion);
  [[nodiscard]] GroundTruth truth();
  [[nodiscard]] std::int64_t utime() const;

  KnownWorld known_;
  std::vector<models::NoiseStage> schedule_;
  double scan_duration_;
  std::uint64_t seed_;
  std::vector<Motion> motions_;
  Sonar sonar_;
  double duration_ = 0.0;  // of the whole run [s]

  double time_ = 0.0;
  Pose2 pose_;
  std::size_t next_motion_ = 0;
  int scans_due_;  // at this stop
  std::int64_t scans_ = 0;
  std::int64_t truths_ = 0;
  std::optional<Camera> camera_;
  double next_picture_ = 0.0;  // not before this time [s]
  std::int64_t pictures_ = 0;
  std::deque<Observation> ready_;  // of the same utime
};

}  // namespace noctule::sim
