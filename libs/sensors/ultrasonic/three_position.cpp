#include "sensors/ultrasonic/three_position.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/chi2.hpp"
#include "core/log_weights.hpp"

namespace noctule::sensors {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

/// log evidence, or -inf where there is no fit or its chi2 is improbable.
template <int D>
[[nodiscard]] double log_evidence(const std::optional<SurfaceFit<D>>& fit, double rejection) {
  if (!fit) return kImpossible;
  // Cheap test first: chi2 below twice its mean is never improbable at 1e-4 or less from 8 degrees of freedom on.
  if (fit->dof > 0 && fit->chi2 > fit->dof && 1.0 - chi2_cdf(fit->chi2, fit->dof) < rejection) return kImpossible;
  return fit->log_evidence;
}

[[nodiscard]] Vector2 towards(const Sighting& s, double distance) {
  return s.position + distance * Vector2(std::cos(s.direction), std::sin(s.direction));
}

[[nodiscard]] bool has_direction(const Sighting& s) {
  return std::isfinite(s.direction_variance);
}

}  // namespace

Triple widest_triple(std::span<const Sighting> sightings) {
  Triple triple;
  const auto take = [&](const Sighting& s) { triple.sightings[triple.count++] = s; };
  if (sightings.size() <= 3) {
    for (const Sighting& s : sightings) take(s);
    return triple;
  }
  const Sighting &first = sightings.front(), &last = sightings.back();
  const Vector2 middle = 0.5 * (first.position + last.position);
  const auto inner = sightings.subspan(1, sightings.size() - 2);
  take(first);
  take(*std::min_element(inner.begin(), inner.end(), [&](const Sighting& a, const Sighting& b) {
    return (a.position - middle).squaredNorm() < (b.position - middle).squaredNorm();
  }));
  take(last);
  return triple;
}

SurfaceFits fit_surfaces(std::span<const Sighting> sightings, const DecisionParameters& parameters,
                         const SurfaceFits& previous) {
  SurfaceFits fits;
  if (sightings.empty()) return fits;
  const auto& outliers = parameters.outliers;
  if (previous.wall)
    fits.wall = fit_wall(sightings, {previous.wall->parameters[0], previous.wall->parameters[1]}, outliers);
  if (previous.point) fits.point = fit_point(sightings, previous.point->parameters, outliers);
  if (previous.cylinder) {
    const Vector3& x = previous.cylinder->parameters;
    fits.cylinder = fit_cylinder(sightings, {x.head<2>(), x[2]}, parameters.radius, outliers);
  }
  if (fits.wall && fits.point && fits.cylinder) return fits;

  const Triple triple = widest_triple(sightings);
  const Sighting& latest = sightings.back();
  if (!fits.wall) {
    if (const auto start = tangent_wall(triple.span())) fits.wall = fit_wall(sightings, *start, outliers);
    if (!fits.wall && has_direction(latest)) {
      const Vector2 n = towards(latest, 1.0) - latest.position;
      fits.wall = fit_wall(sightings, {latest.range + n.dot(latest.position), latest.direction}, outliers);
    }
  }
  if (!fits.point) {
    if (const auto start = point_at_ranges(triple.span())) fits.point = fit_point(sightings, *start, outliers);
    if (!fits.point && has_direction(latest))
      fits.point = fit_point(sightings, towards(latest, latest.range), outliers);
  }
  if (!fits.cylinder) {
    if (const auto start = apollonius(triple.span(), parameters.largest_radius))
      fits.cylinder = fit_cylinder(sightings, *start, parameters.radius, outliers);
    if (!fits.cylinder && has_direction(latest)) {
      const double radius = parameters.radius.mean;
      fits.cylinder =
          fit_cylinder(sightings, {towards(latest, latest.range + radius), radius}, parameters.radius, outliers);
    }
  }
  return fits;
}

Decision decide(const SurfaceFits& fits, int positions, const DecisionParameters& parameters) {
  Decision d;
  std::array<double, 3> log_posterior{log_evidence(fits.wall, parameters.rejection),
                                      log_evidence(fits.point, parameters.rejection),
                                      log_evidence(fits.cylinder, parameters.rejection)};
  d.explained = std::isfinite(normalise_log_weights(log_posterior));
  d.wall = std::exp(log_posterior[0]);
  d.point = std::exp(log_posterior[1]);
  d.cylinder = std::exp(log_posterior[2]);
  if (const double circle = d.point + d.cylinder; circle > 0.0) {
    double below = 0.0;
    if (d.cylinder > 0.0 && fits.cylinder) {
      const double sd = std::sqrt(fits.cylinder->covariance(2, 2));
      below = 0.5 * std::erfc((fits.cylinder->parameters[2] - parameters.point_radius) / (sd * std::sqrt(2.0)));
    }
    d.small = (d.point + d.cylinder * below) / circle;
  }
  if (!d.explained || positions < 3) return d;
  const double open = 1.0 - parameters.certainty;
  if (d.wall >= parameters.certainty) d.type = ContourType::wall;
  if (d.wall <= open && d.small >= parameters.certainty) d.type = ContourType::point;
  if (d.wall <= open && d.small <= open) d.type = ContourType::arc;
  return d;
}

}  // namespace noctule::sensors
