#pragma once
/// A made-up run in the heptagon room, plausible enough to look at: for tests and for work on the report's looks.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rng.hpp"
#include "eval/published_contours.hpp"
#include "report/results.hpp"

namespace noctule::report {

namespace sample {

inline std::vector<eval::TimedPose> drive() {
  const std::vector<Vector2> corners{{0, 0},      {1.5, 0},  {2.22, 0.45}, {2.52, 1.3}, {2.25, 2.0},
                                     {1.1, 2.05}, {0, 1.65}, {-0.05, 0.6}, {0, 0}};
  std::vector<eval::TimedPose> path;
  std::int64_t utime = 1'700'000'000'000'000;
  for (int loop = 0; loop < 2; ++loop) {
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const Vector2 leg = corners[i + 1] - corners[i];
      const int steps = std::max(1, static_cast<int>(leg.norm() / 0.06));
      for (int k = 0; k < steps; ++k) {
        const Vector2 p = corners[i] + leg * (static_cast<double>(k) / steps);
        path.push_back({utime, {p.x(), p.y(), std::atan2(leg.y(), leg.x())}});
        utime += 250'000;
      }
    }
  }
  return path;
}

inline std::vector<eval::TimedPose> drift(const std::vector<eval::TimedPose>& truth, std::uint64_t seed) {
  Rng rng(seed, stream_id("odometry"));
  std::vector<eval::TimedPose> result{truth.front()};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    Pose2 step = between(truth[i - 1].pose, truth[i].pose);
    step.x *= 1.0 + rng.normal(0.01, 0.04);
    step.yaw += rng.normal(0.0009, 0.006);
    result.push_back({truth[i].utime, result.back().pose * step});
  }
  return result;
}

inline std::vector<SlamEstimate> estimates(const std::vector<eval::TimedPose>& truth, std::uint64_t seed) {
  Rng rng(seed, stream_id("estimate"));
  std::vector<SlamEstimate> result;
  Vector3 error = Vector3::Zero();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double growth = 1.0 - std::exp(-static_cast<double>(i) / 30.0);
    const Vector3 sigma = growth * Vector3(0.012, 0.010, 0.009) + Vector3::Constant(1e-4);
    for (int k = 0; k < 3; ++k) error[k] = 0.95 * error[k] + std::sqrt(1 - 0.95 * 0.95) * rng.normal(0, sigma[k]);
    SlamEstimate e;
    e.stamp = {truth[i].utime, static_cast<std::int64_t>(i)};
    e.pose = {truth[i].pose.x + error.x(), truth[i].pose.y + error.y(), wrap(truth[i].pose.yaw + error.z())};
    e.covariance = sigma.cwiseAbs2().asDiagonal();
    e.covariance(0, 1) = e.covariance(1, 0) = 0.4 * sigma.x() * sigma.y();
    e.particles = 100;
    e.effective_sample_size =
        55.0 + 40.0 * std::cos(0.7 * static_cast<double>(i)) * std::exp(-0.01 * static_cast<double>(i % 40));
    e.distinct_particles = 40 + static_cast<int>(rng.index(45));
    e.distinct_ancestors = std::max(1, static_cast<int>(100 * std::exp(-0.04 * static_cast<double>(i))));
    e.nis = std::max(0.05, 1.0 + rng.normal(0, 0.35));
    e.noise_scale = 1.0;
    result.push_back(e);
  }
  return result;
}

inline ContourMap noisy_map(const Room& room, double rho_sigma, double theta_sigma, std::uint64_t seed) {
  Rng rng(seed, stream_id("map"));
  ContourMap map;
  for (const RoomWall& w : room.walls) {
    WallEstimate estimate;
    estimate.wall = {w.wall.rho + rng.normal(0, rho_sigma), wrap(w.wall.theta + rng.normal(0, theta_sigma))};
    estimate.covariance = Vector2(rho_sigma * rho_sigma, theta_sigma * theta_sigma).asDiagonal();
    estimate.begin = w.begin + 0.08;
    estimate.end = w.end - 0.05;
    estimate.readings = 120;
    estimate.stops = 40;
    map.walls.push_back(estimate);
  }
  for (const RoomCylinder& c : room.cylinders) {
    CylinderEstimate estimate;
    estimate.cylinder = {c.cylinder.centre + Vector2(rng.normal(0, rho_sigma), rng.normal(0, rho_sigma)),
                         c.cylinder.radius + rng.normal(0, rho_sigma)};
    estimate.covariance = rho_sigma * rho_sigma * Matrix3::Identity();
    estimate.viewing_angle = 4.2;
    map.cylinders.push_back(estimate);
  }
  return map;
}

/// What an ultrasonic ranger hears of the room along the truth, drawn along dead reckoning.
inline std::vector<Vector2> readings(const Room& room, const std::vector<eval::TimedPose>& truth,
                                     const std::vector<eval::TimedPose>& odometry, std::uint64_t seed) {
  Rng rng(seed, stream_id("readings"));
  std::vector<Vector2> points;
  for (std::size_t i = 0; i < truth.size(); i += 2) {
    for (int beam = 0; beam < 60; ++beam) {
      const double axis = beam * kTwoPi / 60;
      double nearest = 4.0;
      for (const RoomWall& w : room.walls) {
        const double off_axis = std::abs(wrap(w.wall.theta - truth[i].pose.yaw - axis));
        const double foot = w.wall.tangent().dot(truth[i].pose.position());
        if (off_axis > radians(15) || foot < w.begin || foot > w.end) continue;
        nearest = std::min(nearest, w.wall.distance(truth[i].pose.position()));
      }
      for (const RoomCylinder& c : room.cylinders) {
        const Vector2 to = c.cylinder.centre - truth[i].pose.position();
        if (std::abs(wrap(std::atan2(to.y(), to.x()) - truth[i].pose.yaw - axis)) > radians(15)) continue;
        nearest = std::min(nearest, to.norm() - c.cylinder.radius);
      }
      if (nearest >= 4.0 || rng.uniform() < 0.4) continue;
      const double range = nearest + rng.normal(0, 0.01);
      points.push_back(odometry[i].pose * Vector2(range * std::cos(axis), range * std::sin(axis)));
    }
  }
  return points;
}

inline OccupancyImage grid(const Room& room) {
  OccupancyImage image{90, 82, 0.05, {-0.85, -0.85}, {}};
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const Vector2 p = image.origin + image.resolution * Vector2(column + 0.5, row + 0.5);
      double clearance = 10.0;
      for (const RoomWall& w : room.walls) clearance = std::min(clearance, w.wall.distance(p));
      for (const RoomCylinder& c : room.cylinders) {
        const double d = c.cylinder.distance(p);
        if (d < -0.05) clearance = -1.0;
        clearance = std::min(clearance, std::max(d, -0.04));
      }
      image.occupancy.push_back(clearance < -0.05 ? -1.0F : clearance < 0.04 ? 0.9F : 0.08F);
    }
  }
  return image;
}

}  // namespace sample

inline RunData sample_run(std::uint64_t seed = 7) {
  RunData data;
  const Room& room = eval::published_room();
  data.title = "Heptagon room, plain particle filter";
  data.version = "0.1.0";
  data.seed = seed;
  data.config_yaml = "filter:\n  particles: 100  # number of particles\nsource:\n  world: heptagon.yaml\n";
  data.world.name = "heptagon";
  data.world.room = room;
  data.truth = sample::drive();
  data.duration = seconds(data.truth.back().utime - data.truth.front().utime);
  data.dead_reckoning = sample::drift(data.truth, seed);
  data.estimates = sample::estimates(data.truth, seed);
  const auto judged = [&](const ContourMap& map) { return ContourResult{map, eval::contour_errors(map, room)}; };
  data.contours = judged(sample::noisy_map(room, 0.012, 0.014, seed));
  data.contours_known_pose = judged(sample::noisy_map(room, 0.003, 0.003, seed + 1));
  ContourMap lost = sample::noisy_map(room, 0.07, 0.06, seed + 2);
  lost.walls.push_back(lost.walls[3]);
  lost.walls.back().wall.rho -= 0.4;
  data.contours_dead_reckoning = judged(lost);
  data.direct_points = sample::readings(room, data.truth, data.dead_reckoning, seed);
  data.occupancy = sample::grid(room);
  data.metrics = run_metrics(data);
  data.timing = {{"realtime_factor", 2310.0, "1"}, {"wall_time", 0.0631, "s"}, {"latency_p99", 0.00041, "s"}};
  data.modules = {{"source", "finished", 0, 0, 0, 0, 0, 0, "", ""},
                  {"ultrasonic", "finished", 412, 0, 0, 0, 0, 0, "", ""},
                  {"slam", "degraded", 824, 1, 0, 1, 0, 0, "", "one scan came late"}};
  data.notes = {"Dead reckoning is the odometry as the robot reports it."};
  return data;
}

}  // namespace noctule::report
