#pragma once
/// Resampling: how many copies of each particle go on, and where they are put.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/rng.hpp"

namespace noctule::particle {

/// A way to draw numbers of offspring n_i with E[n_i] = M w_i (w normalised).
class Resampler {
 public:
  virtual ~Resampler() = default;

  /// \param weights N linear weights, not necessarily normalised
  /// \param size M, how many particles go on
  /// \param rng source of all randomness
  /// \param[out] counts N numbers of offspring, sum M
  /// \throws std::invalid_argument when a weight is NaN, infinite or negative, when all are 0 (or so small that their
  ///         sum cannot be normalised), when counts is not as long as weights, or when there are no weights
  void offspring(std::span<const double> weights, std::uint32_t size, Rng& rng, std::span<std::uint32_t> counts) const;

 private:
  /// Weights are checked, `total` is their sum, counts are 0.
  virtual void draw(std::span<const double> weights, double total, std::uint32_t size, Rng& rng,
                    std::span<std::uint32_t> counts) const = 0;
};

enum class Resampling : std::int8_t {
  multinomial,  ///< M independent draws (Gordon, Salmond, Smith 1993)
  stratified,   ///< one draw in each of M equal strata (Kitagawa 1996); |n_i - M w_i| < 2
  systematic,   ///< a comb of M teeth with one random offset; |n_i - M w_i| < 1, least variance, depends on the order
  ssp  ///< Srinivasan's pivotal sampling (Gerber, Chopin, Whiteley 2019): |n_i - M w_i| < 1, least variance and
       ///< consistent in any order
};
[[nodiscard]] std::unique_ptr<const Resampler> make_resampler(Resampling method);

/// Turns numbers of offspring into an ancestor for each of M slots so that survivors stay in place: ancestors[i] = i
/// wherever i < M and counts[i] > 0; further copies fill the slots of the dead, in order.
/// \param counts N numbers of offspring, sum M
/// \param[out] ancestors M indices into the old particles
/// \param free scratch
void place_in_slots(std::span<const std::uint32_t> counts, std::span<std::uint32_t> ancestors,
                    std::vector<std::uint32_t>& free);
void place_in_slots(std::span<const std::uint32_t> counts, std::span<std::uint32_t> ancestors);

}  // namespace noctule::particle
