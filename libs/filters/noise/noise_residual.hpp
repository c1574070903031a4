#pragma once
/// What observations say about their noise.
#include <algorithm>

#include "core/gaussian.hpp"
#include "core/symmetric_eigen.hpp"

namespace noctule::filters {

/// What one observation says about the noise, in units of the nominal noise: moments of its residual after the update.
template <int D>
struct NoiseResidual {
  VectorD<D> mean = VectorD<D>::Zero();
  MatrixD<D> second_moment = MatrixD<D>::Zero();  ///< about 0: residual residual' + covariance of the prediction
  double weight = 1.0;                            ///< how much of an observation this is, in [0, 1]
};

/// Least and largest variance that is ever believed, in units of the nominal one.
inline constexpr double kLeastNoise = 0.01, kMostNoise = 400.0;

/// A covariance with its eigenvalues brought within these.
template <int D>
[[nodiscard]] MatrixD<D> clamped_noise(const MatrixD<D>& covariance) {
  if constexpr (D == 1) {
    return MatrixD<1>(std::clamp(covariance(0, 0), kLeastNoise, kMostNoise));
  } else {
    const SymmetricEigen<D> eigen = symmetric_eigen<D>(covariance);
    return eigen.vectors * eigen.values.cwiseMax(kLeastNoise).cwiseMin(kMostNoise).asDiagonal() *
           eigen.vectors.transpose();
  }
}

}  // namespace noctule::filters
