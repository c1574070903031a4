#pragma once
/// What every estimator refuses at its door. Each throws InputError with the observation, the value, and what was
/// expected.
#include "core/observations.hpp"

namespace noctule {

/// Finite increment; finite, symmetric covariance without negative variances.
void check(const Odometry&);
/// Finite numbers, range-bearing only, positive ranges, positive definite covariances.
void check(const LandmarkDetections&);

}  // namespace noctule
