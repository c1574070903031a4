#include "mapping/sonar_arc.hpp"

#include <algorithm>
#include <ostream>
#include <sstream>

#include "core/error.hpp"

namespace noctule::mapping {
namespace {

constexpr double kMedianOfNormal = 0.674489750;  // of |N(0, 1)|

std::ostream& operator<<(std::ostream& out, const Pose2& pose) {
  return out << '(' << pose.x << ", " << pose.y << ", " << pose.yaw << ')';
}

template <class... Words>
[[noreturn]] void refuse(const UltrasonicScan& scan, const Words&... words) {
  std::ostringstream line;
  line << "mapping: scan " << scan.stamp.seq << ": ";
  (line << ... << words);
  throw InputError(line.str());
}

/// Whether two pings were sent from about the same place in about the same direction, and heard.
bool overlap(const UltrasonicBeam& a, const UltrasonicBeam& b, double half_angle) {
  constexpr double kSamePlace = 0.02;  // [m]
  return a.echo == Echo::hit && b.echo == Echo::hit &&
         std::abs(wrap(a.sensor_in_base.yaw - b.sensor_in_base.yaw)) < half_angle &&
         (a.sensor_in_base.position() - b.sensor_in_base.position()).norm() < kSamePlace;
}

}  // namespace

void check(const UltrasonicScan& scan, const Pose2& base_in_map) {
  if (!base_in_map.finite()) refuse(scan, "base_in_map: expected finite numbers, got ", base_in_map);
  if (!(scan.half_angle > 0.0 && scan.half_angle < kPi / 2.0)) {
    refuse(scan, "half_angle: expected an angle between 0 and pi/2 rad, got ", scan.half_angle);
  }
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    const UltrasonicBeam& beam = scan.beams[i];
    if (beam.echo != Echo::hit) continue;
    if (!beam.sensor_in_base.finite()) {
      refuse(scan, "beam ", i, ": sensor_in_base: expected finite numbers, got ", beam.sensor_in_base);
    }
    if (!(beam.range > 0.0 && std::isfinite(beam.range))) {
      refuse(scan, "beam ", i, ": range: expected a positive number of metres, got ", beam.range);
    }
  }
}

void NoiseScale::observe(double range, double neighbour, double sigma) {
  differences_[seen_ % kWindow] = std::abs(range - neighbour) / (std::numbers::sqrt2 * sigma);
  ++seen_;
}

double NoiseScale::value() const {
  if (seen_ < kWindow / 2) return 1.0;
  std::array<double, kWindow> sorted = differences_;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(std::min(seen_, kWindow));
  const auto middle = sorted.begin() + (end - sorted.begin()) / 2;
  std::nth_element(sorted.begin(), middle, end);
  return std::clamp(*middle / kMedianOfNormal, 1.0, std::max(1.0, largest_));
}

void ArcReader::read(const UltrasonicScan& scan, const Pose2& base_in_map, std::vector<SonarArc>& arcs) {
  check(scan, base_in_map);
  if (stop_ < 0 || (base_in_map.position() - stop_position_).norm() > stop_distance_) {
    ++stop_;
    stop_position_ = base_in_map.position();
  }
  for (std::size_t i = 1; i < scan.beams.size(); ++i) {
    if (overlap(scan.beams[i - 1], scan.beams[i], scan.half_angle)) {
      const double range = scan.beams[i].range, neighbour = scan.beams[i - 1].range;
      scale_.observe(range, neighbour, noise_.sd(0.5 * (range + neighbour)));
    }
  }
  const double scale = scale_.value();
  for (const UltrasonicBeam& beam : scan.beams) {
    if (beam.echo != Echo::hit) continue;
    const Pose2 sensor = base_in_map * beam.sensor_in_base;
    arcs.push_back({.sensor = sensor.position(),
                    .axis = {std::cos(sensor.yaw), std::sin(sensor.yaw)},
                    .range = beam.range,
                    .sigma = scale * noise_.sd(beam.range),
                    .half_angle = scan.half_angle,
                    .stop = stop_});
  }
}

std::vector<Vector2> direct_points(std::span<const PosedScan> scans) {
  ArcReader reader({}, 0.0, 1.0);
  std::vector<SonarArc> arcs;
  for (const PosedScan& posed : scans) reader.read(posed.scan, posed.base_in_map, arcs);
  std::vector<Vector2> points;
  points.reserve(arcs.size());
  for (const SonarArc& arc : arcs) points.push_back(arc.sensor + arc.range * arc.axis);
  return points;
}

}  // namespace noctule::mapping
