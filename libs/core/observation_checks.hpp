#pragma once
/// What every estimator refuses at its door. Each throws InputError with the observation, the value, and what was
/// expected.
#include "core/observations.hpp"

namespace noctule {

/// Finite increment; finite, symmetric covariance without negative variances.
void check(const Odometry&);
/// Of what each sighting measures: finite numbers, positive ranges, positive definite covariances.
void check(const LandmarkDetections&);
/// The same, and each sighting measures range and bearing.
void check_whole(const LandmarkDetections&);

}  // namespace noctule
