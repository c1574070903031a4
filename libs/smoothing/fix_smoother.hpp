#pragma once
/// Path of a robot whose motion is measured and whose position is fixed now and then: the limit where truth is fixes.
#include <optional>
#include <span>
#include <vector>

#include "core/gaussian.hpp"
#include "core/pose2.hpp"

namespace noctule::smoothing {

/// Poses given all motions and fixes: extended Rauch-Tung-Striebel smoother, linearised anew about its own path until
/// that stands still (Bell 1994: Gauss-Newton on the whole path).
/// \param start pose at the first time, with a positive definite covariance
/// \param motions the k-th leads from time k to k + 1, in the frame of pose k
/// \param fixes position in the map at each time, where there was one [m]
/// \param fix_covariance of each fix [m^2]
/// \throws std::invalid_argument unless there is one motion fewer than there are times
[[nodiscard]] std::vector<PoseGaussian> smooth_fixes(const PoseGaussian& start, std::span<const PoseGaussian> motions,
                                                     std::span<const std::optional<Vector2>> fixes,
                                                     const Matrix2& fix_covariance);

}  // namespace noctule::smoothing
