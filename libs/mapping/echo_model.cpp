#include "mapping/echo_model.hpp"

#include <cmath>
#include <limits>

namespace noctule::mapping {
namespace {
constexpr double kFarthest = 20.0;  // residuals beyond are not weighed at all, in standard deviations
}

EchoModel::EchoModel(const EchoModelParameters& parameters, const RobustParameters& robust)
    : parameters_(parameters),
      robust_(robust),
      log_clutter_(std::log(parameters.clutter / parameters.clutter_range) - std::log(kTwoPi)),
      log_top_(std::lgamma(0.5 * (parameters.tail + 1.0)) - std::lgamma(0.5 * parameters.tail) -
               0.5 * std::log(parameters.tail * kPi) - 0.5 * std::log(kTwoPi)) {}

double EchoModel::log_likelihood(const EchoFit& fit, const SonarArc& arc) const {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  const Reflector::Sight sight = fit.reflector.sight(arc.sensor);
  const double angle2 = off_axis2(sight, arc), limit = arc.half_angle + parameters_.cone_margin;
  if (angle2 > limit * limit || sight.range <= 0.0) return kNever;
  const double sigma = std::max(arc.sigma * std::max(1.0, fit.scale), robust_.floor / robust_.tukey);
  const double e = (arc.range - sight.range) / sigma;
  if (std::abs(e) > kFarthest) return kNever;
  const double beam = 0.5 * arc.half_angle;
  return log_top_ - std::log(sigma * beam) - 0.5 * (parameters_.tail + 1.0) * std::log1p(e * e / parameters_.tail) -
         0.5 * angle2 / (beam * beam);
}

}  // namespace noctule::mapping
