#include "mapping/single_stop.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace noctule::mapping {
namespace {

constexpr int kStopRefinements = 5;
constexpr double kLeastRoom = radians(3.0);  // for a wall's normal
constexpr double kLeastSine = 0.866;         // corners of 60 to 120 degrees
constexpr double kCornerGate = 9.21;         // 99 % of chi-square with 2 degrees of freedom

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

/// Axes of the outermost echoes, from the region's direction [rad].
std::pair<double, double> outermost(const Region& region) {
  double low = kPi, high = -kPi;
  for (const SonarArc& arc : region.echoes) {
    const double turn = wrap(axis_angle(arc) - region.direction);
    low = std::min(low, turn);
    high = std::max(high, turn);
  }
  return {low, high};
}

double extent(const Region& region) {
  const auto [low, high] = outermost(region);
  return high - low;
}

/// Moved to the middle between its outermost axes, since a hand does not turn at a constant rate, and to the median
/// range.
void recentre(Region& region) {
  const auto [low, high] = outermost(region);
  region.direction = wrap(region.direction + 0.5 * (low + high));
  std::vector<double> ranges;
  for (const SonarArc& arc : region.echoes) ranges.push_back(arc.range);
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  region.range = *middle;
}

Region densest(std::span<const SonarArc> arcs, double tolerance) {
  Region best;
  for (const SonarArc& seed : arcs) {
    Region region = region_about(arcs, axis_angle(seed), seed.range, tolerance);
    for (int i = 0; i < kStopRefinements; ++i) {
      recentre(region);
      Region next = region_about(arcs, region.direction, region.range, tolerance);
      if (next.echoes.size() <= region.echoes.size()) break;
      region = std::move(next);
    }
    if (region.echoes.size() > best.echoes.size()) best = std::move(region);
  }
  return best;
}

/// Whole degrees of direction in which there is an echo: a hand that pauses must not outvote one that moves on.
int directions(std::span<const SonarArc> echoes) {
  std::vector<int> degree;
  for (const SonarArc& arc : echoes) degree.push_back(static_cast<int>(std::floor(degrees(axis_angle(arc)))));
  std::sort(degree.begin(), degree.end());
  return static_cast<int>(std::unique(degree.begin(), degree.end()) - degree.begin());
}

/// Directions of echoes from behind the wall, along its normal: a ranger hears the nearest surface.
int contradictions(const Region& region, std::span<const SonarArc> arcs, double tolerance) {
  std::vector<SonarArc> behind;
  for (const SonarArc& arc : arcs) {
    const double turn = wrap(axis_angle(arc) - region.direction);
    if (std::abs(turn) <= 0.5 * arc.half_angle && arc.range > region.range + 2.0 * tolerance) behind.push_back(arc);
  }
  return directions(behind);
}

/// The normal lies in the cones of all echoes, evenly as far as is known.
double direction_variance(const Region& region) {
  const double room = std::max(region.echoes.front().half_angle - 0.5 * extent(region), kLeastRoom);
  return room * room / 3.0;
}

/// Covariance of (range, direction).
Matrix2 covariance_of(const Region& region, double tolerance) {
  const double spread = std::max(region.echoes.front().sigma, tolerance / 3.0);
  return Vector2(spread * spread / static_cast<double>(region.echoes.size()), direction_variance(region)).asDiagonal();
}

WallEstimate wall_of(const Region& region, double tolerance) {
  const Vector2& sensor = region.echoes.front().sensor;
  const Wall wall = transformed({sensor.x(), sensor.y(), 0.0}, {region.range, region.direction});
  const Matrix2 heard = covariance_of(region, tolerance);
  const double at = wall.tangent().dot(sensor), reach = region.range * std::sqrt(heard(1, 1));
  WallEstimate w{.wall = wall, .begin = at - reach, .end = at + reach};
  Matrix2 by_heard = Matrix2::Identity();
  by_heard(0, 1) = at;
  w.covariance = by_heard * heard * by_heard.transpose();
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

/// Whether the region is where the walls of two others meet, as far as their covariances tell.
bool is_corner(const Region& region, const Region& a, const Region& b, double tolerance) {
  const Wall wall_a{a.range, a.direction}, wall_b{b.range, b.direction};
  Matrix2 normals;
  normals << wall_a.normal().transpose(), wall_b.normal().transpose();
  if (std::abs(normals.determinant()) < kLeastSine) return false;
  const Matrix2 inverse = normals.inverse();
  const Vector2 corner = inverse * Vector2(a.range, b.range);
  const double range = corner.norm();
  const Wall towards{0.0, std::atan2(corner.y(), corner.x())};
  Matrix2 to_polar;
  to_polar << towards.normal().transpose(), towards.tangent().transpose() / range;
  Matrix2 covariance = covariance_of(region, tolerance);
  for (const auto& [i, wall, source] : {std::tuple(0, wall_a, &a), std::tuple(1, wall_b, &b)}) {
    Matrix2 by_wall;  // the line moves by d rho along its normal, or turns about the foot of the perpendicular
    by_wall << to_polar * inverse.col(i), -wall.tangent().dot(corner) * (to_polar * inverse.col(i));
    covariance += by_wall * covariance_of(*source, tolerance) * by_wall.transpose();
  }
  const Vector2 error(region.range - range, wrap(region.direction - towards.theta));
  return error.dot(covariance.inverse() * error) < kCornerGate;
}

PointEstimate point_of(const Region& region, double tolerance) {
  const Wall towards{0.0, region.direction};
  PointEstimate p{.position = region.echoes.front().sensor + region.range * towards.normal()};
  Matrix2 by_heard;
  by_heard << towards.normal(), region.range * towards.tangent();
  p.covariance = by_heard * covariance_of(region, tolerance) * by_heard.transpose();
  p.readings = static_cast<int>(region.echoes.size());
  p.stops = 1;
  return p;
}

/// Regions of one stop that are believed, those with most echoes first.
std::vector<Region> regions_of(std::span<const SonarArc> arcs, const SingleStopParameters& p) {
  std::vector<Region> regions;
  std::vector<SonarArc> left(arcs.begin(), arcs.end());
  while (true) {
    Region region = densest(left, p.tolerance);
    if (static_cast<int>(region.echoes.size()) < p.min_readings) return regions;
    std::erase_if(left, [&](const SonarArc& arc) {
      return hears(arc, region.direction) && std::abs(arc.range - region.range) <= p.tolerance;
    });
    if (extent(region) >= p.min_extent &&
        contradictions(region, arcs, p.tolerance) <= p.max_contradiction * directions(region.echoes)) {
      regions.push_back(std::move(region));
    }
  }
}

void add_stop(std::span<const SonarArc> arcs, const SingleStopParameters& p, ContourMap& map) {
  const std::vector<Region> regions = regions_of(arcs, p);
  // Nearest first: a corner is farther away than the walls that meet there.
  std::vector<const Region*> by_range, walls;
  for (const Region& region : regions) by_range.push_back(&region);
  std::sort(by_range.begin(), by_range.end(), [](const Region* a, const Region* b) { return a->range < b->range; });
  for (const Region* region : by_range) {
    const auto meets_any = [&](const Region* a) {
      return std::any_of(walls.begin(), walls.end(),
                         [&](const Region* b) { return is_corner(*region, *a, *b, p.tolerance); });
    };
    if (!std::any_of(walls.begin(), walls.end(), meets_any)) walls.push_back(region);
  }
  for (const Region& region : regions) {
    if (std::find(walls.begin(), walls.end(), &region) != walls.end()) {
      map.walls.push_back(wall_of(region, p.tolerance));
    } else {
      map.points.push_back(point_of(region, p.tolerance));
    }
  }
}

}  // namespace

ContourMap single_stop_map(std::span<const SonarArc> arcs, const SingleStopParameters& parameters) {
  ContourMap map;
  for (std::size_t begin = 0; begin < arcs.size();) {
    std::size_t end = begin + 1;
    while (end < arcs.size() && arcs[end].stop == arcs[begin].stop) ++end;
    add_stop(arcs.subspan(begin, end - begin), parameters, map);
    begin = end;
  }
  return map;
}

}  // namespace noctule::mapping
