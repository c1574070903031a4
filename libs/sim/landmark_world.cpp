#include "sim/landmark_world.hpp"

#include <cmath>
#include <sstream>

#include "core/check.hpp"
#include "models/motion.hpp"
#include "models/range_bearing.hpp"
#include "sim/landmark_map.hpp"
#include "sim/steering.hpp"

namespace noctule::sim {
namespace {

constexpr std::uint64_t kControl = stream_id("sim.control");
constexpr std::uint64_t kMeasurement = stream_id("sim.measurement");
constexpr std::uint64_t kOutlier = stream_id("sim.outlier");
constexpr std::uint64_t kWhole = stream_id("sim.whole");
constexpr std::uint64_t kClutter = stream_id("sim.clutter");

const LandmarkWorldParameters& sound(const LandmarkWorldParameters& p) {
  require_sound(p, "landmark world '" + p.world.name + "'");
  return p;
}

double turning_radius(const SteeredVehicleParameters& vehicle) {
  return vehicle.wheelbase / std::sin(vehicle.max_steering);
}

[[noreturn]] void refuse_waypoint(const Vector2& place, const SteeredVehicleParameters& vehicle) {
  std::ostringstream out;
  out << "vehicle: expected steering that reaches way-point (" << place.x() << ", " << place.y()
      << ") m, got circles past it (turning radius " << turning_radius(vehicle) << " m, wheels turned at "
      << degrees(vehicle.steering_rate) << " deg/s, " << vehicle.speed << " m/s)";
  throw InputError(out.str());
}

}  // namespace

std::string ScatterParameters::validate() const {
  if ((low.array() < high.array()).all()) return {};
  return "low_m: expected both coordinates below those of high_m";
}

std::string LandmarkSensorParameters::validate() const {
  const std::string problem = models::check_order(schedule);
  return problem.empty() ? "" : "schedule: " + problem;
}

std::vector<ControlStep> plan_steps(const Pose2& start, const std::vector<Vector2>& waypoints, int loops,
                                    const SteeredVehicleParameters& vehicle) {
  // A way-point is out of reach when the detour to it is `kPatience` times as long as the distance and the turning
  // radius, or as `kWideTurn` distances if that is less.
  constexpr double kPatience = 20.0, kWideTurn = 10.0;
  const double dt = 1.0 / vehicle.control_rate;
  std::vector<ControlStep> steps;
  ControlStep now{start, 0.0};
  for (int loop = 0; loop < loops; ++loop) {
    for (const Vector2& place : waypoints) {
      const double distance = (place - now.pose.position()).norm();
      double patience = kPatience * std::min(distance + turning_radius(vehicle), kWideTurn * distance);
      while ((place - now.pose.position()).norm() >= vehicle.waypoint_radius) {
        if (patience < 0.0) refuse_waypoint(place, vehicle);
        now.steering = steer_towards(place, now.pose, now.steering, vehicle.max_steering, vehicle.steering_rate, dt);
        // Composed as dead reckoning composes odometry: without noise the two are equal.
        now.pose = now.pose * models::predict_front_axle({}, vehicle.speed, now.steering, vehicle.wheelbase, dt).pose;
        steps.push_back(now);
        patience -= vehicle.speed * dt;
      }
    }
  }
  return steps;
}

bool sees(const Pose2& sensor, const Vector2& place, double max_range) {
  const Vector2 d = place - sensor.position();
  return d.squaredNorm() < max_range * max_range && d.x() * std::cos(sensor.yaw) + d.y() * std::sin(sensor.yaw) > 0.0;
}

LandmarkScene::LandmarkScene(const LandmarkWorldParameters& parameters)
    : vehicle(sound(parameters).vehicle), sensor(parameters.sensor) {
  LandmarkMapPlaces places = places_of(parameters.world);
  known.name = parameters.world.name;
  known.landmarks = std::move(places.landmarks);
  known.start_in_map = places.start;
  steps = plan_steps(places.start, places.waypoints, parameters.world.loops, vehicle);
  if (steps.size() < static_cast<std::size_t>(sensor.controls_per_scan)) {
    throw InputError("world.waypoints_m: expected a way of at least " + std::to_string(sensor.controls_per_scan) +
                     " controls, which one scan takes, got " + std::to_string(steps.size()));
  }
}

std::optional<Observation> LandmarkWorld::next() {
  switch (due_) {
    case Due::odometry: {
      if (step_ == scene_->steps.size()) return std::nullopt;
      const Odometry odometry = drive();
      if (step_ % static_cast<std::size_t>(scene_->sensor.controls_per_scan) == 0) due_ = Due::truth;
      return odometry;
    }
    case Due::truth:
      due_ = Due::sightings;
      return GroundTruth{{utime(), scans_}, scene_->steps[step_ - 1].pose};
    case Due::sightings:
      break;
  }
  due_ = Due::odometry;
  return look();
}

Odometry LandmarkWorld::drive() {
  const SteeredVehicleParameters& vehicle = scene_->vehicle;
  Rng rng(seed_, kControl, step_);
  const double speed = rng.normal(vehicle.speed, vehicle.speed_sd);
  const double steering = rng.normal(scene_->steps[step_].steering, vehicle.steering_sd);
  const auto motion = models::predict_front_axle({}, speed, steering, vehicle.wheelbase, 1.0 / vehicle.control_rate);
  const Vector2 variances(vehicle.speed_sd * vehicle.speed_sd, vehicle.steering_sd * vehicle.steering_sd);
  const auto seq = static_cast<std::int64_t>(step_++);
  return {{utime(), seq}, motion.pose, motion.by_control * variances.asDiagonal() * motion.by_control.transpose()};
}

LandmarkDetections LandmarkWorld::look() {
  const LandmarkSensorParameters& sensor = scene_->sensor;
  const Pose2& pose = scene_->steps[step_ - 1].pose;
  const double progress = static_cast<double>(step_) / static_cast<double>(scene_->steps.size());
  const double stage = models::noise_factor(sensor.schedule, progress);
  const auto scan = static_cast<std::uint64_t>(scans_);
  LandmarkDetections message{{utime(), scans_}, {}, {}};
  informed_ = message;
  for (const KnownLandmark& landmark : scene_->known.landmarks) {
    if (!sees(pose, landmark.position, sensor.max_range)) continue;
    const auto slot = static_cast<std::uint32_t>(landmark.id);
    const bool outlier = Rng(seed_, kOutlier, scan, slot).uniform() < sensor.outliers;
    const double factor = stage * (outlier ? sensor.outlier_factor : 1.0);
    const Vector2 z = models::predict_range_bearing(pose, landmark.position).z;
    Rng rng(seed_, kMeasurement, scan, slot);
    const double range = rng.normal(z[0], factor * sensor.range_sd);
    const double bearing = rng.normal(z[1], factor * sensor.bearing_sd);
    if (range <= 0.0) continue;
    LandmarkDetection& told = message.detections.emplace_back(sighting(range, wrap(bearing)));
    LandmarkDetection& known = informed_.detections.emplace_back(told);
    known.covariance *= factor * factor;
    known.id = landmark.id;
    if (sensor.known_ids) told.id = landmark.id;
    reduce(told, Rng(seed_, kWhole, scan, slot).uniform() < sensor.whole);
  }
  add_clutter(message);
  ++scans_;
  return message;
}

/// Even over the half disc in view; their number is Poisson distributed.
void LandmarkWorld::add_clutter(LandmarkDetections& message) const {
  const LandmarkSensorParameters& sensor = scene_->sensor;
  if (sensor.clutter <= 0.0) return;
  Rng rng(seed_, kClutter, static_cast<std::uint64_t>(scans_));
  for (double time = -std::log(rng.uniform()); time < sensor.clutter; time -= std::log(rng.uniform())) {
    const double range = sensor.max_range * std::sqrt(rng.uniform());
    message.detections.push_back(sighting(range, rng.uniform(-kPi / 2, kPi / 2)));
    const auto slot = static_cast<std::uint32_t>(message.detections.size());
    reduce(message.detections.back(),
           Rng(seed_, kWhole, ~static_cast<std::uint64_t>(scans_), slot).uniform() < sensor.whole);
  }
}

/// To what sightings of its kind measure.
void LandmarkWorld::reduce(LandmarkDetection& d, bool whole) const {
  const DetectionKind kind = scene_->sensor.kind;
  if (whole || kind == DetectionKind::range_bearing) return;
  d.kind = kind;
  const Eigen::Index lost = kind == DetectionKind::bearing_only ? 0 : 1;
  (lost == 0 ? d.range : d.bearing) = 0.0;
  d.covariance.row(lost).setZero();
  d.covariance.col(lost).setZero();
}

LandmarkDetection LandmarkWorld::sighting(double range, double bearing) const {
  const LandmarkSensorParameters& sensor = scene_->sensor;
  LandmarkDetection d;
  d.range = range;
  d.bearing = bearing;
  d.covariance.diagonal() << sensor.range_sd * sensor.range_sd, sensor.bearing_sd * sensor.bearing_sd;
  return d;
}

std::int64_t LandmarkWorld::utime() const {
  return std::llround(1e6 * static_cast<double>(step_) / scene_->vehicle.control_rate);
}

}  // namespace noctule::sim
