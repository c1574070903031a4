#pragma once
/// Measurement noise learned by recursive expectation maximisation: a Gaussian mixture at its point estimate, without a
/// prior (the comparison that Yuan et al. call EM-PF).
#include <array>
#include <span>

#include "core/state_archive.hpp"
#include "filters/noise/noise_residual.hpp"
#include "filters/noise/parameters.hpp"
#include "models/noise_mixture.hpp"

namespace noctule::filters {

template <int D>
class EmNoise {
 public:
  static constexpr int kMaxComponents = models::NoiseMixture<D>::kMaxComponents;

  explicit EmNoise(const EmNoiseParameters&);

  /// Sufficient statistics fade to `keep` of what they were; a component keeps its shape and the weight of at least one
  /// observation.
  void forget(double keep);

  /// Takes in the residuals of one scan.
  void update(std::span<const NoiseResidual<D>> residuals, int iterations);

  [[nodiscard]] models::NoiseMixture<D> mixture() const;

  void transfer(StateArchive& archive) {
    for (Component& c : components_) archive(c.n, c.first, c.second);
  }

 private:
  struct Component {
    double n = 1.0;
    VectorD<D> first = VectorD<D>::Zero();
    MatrixD<D> second = MatrixD<D>::Identity();
    [[nodiscard]] VectorD<D> mean() const { return first / n; }
  };
  [[nodiscard]] MatrixD<D> covariance(const Component& c) const {
    return c.second / c.n - c.mean() * c.mean().transpose() + floor_ * MatrixD<D>::Identity();
  }

  double floor_;
  std::size_t size_;
  std::array<Component, kMaxComponents> components_;
};

}  // namespace noctule::filters
