#include "mapping/single_stop.hpp"

#include <algorithm>
#include <cmath>

namespace noctule::mapping {
namespace {

constexpr int kRefinements = 5;

/// A region of constant depth about (direction, range) and the echoes in it.
struct Region {
  double direction = 0.0;  ///< [rad]
  double range = 0.0;      ///< [m]
  std::vector<SonarArc> echoes;
};

double axis_angle(const SonarArc& arc) {
  return std::atan2(arc.axis.y(), arc.axis.x());
}

/// Whether the normal of a wall in `direction` lies in the cone of the echo.
bool hears(const SonarArc& arc, double direction) {
  return std::abs(wrap(axis_angle(arc) - direction)) <= arc.half_angle;
}

Region region_about(std::span<const SonarArc> arcs, double direction, double range, double tolerance) {
  Region region{direction, range, {}};
  for (const SonarArc& arc : arcs) {
    if (hears(arc, direction) && std::abs(arc.range - range) <= tolerance) region.echoes.push_back(arc);
  }
  return region;
}

/// Moved to the mean axis and the median range of its own echoes.
void recentre(Region& region) {
  double turn = 0.0;
  std::vector<double> ranges;
  for (const SonarArc& arc : region.echoes) {
    turn += wrap(axis_angle(arc) - region.direction);
    ranges.push_back(arc.range);
  }
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  region.direction = wrap(region.direction + turn / static_cast<double>(region.echoes.size()));
  region.range = *middle;
}

Region densest(std::span<const SonarArc> arcs, double tolerance) {
  Region best;
  for (const SonarArc& seed : arcs) {
    Region region = region_about(arcs, axis_angle(seed), seed.range, tolerance);
    for (int i = 0; i < kRefinements; ++i) {
      recentre(region);
      Region next = region_about(arcs, region.direction, region.range, tolerance);
      if (next.echoes.size() <= region.echoes.size()) break;
      region = std::move(next);
    }
    if (region.echoes.size() > best.echoes.size()) best = std::move(region);
  }
  return best;
}

double extent(const Region& region) {
  double low = 0.0, high = 0.0;
  for (const SonarArc& arc : region.echoes) {
    const double turn = wrap(axis_angle(arc) - region.direction);
    low = std::min(low, turn);
    high = std::max(high, turn);
  }
  return high - low;
}

/// Echoes from behind the wall, along its normal: a ranger hears the nearest surface.
int contradictions(const Region& region, std::span<const SonarArc> arcs, double tolerance) {
  return static_cast<int>(std::count_if(arcs.begin(), arcs.end(), [&](const SonarArc& arc) {
    return std::abs(wrap(axis_angle(arc) - region.direction)) <= 0.5 * arc.half_angle &&
           arc.range > region.range + 2.0 * tolerance;
  }));
}

/// Pings answer with a probability that falls off like a Gaussian of sd half/2 about the normal; the normal lies in the
/// cones of all of them.
double direction_variance(const Region& region) {
  const double half_angle = region.echoes.front().half_angle;
  const double profile = 0.5 * half_angle, room = std::max(half_angle - 0.5 * extent(region), radians(1.5));
  return 1.0 / (static_cast<double>(region.echoes.size()) / (profile * profile) + 3.0 / (room * room));
}

WallEstimate wall_of(const Region& region, double tolerance) {
  const SonarArc& first = region.echoes.front();
  const double n = static_cast<double>(region.echoes.size());
  const Vector2& sensor = first.sensor;
  const Wall from_sensor{region.range, region.direction};
  const Wall wall = transformed({sensor.x(), sensor.y(), 0.0}, from_sensor);
  const double theta_variance = direction_variance(region);
  const double spread = std::max(first.sigma, tolerance / 3.0);
  const double at = wall.tangent().dot(sensor), reach = region.range * std::sqrt(theta_variance);
  WallEstimate w{.wall = wall, .begin = at - reach, .end = at + reach};
  w.covariance << spread * spread / n + at * at * theta_variance, at * theta_variance, at * theta_variance,
      theta_variance;
  w.readings = static_cast<int>(region.echoes.size());
  w.stops = 1;
  if (wall.rho < 0.0) {  // the normal is turned, and with it the tangent and the sign of rho
    w.wall = normalised(wall);
    w.covariance(0, 1) = w.covariance(1, 0) = -w.covariance(0, 1);
    w.begin = -at - reach;
    w.end = -at + reach;
  }
  return w;
}

void walls_of_stop(std::span<const SonarArc> arcs, const SingleStopParameters& p, std::vector<WallEstimate>& walls) {
  std::vector<SonarArc> left(arcs.begin(), arcs.end());
  while (true) {
    const Region region = densest(left, p.tolerance);
    const int readings = static_cast<int>(region.echoes.size());
    if (readings < p.min_readings) return;
    const bool believed =
        extent(region) >= p.min_extent && contradictions(region, arcs, p.tolerance) <= p.max_contradiction * readings;
    if (believed) walls.push_back(wall_of(region, p.tolerance));
    std::erase_if(left, [&](const SonarArc& arc) {
      return hears(arc, region.direction) && std::abs(arc.range - region.range) <= p.tolerance;
    });
  }
}

}  // namespace

std::vector<WallEstimate> single_stop_walls(std::span<const SonarArc> arcs, const SingleStopParameters& parameters) {
  std::vector<WallEstimate> walls;
  for (std::size_t begin = 0; begin < arcs.size();) {
    std::size_t end = begin + 1;
    while (end < arcs.size() && arcs[end].stop == arcs[begin].stop) ++end;
    walls_of_stop(arcs.subspan(begin, end - begin), parameters, walls);
    begin = end;
  }
  return walls;
}

}  // namespace noctule::mapping
