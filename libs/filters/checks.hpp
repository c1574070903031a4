#pragma once
/// What a filter refuses at its door. Each throws InputError with the observation, the value, and what was expected.
#include "core/features.hpp"
#include "core/observations.hpp"

namespace noctule::filters {

/// Finite increment; finite, symmetric covariance without negative variances.
void check(const Odometry&);
/// Finite sensor poses, ranges of hits finite and positive, half angle in (0, pi].
void check(const UltrasonicScan&);
/// Finite numbers; readings of this scan name its beams.
void check(const ContourFeatures&, const UltrasonicScan&);
/// Finite numbers, range-bearing only, positive ranges, positive definite covariances.
void check(const LandmarkDetections&);

}  // namespace noctule::filters
