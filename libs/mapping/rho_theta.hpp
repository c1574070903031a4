#pragma once
/// Lines in Hesse form, rho = n(theta).p: the same line is (rho, theta) and (-rho, theta + pi).
#include <cmath>

#include "core/features.hpp"

namespace noctule::mapping {

/// The same line with its normal turned round.
[[nodiscard]] inline Wall flipped(const Wall& w) {
  return {-w.rho, wrap(w.theta + kPi)};
}

/// `w` or flipped(w), whichever normal is nearer to that of `reference`.
[[nodiscard]] inline Wall aligned(const Wall& w, const Wall& reference) {
  return std::abs(wrap(w.theta - reference.theta)) <= kPi / 2.0 ? w : flipped(w);
}

/// The same line measured from another origin [m].
[[nodiscard]] inline Wall seen_from(const Wall& w, const Vector2& origin) {
  return {w.rho - w.normal().dot(origin), w.theta};
}

/// Foot of the perpendicular from the frame's origin.
[[nodiscard]] inline Vector2 foot(const Wall& w) {
  return w.rho * w.normal();
}

/// Covariance of (rho, theta) after the origin moved by `origin`: rho' = rho - n.origin.
[[nodiscard]] inline Matrix2 covariance_seen_from(const Wall& w, const Matrix2& covariance, const Vector2& origin) {
  Matrix2 j = Matrix2::Identity();
  j(0, 1) = -w.tangent().dot(origin);
  return j * covariance * j.transpose();
}

/// Whether two lines are within `rho` [m] and `theta` [rad] of each other, whichever way their normals point.
[[nodiscard]] inline bool near(const Wall& a, const Wall& b, double rho, double theta) {
  const Wall c = aligned(b, a);
  return std::abs(wrap(a.theta - c.theta)) < theta && std::abs(a.rho - c.rho) < rho;
}

}  // namespace noctule::mapping
