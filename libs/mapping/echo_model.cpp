#include "mapping/echo_model.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace noctule::mapping {
namespace {
constexpr double kFarthest = 20.0;  // residuals beyond are not weighed at all, in standard deviations

/// Tops of a Student-t of 3 degrees of freedom, 2 / (pi sqrt 3), and of a Gaussian, of unit width.
const double kLogTops = std::log(2.0 / (kPi * std::numbers::sqrt3)) - 0.5 * std::log(kTwoPi);

}  // namespace

EchoModel::EchoModel(const EchoModelParameters& parameters, const RobustParameters& robust)
    : parameters_(parameters),
      robust_(robust),
      log_clutter_(std::log(parameters.clutter / parameters.clutter_range) - std::log(kTwoPi)) {}

double EchoModel::log_likelihood(const EchoFit& fit, const Reflector::Sight& sight, const SonarArc& arc) const {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  const double angle2 = off_axis2(sight, arc), limit = arc.half_angle + parameters_.cone_margin;
  if (angle2 > limit * limit || sight.range <= 0.0) return kNever;
  const double sigma = std::max(arc.sigma * std::max(1.0, fit.scale), robust_.floor / robust_.tukey);
  const double e = (arc.range - sight.range) / sigma;
  if (std::abs(e) > kFarthest) return kNever;
  const double beam = 0.5 * arc.half_angle, q = 1.0 + e * e / 3.0;
  return kLogTops - std::log(sigma * beam * q * q) - 0.5 * angle2 / (beam * beam);
}

}  // namespace noctule::mapping
