#pragma once
/// A small world of point landmarks, in the way of Bailey's simulator: a vehicle steered by its front wheels goes round
/// waypoints; the filter hears noisy controls and noisy sightings of what lies ahead.
#include <algorithm>
#include <vector>

#include "core/gaussian.hpp"
#include "core/observations.hpp"
#include "models/motion.hpp"
#include "models/range_bearing.hpp"

namespace noctule::test {

struct LandmarkWorld {
  std::vector<Vector2> landmarks;
  std::vector<Vector2> waypoints;
  double speed = 1.0, wheelbase = 1.0, dt = 0.025;  // m/s, m, s
  double speed_sd = 0.2, steering_sd = radians(4.0);
  double range_sd = 0.2, bearing_sd = radians(2.0);
  double max_range = 30.0;
  int controls_per_scan = 8;
  Pose2 sensor_in_base;
};

/// A web of 35 landmarks over 85 m x 70 m: config/worlds/landmarks/web.yaml at 0.35 of its size.
inline LandmarkWorld small_web() {
  const double waypoints[][2] = {{35, -59},  {83, -54},  {93, -21},  {81, 2},    {95, 34},  {80, 69},
                                 {31, 71},   {5, 88},    {-30, 88},  {-56, 59},  {-95, 39}, {-101, 16},
                                 {-71, -19}, {-87, -54}, {-61, -75}, {-15, -63}, {14, -89}};
  const double landmarks[][2] = {{100, -18}, {-12, -35}, {59, 0},   {85, 23},  {31, -11},   {-104, -49}, {-57, 65},
                                 {-22, 66},  {-74, 12},  {13, -56}, {-54, 39}, {-54, -105}, {1, 68},     {98, -73},
                                 {-30, -62}, {-65, -41}, {68, 18},  {88, -57}, {50, -43},   {-49, -87},  {-75, -79},
                                 {-88, -23}, {-22, -88}, {57, 98},  {103, 76}, {-88, 54},   {7, 19},     {119, -24},
                                 {-57, 2},   {104, 33},  {-22, -9}, {77, 97},  {46, -92},   {107, -46},  {16, -37}};
  LandmarkWorld w;
  for (const auto& [x, y] : waypoints) w.waypoints.push_back(0.35 * Vector2(x, y));
  for (const auto& [x, y] : landmarks) w.landmarks.push_back(0.35 * Vector2(x, y));
  return w;
}

struct LandmarkScanStep {
  std::vector<Odometry> odometry;  ///< since the scan before
  LandmarkDetections detections;
  Pose2 truth;  ///< base in map at the scan
};

/// \param noise 1: as the world says; 0: none, and odometry says so
inline std::vector<LandmarkScanStep> drive(const LandmarkWorld& w, double duration, std::uint64_t seed,
                                           double noise = 1.0, bool known = true) {
  Rng control(seed, stream_id("test.control")), sensor_noise(seed, stream_id("test.sensor"));
  Matrix2 q = Vector2(w.speed_sd * w.speed_sd, w.steering_sd * w.steering_sd).asDiagonal();
  Matrix2 r = Vector2(w.range_sd * w.range_sd, w.bearing_sd * w.bearing_sd).asDiagonal();
  std::vector<LandmarkScanStep> result;
  Pose2 truth;
  double steering = 0.0;
  std::size_t goal = 0;
  std::int64_t seq = 0, odometry_seq = 0;
  LandmarkScanStep step;
  const auto steps = static_cast<int>(duration / w.dt);
  for (int t = 1; t <= steps; ++t) {
    if ((w.waypoints[goal] - truth.position()).norm() < 1.0) goal = (goal + 1) % w.waypoints.size();
    const Vector2 d = w.waypoints[goal] - truth.position();
    const double wanted = wrap(std::atan2(d.y(), d.x()) - truth.yaw - steering);
    const double rate = radians(20.0) * w.dt;
    steering = std::clamp(steering + std::clamp(wanted, -rate, rate), -radians(30.0), radians(30.0));
    truth = models::predict_front_axle(truth, w.speed, steering, w.wheelbase, w.dt).pose;
    const double v = w.speed + noise * control.normal(0.0, w.speed_sd);
    const double g = steering + noise * control.normal(0.0, w.steering_sd);
    const auto moved = models::predict_front_axle({}, v, g, w.wheelbase, w.dt);
    Odometry o;
    o.stamp = {static_cast<std::int64_t>(t * w.dt * 1e6), odometry_seq++};
    o.increment = moved.pose;
    o.covariance = noise * noise * moved.by_control * q * moved.by_control.transpose();
    symmetrise(o.covariance);
    step.odometry.push_back(o);
    if (t % w.controls_per_scan != 0) continue;
    step.truth = truth;
    step.detections.stamp = {o.stamp.utime, seq++};
    step.detections.sensor_in_base = w.sensor_in_base;
    const Pose2 sensor = truth * w.sensor_in_base;
    for (std::size_t k = 0; k < w.landmarks.size(); ++k) {
      const Vector2 z = models::predict_range_bearing(sensor, w.landmarks[k]).z;
      if (z[0] > w.max_range || std::abs(z[1]) > 0.5 * kPi) continue;
      step.detections.detections.push_back({.range = z[0] + noise * sensor_noise.normal(0.0, w.range_sd),
                                            .bearing = wrap(z[1] + noise * sensor_noise.normal(0.0, w.bearing_sd)),
                                            .covariance = r,
                                            .id = known ? static_cast<std::int64_t>(k) : -1});
    }
    result.push_back(step);
    step = {};
  }
  return result;
}

template <class Filter>
void feed(Filter& filter, const LandmarkScanStep& step) {
  for (const Odometry& o : step.odometry) filter.predict(o);
  filter.update(step.detections);
}

}  // namespace noctule::test
