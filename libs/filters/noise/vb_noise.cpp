#include "filters/noise/vb_noise.hpp"

#include <cmath>

#include "core/log_weights.hpp"

namespace noctule::filters {

using models::small_determinant;
using models::small_inverse;

namespace {

/// d log Gamma(x) / dx for x > 0: upward recurrence, then the asymptotic series (1e-13 from x = 10 on).
double digamma(double x) {
  double result = 0.0;
  for (; x < 10.0; x += 1.0) result -= 1.0 / x;
  const double f = 1.0 / (x * x);
  return result + std::log(x) - 0.5 / x -
         f * (1.0 / 12 - f * (1.0 / 120 - f * (1.0 / 252 - f * (1.0 / 240 - f * (1.0 / 132 - f * 691.0 / 32760)))));
}

template <int D>
double log_det(const MatrixD<D>& m) {
  return std::log(small_determinant<D>(m));
}

/// E[log |precision|] under a Wishart distribution.
template <int D>
double expected_log_det(const typename VbNoise<D>::Component& c) {
  double result = D * std::log(2.0) - log_det<D>(c.inverse_w);
  for (int j = 0; j < D; ++j) result += digamma(0.5 * (c.nu - j));
  return result;
}

/// log of the normaliser of a Wishart density, B(W, nu).
template <int D>
double log_wishart_constant(const typename VbNoise<D>::Component& c) {
  double result =
      0.5 * c.nu * log_det<D>(c.inverse_w) - 0.5 * c.nu * D * std::log(2.0) - 0.25 * D * (D - 1) * std::log(kPi);
  for (int j = 0; j < D; ++j) result -= std::lgamma(0.5 * (c.nu - j));
  return result;
}

/// KL divergence of the Normal-Wishart posterior q from the prior p.
template <int D>
double normal_wishart_divergence(const typename VbNoise<D>::Component& q, const typename VbNoise<D>::Component& p) {
  const MatrixD<D> w = small_inverse<D>(q.inverse_w);
  const VectorD<D> d = q.m - p.m;
  const double normal = 0.5 * (D * (p.beta / q.beta - 1.0 - std::log(p.beta / q.beta)) + p.beta * q.nu * d.dot(w * d));
  const double wishart = log_wishart_constant<D>(q) - log_wishart_constant<D>(p) +
                         0.5 * (q.nu - p.nu) * expected_log_det<D>(q) + 0.5 * q.nu * ((p.inverse_w * w).trace() - D);
  return normal + wishart;
}

template <int D>
double dirichlet_divergence(std::span<const typename VbNoise<D>::Component> q,
                            std::span<const typename VbNoise<D>::Component> p) {
  double total_q = 0.0, total_p = 0.0, result = 0.0;
  for (const auto& c : q) total_q += c.alpha;
  for (const auto& c : p) total_p += c.alpha;
  for (std::size_t l = 0; l < q.size(); ++l) {
    result += std::lgamma(p[l].alpha) - std::lgamma(q[l].alpha) +
              (q[l].alpha - p[l].alpha) * (digamma(q[l].alpha) - digamma(total_q));
  }
  return result + std::lgamma(total_q) - std::lgamma(total_p);
}

}  // namespace

template <int D>
VbNoise<D>::VbNoise(const VbNoiseParameters& p) : size_(static_cast<std::size_t>(p.learning.components)) {
  for (std::size_t l = 0; l < size_; ++l) {
    prior_[l] = {.alpha = p.alpha,
                 .beta = p.beta,
                 .nu = p.nu,
                 .m = VectorD<D>::Zero(),
                 .inverse_w = p.nu * p.learning.first_variance(l) * MatrixD<D>::Identity()};
  }
  components_ = prior_;
}

template <int D>
void VbNoise<D>::forget(double keep) {
  for (std::size_t l = 0; l < size_; ++l) {
    Component& c = components_[l];
    const Component& p = prior_[l];
    const auto mix = [keep](const auto& own, const auto& prior) { return keep * own + (1.0 - keep) * prior; };
    const double beta = mix(c.beta, p.beta);
    const VectorD<D> d = c.m - p.m;
    // What mixing W^-1 + beta m m' leaves after taking off the new beta m m': positive definite as written here.
    const MatrixD<D> inverse_w =
        mix(c.inverse_w, p.inverse_w) + keep * (1.0 - keep) * c.beta * p.beta / beta * d * d.transpose();
    const VectorD<D> m = (keep * c.beta * c.m + (1.0 - keep) * p.beta * p.m) / beta;
    c = {mix(c.alpha, p.alpha), beta, mix(c.nu, p.nu), m, inverse_w};
  }
}

template <int D>
double VbNoise<D>::update(std::span<const NoiseResidual<D>> residuals, int iterations) {
  const std::array<Component, kMaxComponents> before = components_;
  double bound = 0.0;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    // E step: log of the expected weighted density of component l is constant_l - 0.5 nu_l tr(W_l Q).
    double total = 0.0;
    for (std::size_t l = 0; l < size_; ++l) total += components_[l].alpha;
    std::array<double, kMaxComponents> constant{};
    std::array<MatrixD<D>, kMaxComponents> precision;
    for (std::size_t l = 0; l < size_; ++l) {
      const Component& c = components_[l];
      constant[l] = digamma(c.alpha) - digamma(total) + 0.5 * expected_log_det<D>(c) - 0.5 * D * std::log(kTwoPi) -
                    0.5 * D / c.beta;
      precision[l] = c.nu * small_inverse<D>(c.inverse_w);
    }
    struct Sums {
      double n = 0.0;
      VectorD<D> first = VectorD<D>::Zero();
      MatrixD<D> second = MatrixD<D>::Zero();
    };
    std::array<Sums, kMaxComponents> sums;
    bound = 0.0;
    for (const NoiseResidual<D>& r : residuals) {
      std::array<double, kMaxComponents> log_r{};
      for (std::size_t l = 0; l < size_; ++l) {
        const VectorD<D>& m = components_[l].m;
        const MatrixD<D> q = r.second_moment - r.mean * m.transpose() - m * r.mean.transpose() + m * m.transpose();
        log_r[l] = constant[l] - 0.5 * (precision[l] * q).trace();
      }
      const double norm = log_sum_exp({log_r.data(), size_});
      bound += r.weight * norm;
      for (std::size_t l = 0; l < size_; ++l) {
        const double share = r.weight * std::exp(log_r[l] - norm);
        sums[l].n += share;
        sums[l].first += share * r.mean;
        sums[l].second += share * r.second_moment;
      }
    }
    if (iteration + 1 == iterations) {
      bound -= dirichlet_divergence<D>({components_.data(), size_}, {before.data(), size_});
      for (std::size_t l = 0; l < size_; ++l) bound -= normal_wishart_divergence<D>(components_[l], before[l]);
    }
    // M step. A component without observations keeps its prior.
    for (std::size_t l = 0; l < size_; ++l) {
      const Component& p = before[l];
      const Sums& s = sums[l];
      components_[l] = p;
      if (s.n < 1e-12) continue;
      Component& c = components_[l];
      const VectorD<D> mean = s.first / s.n, d = mean - p.m;
      c.alpha += s.n;
      c.beta += s.n;
      c.nu += s.n;
      c.m = (p.beta * p.m + s.first) / c.beta;
      c.inverse_w += s.second - s.n * mean * mean.transpose() + p.beta * s.n / c.beta * d * d.transpose();
      symmetrise(c.inverse_w);
    }
  }
  return bound;
}

template <int D>
models::NoiseMixture<D> VbNoise<D>::mixture() const {
  double total = 0.0;
  for (std::size_t l = 0; l < size_; ++l) total += components_[l].alpha;
  models::NoiseMixture<D> result;
  for (std::size_t l = 0; l < size_; ++l) {
    const Component& c = components_[l];
    const double dof = c.nu + 1.0 - D;
    const MatrixD<D> expected = clamped_noise<D>(c.inverse_w / c.nu);
    result.add({.weight = c.alpha / total,
                .mean = c.m,
                .scale = clamped_noise<D>(c.inverse_w * ((1.0 + c.beta) / (c.beta * dof))),
                .dof = dof,
                .precision = small_inverse<D>(expected)});
  }
  return result;
}

template class VbNoise<1>;
template class VbNoise<2>;

}  // namespace noctule::filters
