#pragma once
/// A small world for tests of filters: walls without ends and cylinders, heard by a turning ranger, and an extractor
/// that always knows which object made an echo.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/features.hpp"
#include "core/observations.hpp"
#include "core/rng.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::test {

struct Scene {
  std::vector<Wall> walls;
  std::vector<Cylinder> cylinders;

  [[nodiscard]] std::size_t objects() const { return walls.size() + cylinders.size(); }

  /// Distance [m] and direction [rad] of an object's echo.
  [[nodiscard]] std::pair<double, double> echo(std::size_t object, const Vector2& p) const {
    if (object < walls.size()) return {walls[object].distance(p), walls[object].theta};
    const Cylinder& c = cylinders[object - walls.size()];
    return {c.distance(p), std::atan2(c.centre.y() - p.y(), c.centre.x() - p.x())};
  }
};

/// Two walls at a right angle and a cylinder between them.
inline Scene corner_scene() {
  return {{{1.5, 0.3}, {2.0, 0.3 + kPi / 2}}, {{Vector2(1.0, -1.3), 0.12}}};
}

struct Heard {
  UltrasonicScan scan;
  std::vector<std::vector<std::int32_t>> beams_of;  ///< beams that heard each object
};

struct Ranger {
  int beams = 60;
  double half_angle = radians(15.0);
  models::RangeNoise noise;  ///< true noise
  bool exact = false;        ///< no noise, and one beam pointed straight at each object instead of the sweep
};

/// The specular first echo in each cone; heard the less often the farther off the axis, so that the directions of
/// echoes scatter about the axis with half the half angle.
inline Heard listen(const Scene& scene, const Pose2& base, std::int64_t seq, const Ranger& ranger, Rng& rng) {
  Heard heard;
  heard.scan.stamp = {seq * 1000000, seq};
  heard.scan.half_angle = ranger.half_angle;
  heard.scan.min_range = 0.02;
  heard.scan.max_range = 10.0;
  heard.beams_of.resize(scene.objects());
  const int beams = ranger.exact ? static_cast<int>(scene.objects()) : ranger.beams;
  for (int b = 0; b < beams; ++b) {
    const double axis = ranger.exact ? wrap(scene.echo(static_cast<std::size_t>(b), base.position()).second - base.yaw)
                                     : kTwoPi * b / beams;
    UltrasonicBeam beam;
    beam.sensor_in_base = {0.0, 0.0, axis};
    std::optional<std::size_t> nearest;
    for (std::size_t k = 0; k < scene.objects(); ++k) {
      const auto [range, direction] = scene.echo(k, base.position());
      const double off = wrap(direction - base.yaw - axis) / ranger.half_angle;
      if (range <= 0.0 || std::abs(off) > 1.0 || (nearest && beam.range < range)) continue;
      nearest = k;
      beam.range = range;
    }
    if (nearest) {
      const double off = wrap(scene.echo(*nearest, base.position()).second - base.yaw - axis) / ranger.half_angle;
      if (!ranger.exact && rng.uniform() > std::exp(-2.0 * off * off)) nearest.reset();
    }
    if (nearest) {
      beam.echo = Echo::hit;
      if (!ranger.exact) beam.range += rng.normal(0.0, ranger.noise.sd(beam.range));
      heard.beams_of[*nearest].push_back(b);
    } else {
      beam.range = 0.0;
      beam.echo = Echo::none;
    }
    heard.scan.beams.push_back(beam);
  }
  return heard;
}

struct ExtractorErrors {
  double range = 0.0;      ///< sd of a surface's distance [m]
  double direction = 0.0;  ///< sd of its direction [rad]
  bool undecided = false;  ///< all features are ambiguous
};

/// A feature for each object with an echo in this scan; it names the readings of `earlier` scans as well, as an
/// extractor with overlapping triples does.
inline ContourFeatures extract(const Scene& scene, const Pose2& base, const Heard& now,
                               const std::vector<Heard>& earlier, const ExtractorErrors& errors, Rng& rng) {
  ContourFeatures result{now.scan.stamp, {}};
  for (std::size_t k = 0; k < scene.objects(); ++k) {
    if (now.beams_of[k].empty()) continue;
    ContourFeature f;
    f.track = static_cast<std::int64_t>(k);
    auto [range, direction] = scene.echo(k, base.position());
    range += rng.normal(0.0, errors.range);
    direction = wrap(direction - base.yaw + rng.normal(0.0, errors.direction));
    const Vector2 along(std::cos(direction), std::sin(direction));
    f.surface = range * along;
    f.stops = static_cast<int>(earlier.size()) + 1;
    for (const Heard& h : earlier) {
      for (const auto b : h.beams_of[k]) f.readings.push_back({h.scan.stamp.seq, b});
    }
    for (const auto b : now.beams_of[k]) f.readings.push_back({now.scan.stamp.seq, b});
    if (k < scene.walls.size()) {
      f.has_wall = true;
      f.wall = {range, direction};
      f.type = ContourType::wall;
    } else {
      const double radius = scene.cylinders[k - scene.walls.size()].radius;
      f.has_circle = true;
      f.circle = {(range + radius) * along, radius};
      f.type = radius > 0.0 ? ContourType::arc : ContourType::point;
    }
    if (errors.undecided) {
      f.type = ContourType::ambiguous;
      f.has_wall = f.has_circle = false;
    }
    result.features.push_back(f);
  }
  return result;
}

/// Stops every `step` metres: straight on, with a turn of `turn` at each.
inline std::vector<Pose2> arc_path(int stops, double step, double turn) {
  std::vector<Pose2> path{Pose2{}};
  for (int i = 1; i < stops; ++i) path.push_back(path.back() * Pose2{step, 0.0, turn});
  return path;
}

}  // namespace noctule::test
