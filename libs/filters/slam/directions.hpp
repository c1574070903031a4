#pragma once
#include <cmath>

#include "core/pose2.hpp"

namespace noctule::filters {

/// Angle from one unit vector to another [rad]. Where it is small, as nearly always, by the series of the arc sine,
/// which is accurate to 4e-7 there and much faster than an arc tangent.
inline double angle_between(const Vector2& from, const Vector2& to) {
  const double cosine = from.dot(to), sine = from.x() * to.y() - from.y() * to.x();
  if (cosine < 0.9) return std::atan2(sine, cosine);
  const double s2 = sine * sine;
  return sine * (1.0 + s2 * (1.0 / 6 + s2 * (3.0 / 40 + s2 * (5.0 / 112 + s2 * (35.0 / 1152 + s2 * 63.0 / 2816)))));
}

}  // namespace noctule::filters
