#pragma once
#include <cmath>

#include "core/pose2.hpp"

namespace noctule::datasets {

/// Pose after a way of `length` [m] along an arc that turns by `turn` [rad], seen from its beginning.
[[nodiscard]] inline Pose2 arc(double length, double turn) {
  const double half = 0.5 * turn;
  const double chord = std::abs(half) < 1e-6 ? length : length * std::sin(half) / half;
  return {chord * std::cos(half), chord * std::sin(half), wrap(turn)};
}

}  // namespace noctule::datasets
