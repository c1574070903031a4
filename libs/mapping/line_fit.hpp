#pragma once
/// Straight lines through uncertain points.
#include <optional>
#include <span>

#include "core/features.hpp"

namespace noctule::mapping {

/// A point of a surface, map frame.
struct PointWithCovariance {
  Vector2 position = Vector2::Zero();
  Matrix2 covariance = Matrix2::Zero();
};

struct LineFit {
  Wall wall;                             ///< rho >= 0
  Matrix2 covariance = Matrix2::Zero();  ///< order (rho, theta)
  double chi2 = 0.0;  ///< sum of squared distances over their variances; points - 2 degrees of freedom
};

/// Weighted total least squares: minimises sum (rho - n.p)^2 / (n' C n), the weights being taken at the line of the
/// iteration before. With l the coordinate along the line and w the weights: var theta = 1 / sum w (l - lm)^2,
/// var rho = 1 / sum w + lm^2 var theta, cov = lm var theta.
/// \return nothing for fewer than two different points
/// \throws std::invalid_argument when a point is not finite or its covariance has no positive variance
[[nodiscard]] std::optional<LineFit> fit_line(std::span<const PointWithCovariance> points);

}  // namespace noctule::mapping
