#include "particle/resampling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace noctule::particle {
namespace {

using Counts = std::span<std::uint32_t>;
using LinearWeights = std::span<const double>;

/// Sum of the weights; NaN where one is negative or NaN. Four running sums hide the latency of the addition.
double checked_sum(LinearWeights weights) {
  std::array<double, 4> sums{};
  bool valid = true;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sums[i % 4] += weights[i];
    valid &= weights[i] >= 0.0;
  }
  return valid ? (sums[0] + sums[1]) + (sums[2] + sums[3]) : std::numeric_limits<double>::quiet_NaN();
}

/// Last particle that may have offspring: takes what rounding leaves over at the upper end.
std::size_t last_positive(LinearWeights weights) {
  std::size_t last = weights.size() - 1;
  while (weights[last] <= 0.0) --last;
  return last;
}

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

class Multinomial : public Resampler {
  /// Order statistics of M uniforms without sorting: the smallest of k uniforms on (low, 1) lies at
  /// 1 - (1 - low) U^(1/k).
  void draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) const override {
    double above = 1.0;
    count_positions(weights, size, counts, [&](std::uint32_t m) {
      above *= std::exp(std::log(rng.uniform()) / (size - m));
      return total * (1.0 - above);
    });
  }
};

class Stratified : public Resampler {
  void draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) const override {
    const double stratum = total / size;
    count_positions(weights, size, counts, [&](std::uint32_t m) { return stratum * (m + rng.uniform()); });
  }
};

class Systematic : public Resampler {
  /// The teeth m + offset below M cumulative / total are counted, not searched: no branch depends on the weights.
  void draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) const override {
    const double scale = size / total;
    const double shift = 1.0 - rng.uniform();  // in (0, 1): floor(x + shift) = number of teeth below x
    double cumulative = 0.0;
    std::int64_t before = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      cumulative += weights[i] * scale;
      const std::int64_t below = std::min(static_cast<std::int64_t>(cumulative + shift), std::int64_t{size});
      counts[i] = static_cast<std::uint32_t>(below - before);
      before = below;
    }
    counts[last_positive(weights)] += static_cast<std::uint32_t>(size - before);
  }
};

class Ssp : public Resampler {
  /// Everybody gets floor(M w); then the fractional parts meet in pairs, one of which becomes 0 or 1 each time.
  void draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts) const override {
    const double scale = size / total;
    const auto split = [&](std::size_t i) {
      const double expected = weights[i] * scale;
      counts[i] = static_cast<std::uint32_t>(expected);
      return expected - counts[i];
    };
    constexpr double tolerance = 1e-12;
    const auto settled = [](double p) { return p < tolerance || p > 1.0 - tolerance; };
    std::size_t held = 0;
    double p = split(0);
    std::uint32_t given = counts[0];
    for (std::size_t i = 1; i < weights.size(); ++i) {
      double q = split(i);
      given += counts[i];
      if (settled(q)) {
        if (q > 0.5) ++counts[i], ++given;
        continue;
      }
      if (!settled(p)) {
        const double up = std::min(q, 1.0 - p), down = std::min(p, 1.0 - q);
        if (rng.uniform() * (up + down) < down) {
          p += up;
          q -= up;
        } else {
          p -= down;
          q += down;
        }
      }
      // One of the two is settled now: it is finished, the other is held.
      if (settled(p)) {
        if (p > 0.5) ++counts[held], ++given;
        held = i;
        p = q;
      } else if (q > 0.5) {
        ++counts[i], ++given;
      }
    }
    // What is held equals the whole number of offspring still to give, up to rounding.
    if (given < size) counts[held] += size - given;
  }
};

}  // namespace

void Resampler::offspring(LinearWeights weights, std::uint32_t size, Rng& rng, Counts counts) const {
  if (weights.empty() || counts.size() != weights.size()) {
    throw std::invalid_argument("resampling: as many counts as weights are needed, and at least one");
  }
  const double total = checked_sum(weights);
  if (!(total > 0.0) || !std::isfinite(total) || !std::isfinite(size / total)) {
    throw std::invalid_argument("resampling: weights must be finite, not negative, and not all zero");
  }
  std::ranges::fill(counts, 0u);
  draw(weights, total, size, rng, counts);
}

std::unique_ptr<const Resampler> make_resampler(Resampling method) {
  switch (method) {
    case Resampling::multinomial:
      return std::make_unique<Multinomial>();
    case Resampling::stratified:
      return std::make_unique<Stratified>();
    case Resampling::systematic:
      return std::make_unique<Systematic>();
    case Resampling::ssp:
      return std::make_unique<Ssp>();
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

}  // namespace noctule::particle
