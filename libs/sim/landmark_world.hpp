#pragma once
/// A steered vehicle among point landmarks, as in Tim Bailey's simulator (OpenSLAM, 2004): the sequence of what it
/// measures.
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "core/source.hpp"
#include "sim/landmark_parameters.hpp"

namespace noctule::sim {

/// Pose and steering angle after one control.
struct ControlStep {
  Pose2 pose;
  double steering = 0.0;  ///< held during the step [rad]
};

/// The true way: the vehicle steers towards each way-point until it is near. Free of noise, independent of any seed.
/// \throws InputError when a way-point cannot be reached: the vehicle would circle it for ever
[[nodiscard]] std::vector<ControlStep> plan_steps(const Pose2& start, const std::vector<Vector2>& waypoints, int loops,
                                                  const SteeredVehicleParameters&);

/// Whether a sensor sees a place: nearer than `max_range`, and ahead of it.
[[nodiscard]] bool sees(const Pose2& sensor, const Vector2& place, double max_range);

/// All of a world that is the same for every seed.
struct LandmarkScene {
  /// \throws InputError when the parameters are not sound
  explicit LandmarkScene(const LandmarkWorldParameters&);

  SteeredVehicleParameters vehicle;
  LandmarkSensorParameters sensor;
  KnownWorld known;
  std::vector<ControlStep> steps;
};

/// Yields an Odometry after each control, and after every `controls_per_scan` of them the GroundTruth and the
/// LandmarkDetections, which may be empty. The true motion is the same for every seed; odometry is made of speed and
/// steering angle with noise, and its covariance is that noise to first order. Each kind of noise has its own stream,
/// and each landmark of a scan its own numbers: the schedule scales the noise, it does not change the draws. A sighting
/// whose range would not come out positive is not made.
class LandmarkWorld : public ObservationSource {
 public:
  /// \throws InputError when the parameters are not sound
  LandmarkWorld(const LandmarkWorldParameters& parameters, std::uint64_t seed)
      : LandmarkWorld(std::make_shared<const LandmarkScene>(parameters), seed) {}
  LandmarkWorld(std::shared_ptr<const LandmarkScene> scene, std::uint64_t seed)
      : scene_(std::move(scene)), seed_(seed) {}

  [[nodiscard]] std::optional<Observation> next() override;
  [[nodiscard]] const KnownWorld& world() const override { return scene_->known; }
  /// The latest LandmarkDetections as somebody knows them who knows the simulator: the same ranges and bearings in the
  /// same order, whatever the kind of sightings, but without clutter, with true identities, and with the covariance of
  /// their own noise, outliers' included.
  [[nodiscard]] const LandmarkDetections& informed() const { return informed_; }

 private:
  [[nodiscard]] Odometry drive();
  [[nodiscard]] LandmarkDetections look();
  void add_clutter(LandmarkDetections&) const;
  [[nodiscard]] LandmarkDetection sighting(double range, double bearing) const;
  void reduce(LandmarkDetection&, bool whole) const;
  [[nodiscard]] std::int64_t utime() const;

  std::shared_ptr<const LandmarkScene> scene_;
  std::uint64_t seed_;
  LandmarkDetections informed_;
  std::size_t step_ = 0;    // controls done
  std::int64_t scans_ = 0;  // begun
  enum class Due { odometry, truth, sightings } due_ = Due::odometry;
};

}  // namespace noctule::sim
