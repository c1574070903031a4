#include "particle/resampling.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "particle/resampling_methods.hpp"

namespace noctule::particle {

double detail::checked_sum(LinearWeights weights) {
  std::array<double, 4> sums{};  // four running sums hide the latency of the addition
  bool valid = true;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sums[i % 4] += weights[i];
    valid &= weights[i] >= 0.0;
  }
  return valid ? (sums[0] + sums[1]) + (sums[2] + sums[3]) : std::numeric_limits<double>::quiet_NaN();
}

/// The teeth m + offset below M cumulative / total are counted, not searched: no branch depends on the weights.
void detail::add_systematic(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) {
  const double scale = size / total;
  const double shift = 1.0 - rng.uniform();  // in (0, 1): floor(x + shift) = number of teeth below x
  double cumulative = 0.0;
  std::int64_t before = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    cumulative += weights[i] * scale;
    const std::int64_t below = std::min(static_cast<std::int64_t>(cumulative + shift), std::int64_t{size});
    counts[i] += static_cast<std::uint32_t>(below - before);
    before = below;
  }
  counts[last_positive(weights)] += static_cast<std::uint32_t>(size - before);
}

namespace {

/// Pivotal sampling, one particle at a time. Everybody gets floor(M w); then the fractional parts p, q meet in pairs.
/// Of p + q < 1 one takes all and the other becomes 0; of p + q >= 1 one becomes 1 and the other keeps what is over.
/// What is left is held for the next pair. Fractions are integers in units of 2^-52 (which doubles are, too): the carry
/// of their sum decides, and no branch depends on the weights.
class Pivot {
 public:
  Pivot(double scale, detail::Counts counts) : scale_(scale), counts_(counts) {}

  /// \param random 32 random bits
  void meet(std::size_t i, double weight, std::uint64_t random) {
    const double expected = weight * scale_;
    const auto whole = static_cast<std::int64_t>(expected);
    const std::int64_t q = static_cast<std::int64_t>((expected - static_cast<double>(whole)) * kOne);
    const std::int64_t sum = p_ + q, over = sum >> kBits, sign = -over;  // sign: 0 or all bits
    // The one that is held stays so in proportion to p, or to 1 - p when the other ends at 1.
    const std::int64_t stays = (p_ ^ sign) - sign + (over << kBits);
    const std::int64_t all = (sum ^ sign) - sign + (over << (kBits + 1));
    const double u = std::bit_cast<double>(kExponent | (random << 20) | (1u << 19)) - 1.0;  // in (0, 1)
    const bool wins = u * static_cast<double>(all) < static_cast<double>(stays);
    const auto keep = std::size_t{0} - static_cast<std::size_t>(wins);
    const std::size_t difference = i ^ held_;
    counts_[i] += static_cast<std::uint32_t>(whole);
    counts_[held_ ^ (difference & keep)] += static_cast<std::uint32_t>(over);
    held_ ^= difference & ~keep;
    p_ = sum & ((std::int64_t{1} << kBits) - 1);
    given_ += static_cast<std::uint32_t>(whole + over);
  }
  /// What is held equals the whole number of offspring still to give, up to rounding.
  void finish(std::uint32_t size) {
    if (given_ < size) counts_[held_] += size - given_;
  }

 private:
  static constexpr int kBits = 52;
  static constexpr double kOne = 0x1.0p52;
  static constexpr std::uint64_t kExponent = std::bit_cast<std::uint64_t>(1.0);
  double scale_;
  detail::Counts counts_;
  std::int64_t p_ = 0;
  std::size_t held_ = 0;
  std::uint32_t given_ = 0;
};

}  // namespace

void detail::add_ssp(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) {
  Pivot pivot(size / total, counts);
  // SplitMix64 from a random start: a block of Philox for every few particles would cost as much as all the rest.
  std::uint64_t state = rng();
  for (std::size_t i = 0; i < weights.size(); ++i, state += 0x9e3779b97f4a7c15ULL) {
    pivot.meet(i, weights[i], splitmix64(state) >> 32);
  }
  pivot.finish(size);
}

namespace {

using namespace detail;

/// Counts how many of `size` increasing positions in (0, total) fall on each particle; position(m) yields the m-th.
template <class Position>
void count_positions(LinearWeights weights, std::uint32_t size, Counts counts, Position position) {
  const std::size_t last = last_positive(weights);
  std::size_t i = 0;
  double cumulative = weights[0];
  for (std::uint32_t m = 0; m < size; ++m) {
    const double u = position(m);
    while (u > cumulative && i < last) cumulative += weights[++i];
    ++counts[i];
  }
}

/// Order statistics of M uniforms without sorting: the smallest of k uniforms on (low, 1) lies at
/// 1 - (1 - low) U^(1/k).
void add_multinomial(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) {
  double above = 1.0;
  count_positions(weights, size, counts, [&](std::uint32_t m) {
    above *= std::exp(std::log(rng.uniform()) / (size - m));
    return total * (1.0 - above);
  });
}

/// A method that is one function.
using Add = void (*)(LinearWeights, double total, std::uint32_t size, Rng&, Counts);
class Direct : public Resampler {
 public:
  explicit Direct(Add add) : add_(add) {}

 private:
  std::uint32_t draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts,
                     CopyWeights) const override {
    add_(weights, total, size, rng, counts);
    return size;
  }
  Add add_;
};

void add_stratified(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) {
  const double stratum = total / size;
  count_positions(weights, size, counts, [&](std::uint32_t m) { return stratum * (m + rng.uniform()); });
}

/// floor(M w) offspring each. \return the fractional parts, and their sum when it is whole
struct Fractions {
  std::vector<double> parts;
  double total = 0.0;
  std::uint32_t left = 0;  ///< offspring not yet given
};
Fractions give_whole_parts(LinearWeights weights, double total, std::uint32_t size, Counts counts) {
  // M w = 2.9999999999999996 means 3: else a fraction of nearly 1 would be left to chance.
  constexpr double kRounding = 1e-12;
  const double scale = size / total;
  Fractions f{std::vector<double>(weights.size()), 0.0, size};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double expected = weights[i] * scale;
    const std::uint32_t whole = std::min(static_cast<std::uint32_t>(expected * (1.0 + kRounding)), f.left);
    counts[i] += whole;
    f.left -= whole;
    f.total += f.parts[i] = std::max(expected - whole, 0.0);
  }
  return f;
}

template <Add add_rest>
void add_residual(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) {
  const Fractions f = give_whole_parts(weights, total, size, counts);
  if (f.left > 0) add_rest(f.parts, f.total, f.left, rng, counts);
}

/// The next tooth lies `ahead` (in units of 1/M) beyond what is handed out so far.
void add_rsr(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) {
  const double scale = size / total;
  double ahead = rng.uniform();
  std::int64_t given = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double expected = weights[i] * scale;
    const double n = std::max(std::ceil(expected - ahead), 0.0);
    ahead += n - expected;
    const std::int64_t whole = std::min(static_cast<std::int64_t>(n), std::int64_t{size} - given);
    counts[i] += static_cast<std::uint32_t>(whole);
    given += whole;
  }
  counts[last_positive(weights)] += static_cast<std::uint32_t>(size - given);
}

class Branching : public Resampler {
  std::uint32_t draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts,
                     CopyWeights) const override {
    const double scale = size / total;
    std::uint32_t drawn = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      drawn += counts[i] = static_cast<std::uint32_t>(weights[i] * scale + rng.uniform());
    }
    return drawn;
  }
};

class RoundingCopy : public Resampler {
  std::uint32_t draw(LinearWeights weights, double total, std::uint32_t size, Rng&, Counts counts,
                     CopyWeights) const override {
    const double scale = size / total;
    std::uint32_t drawn = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      drawn += counts[i] = static_cast<std::uint32_t>(weights[i] * scale + 0.5);
    }
    return drawn;
  }
};

double sum_of_weights(LinearWeights weights, std::uint32_t size, Counts counts) {
  if (weights.empty() || counts.size() != weights.size()) {
    throw std::invalid_argument("resampling: as many counts as weights are needed, and at least one");
  }
  const double total = checked_sum(weights);
  if (!(total > 0.0) || !std::isfinite(total) || !std::isfinite(size / total)) {
    throw std::invalid_argument("resampling: weights must be finite, not negative, and not all zero");
  }
  return total;
}

/// Brings `drawn` offspring to `size`: new ones by weight, or a choice among those that are there.
void bring_to_size(LinearWeights weights, double total, std::uint32_t drawn, std::uint32_t size, Rng& rng,
                   Counts counts) {
  if (drawn < size) add_ssp(weights, total, size - drawn, rng, counts);
  if (drawn > size) {
    const std::vector<double> there(counts.begin(), counts.end());
    std::ranges::fill(counts, 0u);
    add_ssp(there, drawn, size, rng, counts);
  }
}

}  // namespace

std::uint32_t Resampler::untrimmed(LinearWeights weights, std::uint32_t size, Rng& rng, Counts counts,
                                   CopyWeights copy_weights) const {
  const double total = sum_of_weights(weights, size, counts);
  if (copy_weights.size() != weights.size()) {
    throw std::invalid_argument("resampling: as many copy_weights as weights are needed");
  }
  std::ranges::fill(counts, 0u);
  std::ranges::fill(copy_weights, 1.0 / size);
  return draw(weights, total, size, rng, counts, copy_weights);
}

void Resampler::offspring(LinearWeights weights, std::uint32_t size, Rng& rng, Counts counts,
                          CopyWeights copy_weights) const {
  const std::uint32_t drawn = untrimmed(weights, size, rng, counts, copy_weights);
  if (drawn != size) bring_to_size(weights, checked_sum(weights), drawn, size, rng, counts);
}

void Resampler::offspring(LinearWeights weights, std::uint32_t size, Rng& rng, Counts counts) const {
  if (equal_weights()) {
    const double total = sum_of_weights(weights, size, counts);
    std::ranges::fill(counts, 0u);
    const std::uint32_t drawn = draw(weights, total, size, rng, counts, {});
    bring_to_size(weights, total, drawn, size, rng, counts);
    return;
  }
  std::vector<double> masses(weights.size());
  offspring(weights, size, rng, counts, masses);
  for (std::size_t i = 0; i < masses.size(); ++i) masses[i] *= counts[i];
  std::ranges::fill(counts, 0u);
  add_ssp(masses, checked_sum(masses), size, rng, counts);
}

std::unique_ptr<const Resampler> make_resampler(Resampling method) {
  const auto direct = [](Add add) { return std::make_unique<Direct>(add); };
  switch (method) {
    case Resampling::multinomial:
      return direct(add_multinomial);
    case Resampling::stratified:
      return direct(add_stratified);
    case Resampling::systematic:
    case Resampling::regularised:
      return direct(add_systematic);
    case Resampling::residual:
      return direct(add_residual<add_multinomial>);
    case Resampling::residual_systematic:
      return direct(add_residual<add_systematic>);
    case Resampling::rsr:
      return direct(add_rsr);
    case Resampling::ssp:
      return direct(add_ssp);
    case Resampling::branching:
      return std::make_unique<Branching>();
    case Resampling::rounding_copy:
      return std::make_unique<RoundingCopy>();
    case Resampling::optimal:
      return make_optimal();
    case Resampling::reallocation:
      return make_reallocation();
    case Resampling::partial:
      return make_partial();
    case Resampling::metropolis:
      return make_metropolis();
    case Resampling::rejection:
      return make_rejection();
  }
  throw std::invalid_argument("resampling: unknown method");
}

void place_in_slots(std::span<const std::uint32_t> counts, std::span<std::uint32_t> ancestors,
                    std::vector<std::uint32_t>& free) {
  // The dead are listed without a branch: who survives is as unpredictable as it can be.
  const std::size_t slots = ancestors.size(), kept = std::min(slots, counts.size());
  free.resize(slots + 1);
  std::size_t dead = 0;
  for (std::size_t i = 0; i < slots; ++i) {
    ancestors[i] = free[dead] = static_cast<std::uint32_t>(i);
    dead += i >= kept || counts[i] == 0;
  }
  std::size_t next = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    for (std::uint32_t copies = i < kept ? 1 : 0; copies < counts[i]; ++copies) {
      ancestors[free[next++]] = static_cast<std::uint32_t>(i);
    }
  }
}

void place_in_slots(std::span<const std::uint32_t> counts, std::span<std::uint32_t> ancestors) {
  std::vector<std::uint32_t> free;
  place_in_slots(counts, ancestors, free);
}

std::uint32_t remove_duplicates(std::uint32_t copies, Counts counts) {
  if (copies == 0 || counts.empty()) return 0;
  // Level by level from the top, as a histogram says how many particles have so many copies.
  std::uint32_t removed = 0, level = *std::ranges::max_element(counts), above = 0;
  std::vector<std::uint32_t> having(level + 1u, 0u);
  for (const std::uint32_t n : counts) ++having[n];
  for (; level > 1; --level) {
    above += having[level];
    if (removed + above > copies) break;
    removed += above;
  }
  if (level == 0) return 0;
  // All come down to `level`; there, the first so many lose one more.
  std::uint32_t more = level > 1 ? copies - removed : 0;
  for (std::uint32_t& n : counts) {
    n = std::min(n, level);
    if (more > 0 && n == level) --n, --more, ++removed;
  }
  return removed;
}

}  // namespace noctule::particle
