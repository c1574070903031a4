#pragma once
/// Small fixed-size Gaussian algebra: densities through Cholesky, Joseph updates, sampling from singular covariances.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

#include "core/angles.hpp"
#include "core/rng.hpp"
#include "core/symmetric_eigen.hpp"

namespace noctule {

template <int D>
using VectorD = Eigen::Matrix<double, D, 1>;
template <int D>
using MatrixD = Eigen::Matrix<double, D, D>;

template <class Matrix>
inline void symmetrise(Matrix& m) {
  m = (0.5 * (m + m.transpose())).eval();
}

/// Cholesky factor of a covariance; a matrix that rounding made slightly indefinite is repaired (1e-9 of its mean
/// diagonal, then x10 twice).
/// \throws std::domain_error when it is not positive definite even then, or not finite.
template <int D>
[[nodiscard]] Eigen::LLT<MatrixD<D>> cholesky(const MatrixD<D>& covariance) {
  Eigen::LLT<MatrixD<D>> llt(covariance);
  if (llt.info() == Eigen::Success && covariance.allFinite()) return llt;
  MatrixD<D> m = 0.5 * (covariance + covariance.transpose());
  double jitter = 1e-9 * m.trace() / static_cast<double>(m.rows());
  for (int attempt = 0; attempt < 3 && jitter > 0.0; ++attempt, jitter *= 10.0) {
    llt.compute(m + jitter * MatrixD<D>::Identity(m.rows(), m.cols()));
    if (llt.info() == Eigen::Success) return llt;
  }
  throw std::domain_error("covariance is not positive definite");
}

/// log N(innovation; 0, S) from the Cholesky factor of S.
template <int D>
[[nodiscard]] double log_gaussian(const VectorD<D>& innovation, const Eigen::LLT<MatrixD<D>>& llt) {
  const VectorD<D> y = llt.matrixL().solve(innovation);
  double log_det_half = 0.0;
  for (Eigen::Index i = 0; i < y.size(); ++i) log_det_half += std::log(llt.matrixLLT()(i, i));
  return -0.5 * y.squaredNorm() - log_det_half - 0.5 * static_cast<double>(y.size()) * std::log(kTwoPi);
}
template <int D>
[[nodiscard]] double log_gaussian(const VectorD<D>& innovation, const MatrixD<D>& covariance) {
  return log_gaussian<D>(innovation, cholesky<D>(covariance));
}
/// log N(innovation; 0, variance) of a scalar.
[[nodiscard]] inline double log_gaussian(double innovation, double variance) {
  return -0.5 * (innovation * innovation / variance + std::log(kTwoPi * variance));
}

/// Squared Mahalanobis length of a vector.
template <int D>
[[nodiscard]] double mahalanobis2(const VectorD<D>& v, const MatrixD<D>& covariance) {
  return cholesky<D>(covariance).matrixL().solve(v).squaredNorm();
}

/// What a Kalman update says about the measurement it took.
struct UpdateResult {
  double log_likelihood = 0.0;  ///< log N(innovation; 0, S)
  double nis = 0.0;             ///< innovation' S^-1 innovation
};

/// Kalman update in Joseph form: mean (D) and covariance (DxD) by an innovation (M) with Jacobian H (MxD) and noise R.
template <int D, int M>
UpdateResult joseph_update(VectorD<D>& mean, MatrixD<D>& covariance, const VectorD<M>& innovation,
                           const Eigen::Matrix<double, M, D>& h, const MatrixD<M>& r) {
  const Eigen::Matrix<double, D, M> pht = covariance * h.transpose();
  const auto llt = cholesky<M>(h * pht + r);
  const Eigen::Matrix<double, D, M> gain = llt.solve(pht.transpose()).transpose();
  mean += gain * innovation;
  const MatrixD<D> a = MatrixD<D>::Identity() - gain * h;
  covariance = (a * covariance * a.transpose() + gain * r * gain.transpose()).eval();
  symmetrise(covariance);
  const VectorD<M> y = llt.matrixL().solve(innovation);
  return {log_gaussian<M>(innovation, llt), y.squaredNorm()};
}

/// Square root A of a positive semi-definite covariance, A A' = P, by eigen-decomposition with negative eigenvalues
/// clamped to 0: works for singular P (Cholesky does not).
template <int D>
[[nodiscard]] MatrixD<D> square_root(const MatrixD<D>& covariance) {
  const SymmetricEigen<D> eigen = symmetric_eigen<D>(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// Lower triangular square root L of a positive semi-definite covariance, L L' = P. A variable that those before it
/// determine (to 1e-12 of its variance) gets an empty column. Ten times faster than square_root(), and does not need
/// its rotation.
template <int D>
[[nodiscard]] MatrixD<D> semidefinite_cholesky(const MatrixD<D>& covariance) {
  MatrixD<D> l = MatrixD<D>::Zero();
  for (int j = 0; j < D; ++j) {
    double pivot = covariance(j, j);
    for (int k = 0; k < j; ++k) pivot -= l(j, k) * l(j, k);
    if (!(pivot > 1e-12 * covariance(j, j))) continue;
    l(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < D; ++i) {
      double rest = covariance(i, j);
      for (int k = 0; k < j; ++k) rest -= l(i, k) * l(j, k);
      l(i, j) = rest / l(j, j);
    }
  }
  return l;
}

/// One draw from N(0, A A').
template <int D>
[[nodiscard]] VectorD<D> sample_gaussian(const MatrixD<D>& root, Rng& rng) {
  VectorD<D> n;
  for (int i = 0; i < D; ++i) n[i] = rng.normal();
  return root * n;
}

}  // namespace noctule
