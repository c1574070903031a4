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
  return improbable(*fit, rejection) ? kImpossible : fit->log_evidence;
}

[[nodiscard]] Vector2 towards(const Sighting& s, double distance) {
  return s.position + distance * Vector2(std::cos(s.direction), std::sin(s.direction));
}

/// The start with the smaller misfit; sightings without directions say nothing about `heard`.
template <class Surface>
[[nodiscard]] Surface better(std::span<const Sighting> sightings, const std::optional<Surface>& closed_form,
                             const Surface& heard) {
  return closed_form && misfit(sightings, *closed_form) <= misfit(sightings, heard) ? *closed_form : heard;
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
                         const SurfaceFits& previous, const Kinds& kinds) {
  SurfaceFits fits;
  if (sightings.empty()) return fits;
  const auto& outliers = parameters.outliers;
  const Sighting& latest = sightings.back();
  const Triple triple = widest_triple(sightings);

  if (kinds.wall && previous.wall)
    fits.wall = fit_wall(sightings, {previous.wall->parameters[0], previous.wall->parameters[1]}, outliers);
  if (kinds.wall && !fits.wall) {
    const auto tangent = tangent_wall(triple.span());
    const Vector2 foot = towards(latest, latest.range);
    const Wall heard{foot.dot(towards(latest, 1.0) - latest.position), latest.direction};
    fits.wall = fit_wall(sightings, better(sightings, tangent, heard), outliers);
  }

  if (kinds.point && previous.point) fits.point = fit_point(sightings, previous.point->parameters, outliers);
  if (kinds.point && !fits.point) {
    std::optional<Cylinder> crossing;
    if (const auto q = point_at_ranges(triple.span())) crossing = Cylinder{*q, 0.0};
    const Cylinder heard{towards(latest, latest.range), 0.0};
    fits.point = fit_point(sightings, better(sightings, crossing, heard).centre, outliers);
  }

  if (kinds.cylinder && previous.cylinder) {
    const Vector3& x = previous.cylinder->parameters;
    fits.cylinder = fit_cylinder(sightings, {x.head<2>(), x[2]}, parameters.radius, outliers);
  }
  if (kinds.cylinder && !fits.cylinder) {
    const auto circle = apollonius(triple.span(), parameters.largest_radius);
    const double radius = parameters.radius.mean;
    const Cylinder heard{towards(latest, latest.range + radius), radius};
    fits.cylinder = fit_cylinder(sightings, better(sightings, circle, heard), parameters.radius, outliers);
  }
  return fits;
}

template <int D>
bool improbable(const SurfaceFit<D>& fit, double probability) {
  return fit.dof > 0 && fit.chi2 > fit.dof && 1.0 - chi2_cdf(fit.chi2, fit.dof) < probability;
}
template bool improbable(const SurfaceFit<2>&, double);
template bool improbable(const SurfaceFit<3>&, double);

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
