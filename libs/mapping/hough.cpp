#include "mapping/hough.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mapping/circle_fit.hpp"
#include "mapping/estimates.hpp"

namespace noctule::mapping {
namespace {

constexpr int kMaxPeaksInVain = 20;     // peaks tried in vain before giving up
constexpr int kFitRounds = 3;           // of the inliers and the fit to them
constexpr double kLineWindow = 0.08;    // residuals allowed at a peak [m]
constexpr double kPointGate = 3.0;      // and later, for points, in standard deviations
constexpr double kPrecision = 1e-8;     // of fits [m, rad]
constexpr double kLinePeakShare = 0.3;  // of the votes of min_readings data that a peak must hold
constexpr double kMinView = 2.0;        // [rad]

/// Which data no object has claimed yet.
using Free = std::vector<char>;

/// The greedy loop, down to peaks of `threshold` votes. `refine(peak, free, inliers)` returns an estimate and fills in
/// its inliers, or returns nothing.
template <class Estimate, class Votes, class Datum, class Refine>
std::vector<Estimate> extract(Votes& votes, std::span<const Datum> data, double threshold, const Refine& refine) {
  for (const Datum& datum : data) votes.vote(datum, 1.0);
  std::vector<Estimate> found;
  Free free(data.size(), 1);
  std::vector<int> inliers;
  for (int refusals = 0; refusals < kMaxPeaksInVain;) {
    const auto peak = votes.best(threshold);
    if (!peak) break;
    const std::optional<Estimate> estimate = refine(*peak, free, inliers);
    if (!estimate) {
      votes.refuse(*peak);
      ++refusals;
      continue;
    }
    found.push_back(*estimate);
    for (const int i : inliers) {
      votes.vote(data[static_cast<std::size_t>(i)], -1.0);
      free[static_cast<std::size_t>(i)] = 0;
    }
  }
  return found;
}

/// Free arcs within the cut and the cone of a fit.
std::vector<int> inliers_of(const EchoFit& fit, std::span<const SonarArc> arcs, const Free& free,
                            const EchoModel& model, double window) {
  std::vector<int> inliers;
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    if (free[i] == 0) continue;
    const Reflector::Sight sight = fit.reflector.sight(arcs[i].sensor);
    if (std::abs(arcs[i].range - sight.range) < std::max(window, model.cut(fit, arcs[i])) &&
        off_axis2(sight, arcs[i]) <= arcs[i].half_angle * arcs[i].half_angle) {
      inliers.push_back(static_cast<int>(i));
    }
  }
  return inliers;
}

/// Refines a peak of arcs to a fit with inliers that suffice, in number and stops.
std::optional<EchoFit> refine_arcs(const Reflector& start, std::span<const SonarArc> arcs, const Free& free,
                                   const MapperParameters& parameters, std::vector<int>& inliers) {
  const EchoModel model(parameters.echo, parameters.robust);
  EchoFit fit{start, 1.0};
  for (int i = 0; i <= kFitRounds; ++i) {
    inliers = inliers_of(fit, arcs, free, model, i == 0 ? kLineWindow : 0.0);
    if (static_cast<int>(inliers.size()) < parameters.support.enough(start.is_wall())) return {};
    if (i == kFitRounds) break;
    const auto next = fit_echoes(fit, arcs, inliers, parameters.robust, kPrecision);
    if (!next) return {};
    fit = *next;
  }
  return fit;
}

template <class Distance>
std::vector<int> inliers_of(std::span<const PointWithCovariance> points, const Free& free, double window,
                            const Distance& distance_and_variance) {
  std::vector<int> inliers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (free[i] == 0) continue;
    const auto [distance, variance] = distance_and_variance(points[i]);
    if (std::abs(distance) < std::max(window, kPointGate * std::sqrt(variance))) inliers.push_back(static_cast<int>(i));
  }
  return inliers;
}

std::vector<PointWithCovariance> picked(std::span<const PointWithCovariance> points, const std::vector<int>& indices) {
  std::vector<PointWithCovariance> chosen;
  chosen.reserve(indices.size());
  for (const int i : indices) chosen.push_back(points[static_cast<std::size_t>(i)]);
  return chosen;
}

bool is_radius(double radius, const MapperParameters& parameters) {
  return radius >= parameters.support.min_radius && radius <= parameters.hough.max_radius + parameters.hough.radius_bin;
}

bool suffices(const Evidence& evidence, const SupportParameters& need) {
  return evidence.stops >= need.min_stops && evidence.span >= need.min_span;
}

std::optional<WallEstimate> refine(const LineVotes::Peak& peak, std::span<const SonarArc> arcs, const Free& free,
                                   const MapperParameters& parameters, std::vector<int>& inliers) {
  const auto fit = refine_arcs(Reflector(peak.wall), arcs, free, parameters, inliers);
  if (!fit) return {};
  const Evidence evidence = evidence_of(fit->reflector, arcs, inliers);
  if (!suffices(evidence, parameters.support)) return {};
  return wall_estimate(*fit, echo_covariance(*fit, arcs, inliers, parameters.robust), evidence);
}

std::optional<CylinderEstimate> refine(const CircleVotes::Peak& peak, std::span<const SonarArc> arcs, const Free& free,
                                       const MapperParameters& parameters, std::vector<int>& inliers) {
  const Cylinder start{peak.cylinder.centre, std::max(peak.cylinder.radius, parameters.hough.radius_bin)};
  const auto fit = refine_arcs(Reflector(start), arcs, free, parameters, inliers);
  if (!fit) return {};
  const Evidence evidence = evidence_of(fit->reflector, arcs, inliers);
  const Cylinder c = fit->reflector.cylinder();
  const double view = viewing_angle_of(fit->reflector, arcs, inliers);
  if (!suffices(evidence, parameters.support) || view < kMinView || !is_radius(c.radius, parameters)) return {};
  return CylinderEstimate{c, echo_covariance(*fit, arcs, inliers, parameters.robust), view, evidence.readings,
                          evidence.stops};
}

std::optional<WallEstimate> refine(const LineVotes::Peak& peak, std::span<const PointWithCovariance> points,
                                   const Free& free, const MapperParameters& parameters, std::vector<int>& inliers) {
  WallEstimate estimate{.wall = peak.wall};
  for (int i = 0; i <= kFitRounds; ++i) {
    const Vector2 n = estimate.wall.normal();
    inliers = inliers_of(points, free, i == 0 ? kLineWindow : 0.0, [&](const PointWithCovariance& p) {
      return std::pair{estimate.wall.rho - n.dot(p.position), n.dot(p.covariance * n)};
    });
    if (static_cast<int>(inliers.size()) < parameters.support.min_readings) return {};
    if (i == kFitRounds) break;
    const auto fit = fit_line(picked(points, inliers));
    if (!fit) return {};
    estimate.wall = fit->wall;
    estimate.covariance = fit->covariance;
  }
  const Vector2 t = estimate.wall.tangent();
  const auto along = [&](int i) { return t.dot(points[static_cast<std::size_t>(i)].position); };
  const auto [first, last] =
      std::minmax_element(inliers.begin(), inliers.end(), [&](int a, int b) { return along(a) < along(b); });
  estimate.begin = along(*first);
  estimate.end = along(*last);
  estimate.readings = static_cast<int>(inliers.size());
  if (estimate.end - estimate.begin < parameters.support.min_span) return {};
  return estimate;
}

std::optional<CylinderEstimate> refine(const CircleVotes::Peak& peak, std::span<const PointWithCovariance> points,
                                       const Free& free, const MapperParameters& parameters,
                                       std::vector<int>& inliers) {
  CylinderEstimate estimate{.cylinder = peak.cylinder};
  const Cylinder& c = estimate.cylinder;
  for (int i = 0; i <= kFitRounds; ++i) {
    inliers = inliers_of(points, free, i == 0 ? kLineWindow : 0.0, [&](const PointWithCovariance& p) {
      const Vector2 d = p.position - c.centre;
      return std::pair{d.norm() - c.radius, d.dot(p.covariance * d) / std::max(d.squaredNorm(), 1e-12)};
    });
    if (static_cast<int>(inliers.size()) < parameters.support.enough(false)) return {};
    if (i == kFitRounds) break;
    const auto fit = fit_circle(picked(points, inliers));
    if (!fit) return {};
    estimate.cylinder = fit->circle;
    estimate.covariance = fit->covariance;
  }
  std::vector<double> directions;
  for (const int i : inliers) {
    const Vector2 d = points[static_cast<std::size_t>(i)].position - c.centre;
    directions.push_back(std::atan2(d.y(), d.x()));
  }
  estimate.viewing_angle = covered_angle(directions);
  estimate.readings = static_cast<int>(inliers.size());
  if (estimate.viewing_angle < kMinView || !is_radius(c.radius, parameters)) return {};
  return estimate;
}

template <class Estimate, class Votes, class Datum>
std::vector<Estimate> transform(Votes votes, std::span<const Datum> data, double votes_of_one,
                                const MapperParameters& parameters) {
  const double threshold = kLinePeakShare * parameters.support.min_readings * votes_of_one;
  return extract<Estimate>(votes, data, threshold, [&](const auto& peak, const Free& free, std::vector<int>& inliers) {
    return refine(peak, data, free, parameters, inliers);
  });
}

}  // namespace

std::vector<WallEstimate> hough_lines(std::span<const SonarArc> arcs, const MapperParameters& parameters) {
  if (arcs.empty()) return {};
  return transform<WallEstimate>(LineVotes(parameters.hough, Extent::of(arcs), LineVotes::Normals::directed), arcs,
                                 parameters.hough.theta_bin / (2.0 * arcs.front().half_angle), parameters);
}

std::vector<WallEstimate> hough_lines(std::span<const PointWithCovariance> points, const MapperParameters& parameters) {
  return transform<WallEstimate>(LineVotes(parameters.hough, Extent::of(points), LineVotes::Normals::undirected),
                                 points, 1.0, parameters);
}

std::vector<CylinderEstimate> hough_circles(std::span<const SonarArc> arcs, const MapperParameters& parameters) {
  return transform<CylinderEstimate>(CircleVotes(parameters.hough, Extent::of(arcs)), arcs, 0.0, parameters);
}

std::vector<CylinderEstimate> hough_circles(std::span<const PointWithCovariance> points,
                                            const MapperParameters& parameters) {
  return transform<CylinderEstimate>(CircleVotes(parameters.hough, Extent::of(points)), points, 0.0, parameters);
}

}  // namespace noctule::mapping
