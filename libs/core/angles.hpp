#pragma once
/// Angles are radians everywhere inside the library, wrapped to [-pi, pi).
#include <cmath>
#include <numbers>

namespace noctule {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// Wraps an angle [rad] to [-pi, pi); exact for any magnitude.
[[nodiscard]] inline double wrap(double angle) {
  const double wrapped = angle - kTwoPi * std::floor((angle + kPi) / kTwoPi);
  return wrapped >= kPi ? wrapped - kTwoPi : wrapped;  // rounding at the upper edge
}

[[nodiscard]] constexpr double radians(double degrees) {
  return degrees * (kPi / 180.0);
}
[[nodiscard]] constexpr double degrees(double radians) {
  return radians * (180.0 / kPi);
}

}  // namespace noctule
