/// Resampling methods that leave unequal weights, and those that need no sum of the weights.
#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "particle/resampling_methods.hpp"

namespace noctule::particle::detail {
namespace {

/// Splits particles until `more` copies are added, always the one whose copies are heaviest.
void split_heaviest(std::uint32_t more, Counts counts, CopyWeights copy_weights) {
  if (more == 0) return;
  std::priority_queue<std::pair<double, std::size_t>> heaviest;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0) heaviest.emplace(copy_weights[i], i);
  }
  for (; more > 0; --more) {
    const std::size_t i = heaviest.top().second;
    heaviest.pop();
    copy_weights[i] *= static_cast<double>(counts[i]) / (counts[i] + 1.0);
    ++counts[i];
    heaviest.emplace(copy_weights[i], i);
  }
}

/// The c at which sum min(w / c, 1) = kept; fewer than `kept` weights lie above it.
/// \param kept below the number of positive weights
double threshold(LinearWeights weights, std::uint32_t kept) {
  std::vector<double> sorted(weights.begin(), weights.end());
  std::ranges::sort(sorted, std::greater<>());
  double rest = 0.0;  // summed from the small end, so that it stays positive
  std::vector<double> rests(kept);
  for (std::size_t i = sorted.size(); i-- > 0;) {
    rest += sorted[i];
    if (i < kept) rests[i] = rest;
  }
  std::uint32_t above = 0;
  while (above + 1 < kept && sorted[above] >= rests[above] / (kept - above)) ++above;
  return rests[above] / (kept - above);
}

class Optimal : public Resampler {
 public:
  [[nodiscard]] bool equal_weights() const override { return false; }

 private:
  std::uint32_t draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts,
                     CopyWeights copy_weights) const override {
    const auto positive = static_cast<std::uint32_t>(std::ranges::count_if(weights, [](double w) { return w > 0.0; }));
    const std::uint32_t kept = std::min(positive, std::max(1u, size - size / 5));
    const double c = kept < positive ? threshold(weights, kept) : 0.0;
    std::vector<double> light(weights.size(), 0.0);
    double light_total = 0.0;
    std::uint32_t heavy = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] >= c && weights[i] > 0.0) {
        counts[i] = 1;
        copy_weights[i] = weights[i] / total;
        ++heavy;
      } else {
        light_total += light[i] = weights[i];
        copy_weights[i] = c / total;
      }
    }
    if (heavy < kept) add_systematic(light, light_total, kept - heavy, rng, counts);
    split_heaviest(size - kept, counts, copy_weights);
    return size;
  }
};

class Reallocation : public Resampler {
 public:
  [[nodiscard]] bool equal_weights() const override { return false; }

 private:
  std::uint32_t draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts,
                     CopyWeights copy_weights) const override {
    const double scale = size / total;
    std::uint32_t drawn = 0;
    std::vector<std::size_t> light;  // that survived
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double expected = weights[i] * scale;
      if (expected >= 1.0) {
        counts[i] = static_cast<std::uint32_t>(expected);
        copy_weights[i] = weights[i] / (total * counts[i]);
      } else if (rng.uniform() < expected) {
        counts[i] = 1;
        light.push_back(i);
      }
      drawn += counts[i];
    }
    if (drawn == 0) {  // all were light, none survived
      add_ssp(weights, total, size, rng, counts);
    } else if (drawn < size) {
      top_up(size - drawn, rng, counts, copy_weights);
    } else {
      trim(drawn - size, light, rng, counts, copy_weights);
    }
    return size;
  }

  /// Splits particles in proportion to what they weigh.
  static void top_up(std::uint32_t more, Rng& rng, Counts counts, CopyWeights copy_weights) {
    std::vector<double> masses(counts.size());
    for (std::size_t i = 0; i < masses.size(); ++i) masses[i] = counts[i] * copy_weights[i];
    add_ssp(masses, checked_sum(masses), more, rng, counts);
    share(masses, counts, copy_weights);
  }

  /// Merges copies; where all are single, takes light ones by lot, whose share the other light ones carry.
  static void trim(std::uint32_t fewer, std::vector<std::size_t>& light, Rng& rng, Counts counts,
                   CopyWeights copy_weights) {
    if (fewer == 0) return;
    std::vector<double> masses(counts.size());
    for (std::size_t i = 0; i < masses.size(); ++i) masses[i] = counts[i] * copy_weights[i];
    fewer -= remove_duplicates(fewer, counts);
    share(masses, counts, copy_weights);
    const double before = static_cast<double>(light.size());
    for (; fewer > 0; --fewer) {
      const auto lot = static_cast<std::size_t>(rng.index(light.size()));
      counts[light[lot]] = 0;
      light[lot] = light.back();
      light.pop_back();
    }
    for (const std::size_t i : light) copy_weights[i] *= before / static_cast<double>(light.size());
  }

  static void share(const std::vector<double>& masses, Counts counts, CopyWeights copy_weights) {
    for (std::size_t i = 0; i < masses.size(); ++i) {
      if (counts[i] > 0) copy_weights[i] = masses[i] / counts[i];
    }
  }
};

class Partial : public Resampler {
 public:
  [[nodiscard]] bool equal_weights() const override { return false; }

 private:
  std::uint32_t draw(LinearWeights weights, double total, std::uint32_t size, Rng& rng, Counts counts,
                     CopyWeights copy_weights) const override {
    const double high = 2.0 * total / size, low = 0.5 * total / size;
    std::vector<double> redrawn(weights.begin(), weights.end());
    double mass = 0.0;
    std::uint32_t moderate = 0;
    for (double& w : redrawn) {
      const bool stays = w >= low && w <= high && w > 0.0;
      moderate += stays;
      mass += w = stays ? 0.0 : w;
    }
    if (moderate > size || (moderate == size && mass > 0.0)) {  // no place for the others
      add_systematic(weights, total, size, rng, counts);
      return size;
    }
    const std::uint32_t places = size - moderate;
    if (mass > 0.0) add_systematic(redrawn, mass, places, rng, counts);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const bool stays = redrawn[i] != weights[i];
      if (stays) counts[i] = 1;
      copy_weights[i] = (stays ? weights[i] : mass / std::max(places, 1u)) / total;
    }
    if (mass == 0.0) split_heaviest(places, counts, copy_weights);
    return size;
  }
};

/// Where chain or trial m of `size` starts: every particle equally often as far as that goes, the rest by lot.
std::size_t start_of(std::uint32_t m, std::uint32_t size, std::size_t particles, Rng& rng) {
  const std::size_t whole_rounds = size - size % particles;
  return m < whole_rounds ? m % particles : static_cast<std::size_t>(rng.index(particles));
}

class Metropolis : public Resampler {
  static constexpr int kSteps = 32;
  std::uint32_t draw(LinearWeights weights, double, std::uint32_t size, Rng& rng, Counts counts,
                     CopyWeights) const override {
    std::uint32_t drawn = 0;
    for (std::uint32_t m = 0; m < size; ++m) {
      std::size_t k = start_of(m, size, weights.size(), rng);
      for (int step = 0; step < kSteps; ++step) {
        const auto j = static_cast<std::size_t>(rng.index(weights.size()));
        if (rng.uniform() * weights[k] < weights[j]) k = j;
      }
      const bool alive = weights[k] > 0.0;  // a chain that met nothing but zeros is drawn by SSP
      counts[k] += alive;
      drawn += alive;
    }
    return drawn;
  }
};

class Rejection : public Resampler {
  /// Past so many trials an exact draw takes their place, which changes no expectation: one heavy particle among a
  /// million light ones would need a million trials.
  static constexpr int kTrials = 64;
  std::uint32_t draw(LinearWeights weights, double, std::uint32_t size, Rng& rng, Counts counts,
                     CopyWeights) const override {
    const double largest = *std::ranges::max_element(weights);
    std::uint32_t drawn = 0;
    for (std::uint32_t m = 0; m < size; ++m) {
      std::size_t j = start_of(m, size, weights.size(), rng);
      int trial = 0;
      while (rng.uniform() * largest >= weights[j] && ++trial < kTrials) {
        j = static_cast<std::size_t>(rng.index(weights.size()));
      }
      if (trial == kTrials) continue;
      ++counts[j];
      ++drawn;
    }
    return drawn;
  }
};

}  // namespace

std::unique_ptr<const Resampler> make_optimal() {
  return std::make_unique<Optimal>();
}
std::unique_ptr<const Resampler> make_reallocation() {
  return std::make_unique<Reallocation>();
}
std::unique_ptr<const Resampler> make_partial() {
  return std::make_unique<Partial>();
}
std::unique_ptr<const Resampler> make_metropolis() {
  return std::make_unique<Metropolis>();
}
std::unique_ptr<const Resampler> make_rejection() {
  return std::make_unique<Rejection>();
}

}  // namespace noctule::particle::detail
