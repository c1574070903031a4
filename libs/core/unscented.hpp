#pragma once
/// The scaled unscented transform (Julier 2002): a Gaussian as 2 n + 1 points.
#include <array>
#include <cmath>

#include "core/gaussian.hpp"
#include "core/parameters.hpp"

namespace noctule {

struct UnscentedScaling {
  double alpha = 0.9, beta = 2.0, kappa = 0.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using S = UnscentedScaling;
    v.field("alpha", &S::alpha, unit::one, "distance of the points", Range{.min = 0.01, .max = 2.0});
    v.field("beta", &S::beta, unit::one, "knowledge of the distribution; 2 for a Gaussian", at_least(0.0));
    v.field("kappa", &S::kappa, unit::one, "second distance of the points", at_least(0.0));
  }
};

/// Weights of the centre and of each other point. Point 0 is the mean, points 1 + 2 k and 2 + 2 k lie `spread` columns
/// k of a square root of the covariance off it. A small alpha makes weights of opposite signs and great size, whose
/// sums cancel: 0.9 does not.
struct UnscentedWeights {
  double spread;             ///< sqrt(n + lambda)
  double mean_centre;        ///< in means
  double covariance_centre;  ///< in covariances; may be negative
  double other;

  UnscentedWeights(int n, const UnscentedScaling& s) {
    const double scaled = s.alpha * s.alpha * (n + s.kappa);  // n + lambda
    spread = std::sqrt(scaled);
    mean_centre = 1.0 - n / scaled;
    covariance_centre = mean_centre + 1.0 - s.alpha * s.alpha + s.beta;
    other = 0.5 / scaled;
  }
};

/// \param root any square root of the covariance
template <int D>
[[nodiscard]] std::array<VectorD<D>, 2 * D + 1> sigma_points(const VectorD<D>& mean, const MatrixD<D>& root,
                                                             double spread) {
  std::array<VectorD<D>, 2 * D + 1> points;
  points[0] = mean;
  for (int k = 0; k < D; ++k) {
    points[static_cast<std::size_t>(1 + 2 * k)] = mean + spread * root.col(k);
    points[static_cast<std::size_t>(2 + 2 * k)] = mean - spread * root.col(k);
  }
  return points;
}

/// Sums of points under the weights: mean, and covariance about it.
template <int D, std::size_t Points>
void unscented_moments(const std::array<VectorD<D>, Points>& points, const UnscentedWeights& w, VectorD<D>& mean,
                       MatrixD<D>& covariance) {
  mean = w.mean_centre * points[0];
  for (std::size_t i = 1; i < Points; ++i) mean += w.other * points[i];
  const VectorD<D> centre = points[0] - mean;
  covariance = w.covariance_centre * centre * centre.transpose();
  for (std::size_t i = 1; i < Points; ++i) {
    const VectorD<D> d = points[i] - mean;
    covariance += w.other * d * d.transpose();
  }
}

}  // namespace noctule
