#pragma once
/// The noise of one kind of measurement as a filter believes it, whichever way it learns: a value that any filter can
/// hold. Hot loops read the mixture, which is plain numbers.
#include <span>
#include <variant>

#include "filters/noise/em_noise.hpp"
#include "filters/noise/vb_noise.hpp"

namespace noctule::filters {

/// Once per scan: begin(), then any number of looks at mixture(), then learn().
/// \tparam D numbers of one measurement; residuals are in units of the nominal noise
template <int D>
class NoiseModel {
 public:
  explicit NoiseModel(const FixedNoiseParameters&) { mixture_.add({}); }
  explicit NoiseModel(const EmNoiseParameters& em) : state_(EmNoise<D>(em)), learning_(em.learning) { prepare(); }
  explicit NoiseModel(const VbNoiseParameters& vb) : state_(VbNoise<D>(vb)), learning_(vb.learning) { prepare(); }
  /// Of whichever of these the variant holds.
  template <class... Alternatives>
  explicit NoiseModel(const std::variant<Alternatives...>& parameters)
      : NoiseModel(std::visit([](const auto& p) { return NoiseModel(p); }, parameters)) {}

  [[nodiscard]] bool adapts() const { return state_.index() != 0; }

  /// A scan of so many observations is about to be judged: what is known of the noise fades.
  void begin(std::size_t observations) {
    const double keep = learning_.keep(static_cast<double>(observations));
    if (auto* em = std::get_if<EmNoise<D>>(&state_)) em->forget(keep);
    if (auto* vb = std::get_if<VbNoise<D>>(&state_)) vb->forget(keep);
    prepare();
  }

  /// Without residuals nothing changes.
  void learn(std::span<const NoiseResidual<D>> residuals) {
    if (residuals.empty()) return;
    if (auto* em = std::get_if<EmNoise<D>>(&state_)) em->update(residuals, learning_.iterations);
    if (auto* vb = std::get_if<VbNoise<D>>(&state_)) vb->update(residuals, learning_.iterations);
    prepare();
  }

  /// A standard Gaussian while nothing is learned.
  [[nodiscard]] const models::NoiseMixture<D>& mixture() const { return mixture_; }

  /// What has been learned.
  void transfer(StateArchive& archive) {
    if (auto* em = std::get_if<EmNoise<D>>(&state_)) archive(*em);
    if (auto* vb = std::get_if<VbNoise<D>>(&state_)) archive(*vb);
    prepare();
  }

 private:
  void prepare() {
    if (const auto* em = std::get_if<EmNoise<D>>(&state_)) mixture_ = em->mixture();
    if (const auto* vb = std::get_if<VbNoise<D>>(&state_)) mixture_ = vb->mixture();
  }

  std::variant<std::monostate, EmNoise<D>, VbNoise<D>> state_;
  NoiseLearningParameters learning_;
  models::NoiseMixture<D> mixture_;
};

}  // namespace noctule::filters
