#pragma once
/// Resampling: how many copies of each particle go on, what they weigh, and where they are put.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/parameters.hpp"
#include "core/rng.hpp"

namespace noctule::particle {

/// A way to draw numbers of offspring n_i whose weights stand for those of their parents.
class Resampler {
 public:
  virtual ~Resampler() = default;

  /// Offspring of equal weight 1/M: E[n_i] = M w_i (w normalised). What a method of unequal weights draws is evened out
  /// by SSP afterwards: still unbiased, with more variance.
  /// \param weights N linear weights, not necessarily normalised
  /// \param size M, how many particles go on
  /// \param rng source of all randomness
  /// \param[out] counts N numbers of offspring, sum M
  /// \throws std::invalid_argument when a weight is NaN, infinite or negative, when all are 0 (or so small that their
  ///         sum cannot be normalised), when counts is not as long as weights, or when there are no weights
  void offspring(std::span<const double> weights, std::uint32_t size, Rng& rng, std::span<std::uint32_t> counts) const;

  /// Offspring with the weights that the method gives them: E[n_i copy_weights_i] = w_i.
  /// \param[out] copy_weights N weights: of each copy of particle i. Their sum over all copies is 1 (with
  /// `reallocation`
  ///             in expectation only), and each is 1/M when equal_weights()
  void offspring(std::span<const double> weights, std::uint32_t size, Rng& rng, std::span<std::uint32_t> counts,
                 std::span<double> copy_weights) const;

  /// What the method draws before its number of offspring is brought to M; it differs with `branching` and
  /// `rounding_copy`, and where draws of `metropolis` and `rejection` came to nothing.
  /// \param[out] counts as above, with another sum
  /// \param[out] copy_weights as above
  /// \return the sum of counts
  std::uint32_t untrimmed(std::span<const double> weights, std::uint32_t size, Rng& rng,
                          std::span<std::uint32_t> counts, std::span<double> copy_weights) const;

  /// Whether all offspring weigh the same.
  [[nodiscard]] virtual bool equal_weights() const { return true; }

 private:
  /// Weights are checked, `total` is their sum, counts are 0, copy_weights 1/size (or empty when equal_weights()).
  /// \return number of offspring drawn
  virtual std::uint32_t draw(std::span<const double> weights, double total, std::uint32_t size, Rng& rng,
                             std::span<std::uint32_t> counts, std::span<double> copy_weights) const = 0;
};

/// The methods that paper 002 compares (its figure 5 names none; these are the ones in common use).
enum class Resampling : std::int8_t {
  multinomial,  ///< M independent draws (Gordon, Salmond, Smith 1993)
  stratified,   ///< one draw in each of M equal strata (Kitagawa 1996); |n_i - M w_i| < 2
  systematic,   ///< a comb of M teeth with one random offset; |n_i - M w_i| < 1, least variance, depends on the order
  residual,     ///< floor(M w_i) copies for sure, the rest multinomial (Liu, Chen 1998)
  residual_systematic,  ///< floor(M w_i) copies for sure, the rest systematic; |n_i - M w_i| < 1
  rsr,                  ///< residual systematic in one loop (Bolic, Djuric, Hong 2003): systematic draws
  branching,  ///< floor(M w_i) and one more with the probability of the fraction, independently (Crisan, Lyons);
              ///< topped up or trimmed to M by SSP, which biases n_i by at most max(1/4, w_i sum f(1-f)) / M
  ssp,        ///< Srinivasan's pivotal sampling (Gerber, Chopin, Whiteley 2019): |n_i - M w_i| < 1, least variance and
              ///< consistent in any order
  rounding_copy,  ///< M w_i rounded: no randomness and biased by up to 1/2; topped up or trimmed to M by SSP
  optimal,       ///< 4/5 M distinct particles above or at a threshold (Fearnhead, Clifford 2003), the heaviest split to
                 ///< refill; unequal weights
  reallocation,  ///< heavy particles are split evenly, light ones survive with probability M w_i (Liu, Chen, Logvinenko
                 ///< 2001); unequal weights
  partial,  ///< only particles above 2/M or below 1/(2M) are redrawn, among themselves (Bolic, Djuric, Hong); unequal
            ///< weights
  metropolis,  ///< M Markov chains of 32 steps, no sum needed (Murray, Lee, Jacob 2016); biased toward light particles
               ///< when max w / mean w is beyond about ten
  rejection,   ///< draws until accepted with probability w / max w; unbiased
  regularised  ///< systematic; states are meant to be jittered afterwards by regularise() (Musso, Oudjane, Le Gland)
};
[[nodiscard]] std::unique_ptr<const Resampler> make_resampler(Resampling method);

/// Their names in configuration files, the default first.
[[nodiscard]] inline Choices<Resampling> resampling_choices() {
  using R = Resampling;
  return {{"systematic", R::systematic},
          {"ssp", R::ssp},
          {"stratified", R::stratified},
          {"multinomial", R::multinomial},
          {"residual", R::residual},
          {"residual_systematic", R::residual_systematic},
          {"rsr", R::rsr},
          {"branching", R::branching},
          {"rounding_copy", R::rounding_copy},
          {"optimal", R::optimal},
          {"reallocation", R::reallocation},
          {"partial", R::partial},
          {"metropolis", R::metropolis},
          {"rejection", R::rejection},
          {"regularised", R::regularised}};
}

/// Turns numbers of offspring into an ancestor for each of M slots so that survivors stay in place: ancestors[i] = i
/// wherever i < M and counts[i] > 0; further copies fill the slots of the dead, in order.
/// \param counts N numbers of offspring, sum M
/// \param[out] ancestors M indices into the old particles
/// \param free scratch
void place_in_slots(std::span<const std::uint32_t> counts, std::span<std::uint32_t> ancestors,
                    std::vector<std::uint32_t>& free);
void place_in_slots(std::span<const std::uint32_t> counts, std::span<std::uint32_t> ancestors);

/// Takes `copies` copies away, one by one from the particle that has most (the first among equals), never the last one.
/// \return how many could be taken
std::uint32_t remove_duplicates(std::uint32_t copies, std::span<std::uint32_t> counts);

}  // namespace noctule::particle
