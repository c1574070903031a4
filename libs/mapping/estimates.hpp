#pragma once
/// From fits to the values of core/contour.hpp.
#include <span>
#include <vector>

#include "core/contour.hpp"
#include "mapping/echo_fit.hpp"

namespace noctule::mapping {

/// From where, and how much of it, an object was heard.
struct Evidence {
  int readings = 0;
  int stops = 0;       ///< different ones
  double span = 0.0;   ///< of the wall seen, or between sensor positions for a cylinder or a point [m]
  double begin = 0.0;  ///< of a wall, along its tangent [m]
  double end = 0.0;    ///< [m]
};
[[nodiscard]] Evidence evidence_of(const Reflector& reflector, std::span<const SonarArc> arcs,
                                   std::span<const int> members);

/// How much of a cylinder or of the directions from a point the arcs see [rad].
[[nodiscard]] double viewing_angle_of(const Reflector& round, std::span<const SonarArc> arcs,
                                      std::span<const int> members);

/// 2 pi less the largest gap between directions [rad]; the order of `directions` is changed.
[[nodiscard]] double covered_angle(std::vector<double>& directions);

/// A wall normalised to rho >= 0, its covariance and ends with it.
[[nodiscard]] WallEstimate wall_estimate(const EchoFit& fit, const Matrix3& covariance, const Evidence& evidence);

}  // namespace noctule::mapping
