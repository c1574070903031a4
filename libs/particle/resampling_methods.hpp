#pragma once
/// What the resampling methods share. Only for the sources of this room.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>

#include "particle/resampling.hpp"

namespace noctule::particle::detail {

using Counts = std::span<std::uint32_t>;
using LinearWeights = std::span<const double>;
using CopyWeights = std::span<double>;

/// Last particle that may have offspring: takes what rounding leaves over at the upper end.
inline std::size_t last_positive(LinearWeights weights) {
  std::size_t last = weights.size() - 1;
  while (weights[last] <= 0.0) --last;
  return last;
}

/// Adds `size` offspring by a comb with one random offset. \param total sum of the weights, positive
void add_systematic(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts);

/// Adds `size` offspring by pivotal sampling. \param total sum of the weights, positive
void add_ssp(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts);

/// Sum of the weights; NaN where one is negative or NaN.
[[nodiscard]] double checked_sum(LinearWeights weights);

[[nodiscard]] std::unique_ptr<const Resampler> make_optimal();
[[nodiscard]] std::unique_ptr<const Resampler> make_reallocation();
[[nodiscard]] std::unique_ptr<const Resampler> make_partial();
[[nodiscard]] std::unique_ptr<const Resampler> make_metropolis();
[[nodiscard]] std::unique_ptr<const Resampler> make_rejection();

}  // namespace noctule::particle::detail
