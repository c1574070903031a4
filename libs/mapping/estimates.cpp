#include "mapping/estimates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace noctule::mapping {

double covered_angle(std::vector<double>& directions) {
  if (directions.empty()) return 0.0;
  std::sort(directions.begin(), directions.end());
  double gap = kTwoPi - (directions.back() - directions.front());
  for (std::size_t i = 1; i < directions.size(); ++i) gap = std::max(gap, directions[i] - directions[i - 1]);
  return kTwoPi - gap;
}

Evidence evidence_of(const Reflector& reflector, std::span<const SonarArc> arcs, std::span<const int> members) {
  Evidence e{.readings = static_cast<int>(members.size())};
  if (members.empty()) return e;
  std::vector<int> stops;
  stops.reserve(members.size());
  for (const int i : members) stops.push_back(arcs[static_cast<std::size_t>(i)].stop);
  if (!std::is_sorted(stops.begin(), stops.end())) std::sort(stops.begin(), stops.end());
  e.stops = static_cast<int>(std::unique(stops.begin(), stops.end()) - stops.begin());

  if (reflector.is_wall()) {
    const Vector2 tangent = reflector.tangent();
    e.begin = std::numeric_limits<double>::infinity();
    e.end = -e.begin;
    for (const int i : members) {
      const double at = tangent.dot(arcs[static_cast<std::size_t>(i)].sensor);
      e.begin = std::min(e.begin, at);
      e.end = std::max(e.end, at);
    }
    e.span = e.end - e.begin;
    return e;
  }
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int i : members) {
    const Vector2& sensor = arcs[static_cast<std::size_t>(i)].sensor;
    low = low.cwiseMin(sensor);
    high = high.cwiseMax(sensor);
  }
  e.span = (high - low).norm();
  return e;
}

double viewing_angle_of(const Reflector& round, std::span<const SonarArc> arcs, std::span<const int> members) {
  std::vector<double> directions;
  directions.reserve(members.size());
  for (const int i : members) {
    const Vector2 d = round.sight(arcs[static_cast<std::size_t>(i)].sensor).direction;
    directions.push_back(std::atan2(d.y(), d.x()));
  }
  return covered_angle(directions);
}

WallEstimate wall_estimate(const EchoFit& fit, const Matrix3& covariance, const Evidence& evidence) {
  const Wall wall = fit.reflector.wall();
  WallEstimate w{.wall = normalised(wall),
                 .covariance = covariance.topLeftCorner<2, 2>(),
                 .begin = evidence.begin,
                 .end = evidence.end,
                 .readings = evidence.readings,
                 .stops = evidence.stops};
  if (wall.rho < 0.0) {  // the normal was turned, and with it the tangent and the sign of rho
    w.covariance(0, 1) = w.covariance(1, 0) = -w.covariance(0, 1);
    w.begin = -evidence.end;
    w.end = -evidence.begin;
  }
  return w;
}

}  // namespace noctule::mapping
