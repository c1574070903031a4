#pragma once
/// Fits walls, cylinders and points to sonar echoes through the range model, robustly.
#include <optional>
#include <span>

#include "core/parameters.hpp"
#include "mapping/reflector.hpp"
#include "mapping/sonar_arc.hpp"

namespace noctule::mapping {

/// How much an echo may differ before it is not believed.
struct RobustParameters {
  double tukey = 4.685;  ///< cut of Tukey's biweight in standard deviations (95 % efficient for Gaussian noise)
  double floor = 0.04;   ///< the cut is never below this [m] while the scale of the noise is unknown
  double max_scale = 10.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("tukey", &RobustParameters::tukey, unit::one, "cut of Tukey's biweight, in standard deviations",
            positive());
    v.field("floor_cm", &RobustParameters::floor, unit::centimetre,
            "smallest cut while the scale of the noise is unknown", positive());
    v.field("max_scale", &RobustParameters::max_scale, unit::one,
            "largest believed noise, in nominal standard deviations", at_least(1.0));
  }
};

struct EchoFit {
  Reflector reflector;
  double scale = 1.0;  ///< of the residuals, in nominal standard deviations (1.4826 MAD)
};

/// Gauss-Newton with Tukey weights on range = predicted range of the reflector, from `start`; its scale sets the first
/// cut, then it is estimated from the median absolute residual. \param members indices of the arcs that belong to the
/// reflector \return nothing when the arcs do not determine the reflector
[[nodiscard]] std::optional<EchoFit> fit_echoes(const EchoFit& start, std::span<const SonarArc> arcs,
                                                std::span<const int> members, const RobustParameters& parameters,
                                                double precision);

/// One Gauss-Newton step from a fit whose members have changed a little, at its own scale; the fit itself where the
/// arcs do not determine a step.
[[nodiscard]] EchoFit improved(const EchoFit& fit, std::span<const SonarArc> arcs, std::span<const int> members,
                               const RobustParameters& parameters);

/// Covariance of such a fit, order as Reflector::gradient; unused rows are 0. It is the jackknife over stops (the
/// sandwich estimator CR3 of MacKinnon and White 1985 with the stops as clusters): it follows the noise that is there,
/// and counts readings of one stop, which share the error of its pose, as dependent. Where one stop alone decides, it
/// is that of the stated noise at the fit's scale, which may be wide; it is not finite where nothing decides.
[[nodiscard]] Matrix3 echo_covariance(const EchoFit& fit, std::span<const SonarArc> arcs, std::span<const int> members,
                                      const RobustParameters& parameters);

}  // namespace noctule::mapping
