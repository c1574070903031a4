#include "filters/noise/em_noise.hpp"

#include <algorithm>
#include <cmath>

#include "core/log_weights.hpp"

namespace noctule::filters {

using models::small_determinant;
using models::small_inverse;

template <int D>
EmNoise<D>::EmNoise(const EmNoiseParameters& p)
    : floor_(p.variance_floor), size_(static_cast<std::size_t>(p.learning.components)) {
  for (std::size_t l = 0; l < size_; ++l) {
    components_[l].second = std::max(p.learning.first_variance(l) - floor_, 0.0) * MatrixD<D>::Identity();
  }
}

template <int D>
void EmNoise<D>::forget(double keep) {
  for (std::size_t l = 0; l < size_; ++l) {
    Component& c = components_[l];
    const double factor = std::max(keep * c.n, 1.0) / c.n;
    c.n *= factor;
    c.first *= factor;
    c.second *= factor;
  }
}

template <int D>
void EmNoise<D>::update(std::span<const NoiseResidual<D>> residuals, int iterations) {
  const std::array<Component, kMaxComponents> before = components_;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    double total = 0.0;
    for (std::size_t l = 0; l < size_; ++l) total += components_[l].n;
    std::array<Component, kMaxComponents> next = before;
    std::array<MatrixD<D>, kMaxComponents> precision;
    std::array<VectorD<D>, kMaxComponents> mean;
    std::array<double, kMaxComponents> constant{};
    for (std::size_t l = 0; l < size_; ++l) {
      const MatrixD<D> sigma = covariance(components_[l]);
      precision[l] = small_inverse<D>(sigma);
      mean[l] = components_[l].mean();
      constant[l] = std::log(components_[l].n / total) - 0.5 * std::log(small_determinant<D>(sigma));
    }
    for (const NoiseResidual<D>& r : residuals) {
      std::array<double, kMaxComponents> log_r{};
      for (std::size_t l = 0; l < size_; ++l) {
        const VectorD<D> e = r.mean - mean[l];
        log_r[l] = constant[l] - 0.5 * e.dot(precision[l] * e);
      }
      const double norm = log_sum_exp({log_r.data(), size_});
      for (std::size_t l = 0; l < size_; ++l) {
        const double share = r.weight * std::exp(log_r[l] - norm);
        next[l].n += share;
        next[l].first += share * r.mean;
        next[l].second += share * r.second_moment;
      }
    }
    components_ = next;
  }
}

template <int D>
models::NoiseMixture<D> EmNoise<D>::mixture() const {
  double total = 0.0;
  for (std::size_t l = 0; l < size_; ++l) total += components_[l].n;
  models::NoiseMixture<D> result;
  for (std::size_t l = 0; l < size_; ++l) {
    const MatrixD<D> sigma = clamped_noise<D>(covariance(components_[l]));
    result.add({.weight = components_[l].n / total,
                .mean = components_[l].mean(),
                .scale = sigma,
                .precision = small_inverse<D>(sigma)});
  }
  return result;
}

template class EmNoise<1>;
template class EmNoise<2>;

}  // namespace noctule::filters
