#pragma once
/// The heptagon room with its two cylinders, driven along the pinned way-points, heard by a stepper scan: a small
/// stand-in for the simulator, which mapping may not include.
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "core/contour.hpp"
#include "core/rng.hpp"
#include "mapping/line_fit.hpp"
#include "mapping/sonar_arc.hpp"
#include "models/odometry.hpp"

namespace noctule::mapping::heptagon {

/// Noise of the ranger; the defaults are the pinned world's.
struct SensorNoise {
  double scale = 1.0;            ///< of all range noise
  bool schedule = true;          ///< times 1, 4, 2 over the thirds of the run
  double heavy_fraction = 0.15;  ///< of pings with five times the noise
  double outliers = 0.02;
  double quantum = 0.003;       ///< [m], 0: none
  double range_error = 1.002;   ///< constant factor
  bool certain_echoes = false;  ///< every ping that can be heard is heard

  static SensorNoise none() {
    return {.scale = 0.0, .heavy_fraction = 0.0, .outliers = 0.0, .quantum = 0.0, .range_error = 1.0};
  }
  static SensorNoise gaussian() {
    return {.schedule = false, .heavy_fraction = 0.0, .outliers = 0.0, .quantum = 0.0, .range_error = 1.0};
  }
};

inline Room room() {
  constexpr std::array<std::array<double, 2>, 7> lines{
      {{60, 270}, {207.846, 330}, {300, 360}, {353.06, 30}, {263.82, 90}, {144.853, 144}, {60, 180}}};
  constexpr std::array<std::array<double, 2>, 7> vertices{{{205.359, -60},
                                                           {300, 103.923},
                                                           {300, 186.505},
                                                           {255.362, 263.82},
                                                           {12.628, 263.82},
                                                           {-60, 163.856},
                                                           {-60, -60}}};
  Room room;
  for (std::size_t i = 0; i < 7; ++i) {
    const Wall wall{lines[i][0] / 100.0, wrap(radians(lines[i][1]))};
    const auto along = [&](std::size_t v) {
      return wall.tangent().dot(Vector2(vertices[v][0] / 100.0, vertices[v][1] / 100.0));
    };
    const double a = along(i), b = along((i + 6) % 7);
    room.walls.push_back({"wall " + std::to_string(i + 1), wall, std::min(a, b), std::max(a, b)});
  }
  room.cylinders = {{"cylinder 1", {{0.60, 0.60}, 0.106346}}, {"cylinder 2", {{1.80, 1.20}, 0.14444}}};
  return room;
}

inline const Vector2 kCorner{-0.60, -0.60};  ///< the only right angle: it echoes like a point

/// Poses of the stops: ten at the origin, then every 12 cm, two loops.
inline std::vector<Pose2> stops(int loops = 2) {
  const std::vector<Vector2> way{{0, 0},       {1.50, 0},    {2.22, 0.45}, {2.52, 1.30},
                                 {2.25, 2.00}, {1.10, 2.05}, {0, 1.65},    {-0.05, 0.60}};
  std::vector<Pose2> poses(10);
  double next = 0.12, gone = 0.0;
  for (int leg = 0; leg < loops * static_cast<int>(way.size()); ++leg) {
    const Vector2 from = way[leg % way.size()], to = way[(leg + 1) % way.size()];
    const Vector2 d = (to - from).normalized();
    const double length = (to - from).norm();
    for (; next <= gone + length; next += 0.12) {
      const Vector2 p = from + (next - gone) * d;
      poses.push_back({p.x(), p.y(), std::atan2(d.y(), d.x())});
    }
    gone += length;
  }
  return poses;
}

/// A reflector that a ping could hear: its distance and how far off the axis it lies.
struct Heard {
  double range;
  double angle;
};

inline std::vector<Heard> audible(const Room& room, const Vector2& p, double axis, double half_angle) {
  std::vector<Heard> heard;
  const auto add = [&](double range, double direction) {
    const double angle = std::abs(wrap(direction - axis));
    if (range > 0.0 && angle <= half_angle) heard.push_back({range, angle});
  };
  for (const RoomWall& w : room.walls) {
    const double foot = w.wall.tangent().dot(p);
    if (foot > w.begin - 0.005 && foot < w.end + 0.005) add(w.wall.distance(p), w.wall.theta);
  }
  for (const RoomCylinder& c : room.cylinders) {
    const Vector2 d = c.cylinder.centre - p;
    add(c.cylinder.distance(p), std::atan2(d.y(), d.x()));
  }
  const Vector2 d = kCorner - p;
  add(d.norm(), std::atan2(d.y(), d.x()));
  std::sort(heard.begin(), heard.end(), [](const Heard& a, const Heard& b) { return a.range < b.range; });
  return heard;
}

/// Range of one ping, or nothing. `noise_factor` is the schedule's.
inline std::optional<double> ping(const std::vector<Heard>& heard, double half_angle, const SensorNoise& noise,
                                  double noise_factor, Rng& rng) {
  std::optional<double> range;
  for (const Heard& h : heard) {
    const double a = h.angle / half_angle;
    const double p_hit = 0.98 * std::exp(-2.0 * a * a) * std::max(0.0, 1.0 - std::pow(h.range / 4.0, 4));
    if (!noise.certain_echoes && rng.uniform() > p_hit) continue;
    range = h.range;
    break;
  }
  if (!range) return {};
  const double sd =
      noise.scale * noise_factor * (0.003 + 0.005 * *range) * (rng.uniform() < noise.heavy_fraction ? 5 : 1);
  if (rng.uniform() < noise.outliers) {
    range = rng.uniform() < 0.5 ? rng.uniform(0.02, *range) : 2.0 * *range;
  } else {
    range = *range * noise.range_error + rng.normal(0.0, sd);
  }
  if (noise.quantum > 0.0) range = noise.quantum * std::round(*range / noise.quantum);
  if (*range < 0.02 || *range > 4.0) return {};
  return range;
}

/// Scans of the whole drive with their true poses: 60 pings, 6 degrees apart, half cone 15 degrees.
inline std::vector<PosedScan> drive(const SensorNoise& noise, std::uint64_t seed, int loops = 2) {
  const Room world = room();
  const std::vector<Pose2> poses = stops(loops);
  std::vector<PosedScan> scans;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    Rng rng(seed, stream_id("test.heptagon"), k);
    PosedScan posed{
        .scan = {.stamp = {.utime = static_cast<std::int64_t>(k) * 1000000, .seq = static_cast<std::int64_t>(k)},
                 .half_angle = radians(15.0),
                 .min_range = 0.02,
                 .max_range = 4.0,
                 .beams = {}},
        .base_in_map = poses[k]};
    constexpr std::array<double, 3> factors{1.0, 4.0, 2.0};
    const double factor = noise.schedule ? factors[3 * k / poses.size()] : 1.0;
    for (int i = 0; i < 60; ++i) {
      const Pose2 sensor{0.0, 0.0, wrap(radians(6.0 * i))};
      const auto heard = audible(world, poses[k].position(), poses[k].yaw + sensor.yaw, posed.scan.half_angle);
      const auto range = ping(heard, posed.scan.half_angle, noise, factor, rng);
      posed.scan.beams.push_back({sensor, range.value_or(0.0), range ? Echo::hit : Echo::none});
    }
    scans.push_back(std::move(posed));
  }
  return scans;
}

/// Points on the contours, 2 cm apart, with Gaussian noise of `sigma` [m]; and `clutter` per contour point somewhere in
/// the room.
inline std::vector<PointWithCovariance> outline(double sigma, double clutter, std::uint64_t seed) {
  Rng rng(seed, stream_id("test.outline"));
  std::vector<PointWithCovariance> points;
  const Room world = room();
  const auto add = [&](const Vector2& p) {
    points.push_back({p + sigma * Vector2(rng.normal(), rng.normal()), sigma * sigma * Matrix2::Identity()});
    if (rng.uniform() >= clutter) return;
    points.push_back({{rng.uniform(-0.6, 3.0), rng.uniform(-0.6, 2.6)}, sigma * sigma * Matrix2::Identity()});
  };
  constexpr double kStep = 0.02;
  for (const RoomWall& w : world.walls) {
    for (double s = w.begin; s < w.end; s += kStep) add(w.wall.rho * w.wall.normal() + s * w.wall.tangent());
  }
  for (const RoomCylinder& c : world.cylinders) {
    for (double a = 0.0; a < kTwoPi; a += kStep / c.cylinder.radius) {
      add(c.cylinder.centre + c.cylinder.radius * Vector2(std::cos(a), std::sin(a)));
    }
  }
  return points;
}

/// The same scans with the poses that wheel odometry gives: steps err by a fraction of their length, each turn and each
/// metre by some angle (models::OdometryNoise).
inline std::vector<PosedScan> dead_reckoned(std::vector<PosedScan> scans, const models::OdometryNoise& noise,
                                            std::uint64_t seed) {
  Rng rng(seed, stream_id("test.odometry"));
  Pose2 truth = scans.front().base_in_map, estimate = truth;
  for (PosedScan& posed : scans) {
    Pose2 step = between(truth, posed.base_in_map);
    truth = posed.base_in_map;
    const double length = step.position().norm();
    if (length > 0.0) {
      if (std::abs(step.yaw) > 1e-9) step.yaw += rng.normal(0.0, noise.turn);
      step.x *= 1.0 + rng.normal(0.0, noise.distance);
      step.yaw += rng.normal(0.0, noise.drift * std::sqrt(length));
    }
    estimate = estimate * step;
    posed.base_in_map = estimate;
  }
  return scans;
}

/// The same scans with errors of the poses that come and go slowly, as those of a SLAM filter: a first-order
/// Gauss-Markov process along the stops, from no error at the start.
inline std::vector<PosedScan> wandering(std::vector<PosedScan> scans, double position_sd, double yaw_sd,
                                        std::uint64_t seed) {
  constexpr double kKept = 0.97;  // of the error from stop to stop
  Rng rng(seed, stream_id("test.wandering"));
  Vector3 error = Vector3::Zero();
  const double fresh = std::sqrt(1.0 - kKept * kKept);
  for (std::size_t k = 10; k < scans.size(); ++k) {
    error = kKept * error +
            fresh * Vector3(rng.normal(0.0, position_sd), rng.normal(0.0, position_sd), rng.normal(0.0, yaw_sd));
    Pose2& pose = scans[k].base_in_map;
    pose = {pose.x + error.x(), pose.y + error.y(), wrap(pose.yaw + error.z())};
  }
  return scans;
}

/// A map against the room. A wall is found when |d rho| / 5 cm + |d theta| / 5 deg < 3, a cylinder when its centre is
/// within 30 cm; each estimate counts once.
struct Score {
  int walls_found = 0, walls_invented = 0, cylinders_found = 0, cylinders_invented = 0;
  double rho = 0.0, theta = 0.0;          ///< mean absolute errors over walls 2 to 7 that were found [m], [rad]
  double max_rho = 0.0, max_theta = 0.0;  ///< over all walls
  double cylinder = 0.0;                  ///< mean of |dx|, |dy|, |dR| [m]
  double max_cylinder = 0.0;
  [[nodiscard]] bool complete() const {
    return walls_found == 7 && walls_invented == 0 && cylinders_found == 2 && cylinders_invented == 0;
  }
};

inline Score score(const ContourMap& map) {
  const Room world = room();
  Score s;
  std::vector<char> used(map.walls.size(), 0);
  int counted = 0;
  for (std::size_t t = 0; t < world.walls.size(); ++t) {
    int best = -1;
    double least = 3.0;
    Vector2 error = Vector2::Zero();
    for (std::size_t i = 0; i < map.walls.size(); ++i) {
      const Vector2 e(map.walls[i].wall.rho - world.walls[t].wall.rho,
                      wrap(map.walls[i].wall.theta - world.walls[t].wall.theta));
      const double cost = std::abs(e[0]) / 0.05 + std::abs(e[1]) / radians(5.0);
      if (used[i] != 0 || cost >= least) continue;
      best = static_cast<int>(i);
      least = cost;
      error = e.cwiseAbs();
    }
    if (best < 0) continue;
    used[static_cast<std::size_t>(best)] = 1;
    ++s.walls_found;
    s.max_rho = std::max(s.max_rho, error[0]);
    s.max_theta = std::max(s.max_theta, error[1]);
    if (t == 0) continue;
    ++counted;
    s.rho += error[0];
    s.theta += error[1];
  }
  s.rho /= std::max(1, counted);
  s.theta /= std::max(1, counted);
  s.walls_invented = static_cast<int>(map.walls.size()) - s.walls_found;
  for (const RoomCylinder& truth : world.cylinders) {
    for (const CylinderEstimate& c : map.cylinders) {
      const Vector2 d = c.cylinder.centre - truth.cylinder.centre;
      if (d.norm() > 0.30) continue;
      const Vector3 e(std::abs(d.x()), std::abs(d.y()), std::abs(c.cylinder.radius - truth.cylinder.radius));
      ++s.cylinders_found;
      s.cylinder += e.mean() / 2.0;
      s.max_cylinder = std::max(s.max_cylinder, e.maxCoeff());
      break;
    }
  }
  s.cylinders_invented = static_cast<int>(map.cylinders.size()) - s.cylinders_found;
  return s;
}

}  // namespace noctule::mapping::heptagon
