#pragma once
/// Circles through uncertain points.
#include <optional>
#include <span>

#include "mapping/line_fit.hpp"

namespace noctule::mapping {

/// Kasa's circle: least squares of 2 c.p + d = |p|^2, linear; biased to small radii on short arcs.
/// \return nothing for fewer than three points or points on a line
[[nodiscard]] std::optional<Cylinder> kasa_circle(std::span<const Vector2> points);

/// Taubin's circle (PAMI 1991; algebraic fit of Chernov, "Circular and linear regression", 2010, section 5.10).
/// \return nothing for fewer than three points or points on a line
[[nodiscard]] std::optional<Cylinder> taubin_circle(std::span<const Vector2> points);

struct CircleFit {
  Cylinder circle;
  Matrix3 covariance = Matrix3::Zero();  ///< order (x, y, radius)
  double chi2 = 0.0;  ///< sum of squared radial distances over their variances; points - 3 degrees of freedom
};

/// Geometric circle: minimises sum (|p - c| - R)^2 / (u' C u), u pointing from the centre to the point, by
/// Levenberg-Marquardt from Taubin's circle.
/// \return nothing for fewer than three points, points on a line, or when it does not converge to R > 0
/// \throws std::invalid_argument when a point is not finite or its covariance has no positive variance
[[nodiscard]] std::optional<CircleFit> fit_circle(std::span<const PointWithCovariance> points);

}  // namespace noctule::mapping
