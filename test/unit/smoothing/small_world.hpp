#pragma once
/// A robot that drives circles among point landmarks, for tests of the smoother.
#include <cstdint>
#include <variant>
#include <vector>

#include "core/gaussian.hpp"
#include "core/source.hpp"

namespace noctule::smoothing {

struct SmallWorld {
  int landmarks = 12;
  double size = 30.0;    ///< landmarks lie in a square of this side about the middle of the circle [m]
  double radius = 10.0;  ///< of the circle [m]
  int scans = 60;
  int steps_per_scan = 4;
  double step = 0.25;                       ///< [m]
  double sensor_range = 15.0;               ///< [m]
  Vector3 odometry_sd{0.01, 0.005, 0.005};  ///< of one step
  Vector2 sighting_sd{0.1, radians(1.0)};
  double noise = 1.0;  ///< 0: the same covariances, but every value is true
  Pose2 sensor_in_base{0.3, 0.1, 0.2};
  Pose2 start{1.0, -2.0, 0.7};
};

struct SmallRun {
  std::vector<Observation> observations;  ///< odometry and sightings
  std::vector<Pose2> truth;               ///< at each scan
  std::vector<Vector2> landmarks;         ///< index = id
};

inline SmallRun drive(const SmallWorld& world, std::uint64_t seed) {
  SmallRun run;
  Rng rng(seed, stream_id("small_world"));
  const Pose2 middle = world.start * Pose2{0.0, world.radius, 0.0};
  for (int i = 0; i < world.landmarks; ++i) {
    const double half = 0.5 * world.size;
    run.landmarks.push_back(middle * Vector2(rng.uniform(-half, half), rng.uniform(-half, half)));
  }
  Pose2 pose = world.start;
  std::int64_t odometries = 0;
  const Pose2 step{world.step, 0.0, world.step / world.radius};
  for (int scan = 0; scan < world.scans; ++scan) {
    for (int i = 0; i < world.steps_per_scan; ++i) {
      pose = pose * step;
      Odometry o;
      o.stamp = {100'000 * (scan + 1), odometries++};
      o.increment = {step.x + world.noise * rng.normal(0.0, world.odometry_sd.x()),
                     step.y + world.noise * rng.normal(0.0, world.odometry_sd.y()),
                     step.yaw + world.noise * rng.normal(0.0, world.odometry_sd.z())};
      o.covariance = world.odometry_sd.cwiseAbs2().asDiagonal();
      run.observations.emplace_back(o);
    }
    run.truth.push_back(pose);
    LandmarkDetections message;
    message.stamp = {100'000 * (scan + 1), scan};
    message.sensor_in_base = world.sensor_in_base;
    for (std::size_t id = 0; id < run.landmarks.size(); ++id) {
      const Vector2 seen = inverse(pose * world.sensor_in_base) * run.landmarks[id];
      if (seen.norm() > world.sensor_range || seen.norm() < 0.5) continue;
      LandmarkDetection d;
      d.range = seen.norm() + world.noise * rng.normal(0.0, world.sighting_sd[0]);
      d.bearing = wrap(std::atan2(seen.y(), seen.x()) + world.noise * rng.normal(0.0, world.sighting_sd[1]));
      d.covariance = world.sighting_sd.cwiseAbs2().asDiagonal();
      d.id = static_cast<std::int64_t>(id);
      message.detections.push_back(d);
    }
    run.observations.emplace_back(message);
  }
  return run;
}

template <class Estimator>
void feed(Estimator& estimator, const std::vector<Observation>& observations) {
  for (const Observation& o : observations) {
    if (const auto* odometry = std::get_if<Odometry>(&o)) estimator.predict(*odometry);
    if (const auto* sightings = std::get_if<LandmarkDetections>(&o)) estimator.update(*sightings);
  }
}

}  // namespace noctule::smoothing
