#pragma once
/// How likely an echo is, given what is thought to have made it.
#include <cmath>
#include <limits>

#include "mapping/echo_fit.hpp"

namespace noctule::mapping {

struct EchoModelParameters {
  double clutter = 0.05;              ///< share of echoes that come from nothing on the map
  double clutter_range = 4.0;         ///< over which they are spread evenly [m]
  double tail = 3.0;                  ///< degrees of freedom of the Student-t of ranges
  double cone_margin = radians(5.0);  ///< an echo may come from this far outside the cone

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("clutter", &EchoModelParameters::clutter, unit::one, "share of echoes that come from nothing on the map",
            between(1e-6, 0.9));
    v.field("clutter_range_m", &EchoModelParameters::clutter_range, unit::metre, "over which they are spread evenly",
            positive());
    v.field("cone_margin_deg", &EchoModelParameters::cone_margin, unit::degree,
            "how far outside its cone an echo may come from, for errors of the heading", between(0.0, 45.0));
  }
};

/// Density of an echo's range [m] and direction [rad]: from a reflector, a Student-t (3 degrees of freedom) about the
/// predicted range times a Gaussian about the axis with half the cone's half angle, as transducers hear; from clutter,
/// uniform.
class EchoModel {
 public:
  EchoModel(const EchoModelParameters& parameters, const RobustParameters& robust);

  [[nodiscard]] double log_clutter() const { return log_clutter_; }
  /// -inf for what lies outside the cone, behind the sensor, or further off than any noise.
  [[nodiscard]] double log_likelihood(const EchoFit& fit, const SonarArc& arc) const {
    return log_likelihood(fit, fit.reflector.sight(arc.sensor), arc);
  }
  [[nodiscard]] double log_likelihood(const EchoFit& fit, const Reflector::Sight& sight, const SonarArc& arc) const;
  /// Largest residual of an echo that may shape the fit [m].
  [[nodiscard]] double cut(const EchoFit& fit, const SonarArc& arc) const {
    return std::max(robust_.floor, robust_.tukey * fit.scale * arc.sigma);
  }

 private:
  static constexpr double kFarthest = 20.0;  // residuals beyond are not weighed at all, in standard deviations

  EchoModelParameters parameters_;
  RobustParameters robust_;
  double log_clutter_;
  double log_tops_;  // of a Student-t of 3 degrees of freedom, 2 / (pi sqrt 3), and of a Gaussian, of unit width
};

/// Squared chord between the direction of the echo and the axis: nearly the squared angle, without its sine.
[[nodiscard]] inline double off_axis2(const Reflector::Sight& sight, const SonarArc& arc) {
  return 2.0 - 2.0 * sight.direction.dot(arc.axis);
}

inline double EchoModel::log_likelihood(const EchoFit& fit, const Reflector::Sight& sight, const SonarArc& arc) const {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  const double angle2 = off_axis2(sight, arc), limit = arc.half_angle + parameters_.cone_margin;
  if (angle2 > limit * limit || sight.range <= 0.0) return kNever;
  const double sigma = std::max(arc.sigma * std::max(1.0, fit.scale), robust_.floor / robust_.tukey);
  const double e = (arc.range - sight.range) / sigma;
  if (std::abs(e) > kFarthest) return kNever;
  const double beam = 0.5 * arc.half_angle, q = 1.0 + e * e / 3.0;
  return log_tops_ - std::log(sigma * beam * q * q) - 0.5 * angle2 / (beam * beam);
}

}  // namespace noctule::mapping
