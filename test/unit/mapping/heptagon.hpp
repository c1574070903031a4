#pragma once
/// The heptagon room with its two cylinders, driven along the pinned way-points, heard by a stepper scan: a small
/// stand-in for the simulator, which mapping may not include.
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "core/contour.hpp"
#include "core/rng.hpp"
#include "mapping/sonar_arc.hpp"

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

}  // namespace noctule::mapping::heptagon
