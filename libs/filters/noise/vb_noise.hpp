#pragma once
/// Measurement noise learned by variational Bayes: a Gaussian mixture with Dirichlet and Normal-Wishart posteriors
/// (Bishop 2006, section 10.2; Yuan et al. eqs 4-9), forgotten towards its prior.
#include <array>
#include <span>

#include "core/state_archive.hpp"
#include "filters/noise/noise_residual.hpp"
#include "filters/noise/parameters.hpp"
#include "models/noise_mixture.hpp"

namespace noctule::filters {

template <int D>
class VbNoise {
 public:
  static constexpr int kMaxComponents = models::NoiseMixture<D>::kMaxComponents;

  /// Posterior of one component: weight ~ Dirichlet(alpha), mean ~ N(m, (beta precision)^-1), precision ~ W(W, nu).
  struct Component {
    double alpha = 1.0, beta = 1.0, nu = 1.0;
    VectorD<D> m = VectorD<D>::Zero();
    MatrixD<D> inverse_w = MatrixD<D>::Identity();
  };

  explicit VbNoise(const VbNoiseParameters&);

  /// Stabilised forgetting: natural parameters become keep * own + (1 - keep) * prior, so that nothing fades away or
  /// grows without bound, however long nothing is heard.
  void forget(double keep);

  /// Takes in the residuals of one scan; what was known before is the prior.
  /// \return evidence lower bound of the scan at the last E step, up to a constant; rises with every iteration
  double update(std::span<const NoiseResidual<D>> residuals, int iterations);

  /// Predictive distribution of the next residual, and expected precisions.
  [[nodiscard]] models::NoiseMixture<D> mixture() const;

  void transfer(StateArchive& archive) {
    for (Component& c : components_) archive(c.alpha, c.beta, c.nu, c.m, c.inverse_w);
  }

  [[nodiscard]] std::span<const Component> components() const { return {components_.data(), size_}; }
  [[nodiscard]] std::span<const Component> prior() const { return {prior_.data(), size_}; }

 private:
  std::size_t size_;
  std::array<Component, kMaxComponents> prior_, components_;
};

}  // namespace noctule::filters
