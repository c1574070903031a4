#include "particle/resampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace noctule::particle {
namespace {

std::vector<Resampling> all_methods() {
  std::vector<Resampling> methods;
  for (const auto& choice : resampling_choices()) methods.push_back(choice.second);
  return methods;
}

std::string name_of(const testing::TestParamInfo<Resampling>& info) {
  for (const auto& [name, method] : resampling_choices()) {
    if (method == info.param) return name;
  }
  return "unnamed";
}

/// Counts with the weights of the copies.
struct Offspring {
  std::vector<std::uint32_t> counts;
  std::vector<double> copy_weights;
  [[nodiscard]] double mass(std::size_t i) const { return counts[i] * copy_weights[i]; }
};
Offspring weighted_draw(Resampling method, const std::vector<double>& weights, std::uint32_t size, Rng rng) {
  Offspring o{std::vector<std::uint32_t>(weights.size()), std::vector<double>(weights.size())};
  make_resampler(method)->offspring(weights, size, rng, o.counts, o.copy_weights);
  return o;
}

std::vector<double> uneven_weights(std::size_t n, Rng& rng) {
  std::vector<double> w(n);
  for (double& v : w) v = std::pow(rng.uniform(), 8);
  return w;
}

std::vector<std::uint32_t> draw(Resampling method, const std::vector<double>& weights, std::uint32_t size, Rng rng) {
  std::vector<std::uint32_t> counts(weights.size());
  make_resampler(method)->offspring(weights, size, rng, counts);
  return counts;
}

class EveryResampler : public testing::TestWithParam<Resampling> {};

TEST_P(EveryResampler, GivesExactlySoManyOffspring) {
  Rng rng(1);
  for (const std::size_t n : {1u, 2u, 7u, 100u}) {
    for (const std::uint32_t size : {1u, 5u, 100u, 333u}) {
      for (int round = 0; round < 50; ++round) {
        const std::vector<double> w = uneven_weights(n, rng);
        const auto counts = draw(GetParam(), w, size, rng);
        EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), size);
        const auto weighted = weighted_draw(GetParam(), w, size, rng);
        EXPECT_EQ(std::accumulate(weighted.counts.begin(), weighted.counts.end(), 0u), size);
      }
    }
  }
}

TEST_P(EveryResampler, GivesExactlySoManyOffspringToAMillion) {
  const std::uint32_t n = GetParam() == Resampling::metropolis ? 50000 : 1000000;  // 32 steps each
  Rng rng(2);
  std::vector<double> w(n);
  for (double& v : w) v = rng.uniform();
  const auto counts = draw(GetParam(), w, n, rng);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}), n);
}

TEST_P(EveryResampler, OneParticleWithAllTheWeightHasAllOffspring) {
  for (std::size_t heir = 0; heir < 5; ++heir) {
    std::vector<double> w(5, 0.0);
    w[heir] = 3.0;  // not normalised
    std::vector<std::uint32_t> expected(5, 0);
    expected[heir] = 12;
    for (std::uint64_t seed = 0; seed < 100; ++seed) EXPECT_EQ(draw(GetParam(), w, 12, Rng(seed)), expected);
  }
}

TEST_P(EveryResampler, ZeroWeightsHaveNoOffspring) {
  const std::vector<double> w{0.0, 0.4, 0.0, 0.0, 0.6, 0.0};
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const auto counts = draw(GetParam(), w, 6, Rng(seed));
    for (std::size_t i = 0; i < w.size(); ++i) {
      if (w[i] == 0.0) {
        EXPECT_EQ(counts[i], 0u);
      }
    }
  }
}

TEST_P(EveryResampler, TinyWeightsAreWeightsToo) {
  const std::vector<double> w{1e-300, 3e-300};
  double sum = 0.0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) sum += draw(GetParam(), w, 100, Rng(seed))[0];
  EXPECT_NEAR(sum / 400, 25.0, 1.0);
  // Beside a weight of 1 they vanish without a trace.
  EXPECT_EQ(draw(GetParam(), {1e-300, 1.0, 1e-300}, 3, Rng(1)), (std::vector<std::uint32_t>{0, 3, 0}));
}

TEST_P(EveryResampler, EqualWeightsAndSmallRoundingErrors) {
  std::vector<double> w(10, 0.1);
  w[3] += 1e-12;
  w[7] -= 3e-13;
  const auto counts = draw(GetParam(), w, 10, Rng(5));
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), 10u);
}

TEST_P(EveryResampler, RefusesWhatIsNoWeight) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& w :
       {std::vector{0.5, nan, 0.5}, {nan, 1.0}, {0.5, -0.1}, {inf, 1.0}, {0.0, 0.0}, {5e-324, 0.0}, {}}) {
    EXPECT_THROW(draw(GetParam(), w, 4, Rng(1)), std::invalid_argument);
  }
  std::vector<std::uint32_t> too_short(1);
  Rng rng(1);
  const std::vector<double> w{0.5, 0.5};
  EXPECT_THROW(make_resampler(GetParam())->offspring(w, 2, rng, too_short), std::invalid_argument);
}

TEST_P(EveryResampler, WeightsOfTheCopiesSumToOneAndAreEqualWhereItSaysSo) {
  Rng rng(7);
  const auto resampler = make_resampler(GetParam());
  for (int round = 0; round < 200; ++round) {
    const std::vector<double> w = uneven_weights(40, rng);
    const std::uint32_t size = 10 + static_cast<std::uint32_t>(rng.index(60));
    const auto o = weighted_draw(GetParam(), w, size, rng);
    double sum = 0.0;
    for (std::size_t i = 0; i < w.size(); ++i) {
      sum += o.mass(i);
      EXPECT_GT(o.copy_weights[i], o.counts[i] > 0 ? 0.0 : -1.0);
      EXPECT_TRUE(!resampler->equal_weights() || o.copy_weights[i] == 1.0 / size);
    }
    EXPECT_NEAR(sum, 1.0, GetParam() == Resampling::reallocation ? 0.5 : 1e-9);
  }
}

TEST_P(EveryResampler, SameRandomNumbersSameOffspring) {
  Rng rng(8);
  const std::vector<double> w = uneven_weights(50, rng);
  EXPECT_EQ(draw(GetParam(), w, 50, Rng(3)), draw(GetParam(), w, 50, Rng(3)));
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryResampler, testing::ValuesIn(all_methods()), name_of);

TEST(Optimal, KeepsDistinctParticlesAboveAThreshold) {
  Rng rng(11);
  for (int round = 0; round < 100; ++round) {
    const std::vector<double> w = uneven_weights(50, rng);
    const double total = std::accumulate(w.begin(), w.end(), 0.0);
    const auto o = weighted_draw(Resampling::optimal, w, 50, rng);
    std::vector<double> raised, unchanged;
    double heaviest_below = 0.0;
    for (std::size_t i = 0; i < w.size(); ++i) {
      const bool same = std::abs(o.mass(i) - w[i] / total) < 1e-9 * o.mass(i);
      if (!same) heaviest_below = std::max(heaviest_below, w[i] / total);
      if (o.counts[i] > 0) (same ? unchanged : raised).push_back(o.mass(i));
    }
    ASSERT_EQ(raised.size() + unchanged.size(), 40u);
    const double threshold = *std::ranges::max_element(raised);
    EXPECT_NEAR(*std::ranges::min_element(raised), threshold, 1e-12);
    EXPECT_GE(*std::ranges::min_element(unchanged), threshold);
    EXPECT_LE(heaviest_below, threshold);
  }
}

TEST(Optimal, FewPositiveWeightsAllGoOnUnchanged) {
  const auto o = weighted_draw(Resampling::optimal, {0.0, 0.7, 0.0, 0.2, 0.1, 0.0}, 10, Rng(1));
  EXPECT_NEAR(o.mass(1), 0.7, 1e-15);
  EXPECT_NEAR(o.mass(3), 0.2, 1e-15);
  EXPECT_NEAR(o.mass(4), 0.1, 1e-15);
  EXPECT_EQ(o.counts[1], 7u);  // split until no copy is heavier than need be
}

TEST(Partial, ModerateParticlesKeepPlaceAndWeight) {
  const std::vector<double> w{0.30, 0.12, 0.02, 0.10, 0.16, 0.01, 0.11, 0.03, 0.08, 0.07};
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto o = weighted_draw(Resampling::partial, w, 10, Rng(seed));
    for (const std::size_t i : {1u, 3u, 4u, 6u, 8u, 9u}) {
      EXPECT_EQ(o.counts[i], 1u);
      EXPECT_DOUBLE_EQ(o.copy_weights[i], w[i]);
    }
    EXPECT_NEAR(o.copy_weights[0], 0.36 / 4, 1e-12);
    EXPECT_GE(o.counts[0], 3u);
  }
}

TEST(Reallocation, HeavyParticlesShareTheirWeight) {
  const std::vector<double> w{0.47, 0.02, 0.21, 0.05, 0.25};
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto o = weighted_draw(Resampling::reallocation, w, 10, Rng(seed));
    for (const std::size_t i : {0u, 2u, 4u}) EXPECT_NEAR(o.mass(i), w[i], 1e-12);
  }
}

TEST(Untrimmed, BranchingHasARandomNumberRoundingAFixedOne) {
  Rng rng(12);
  const std::vector<double> w = uneven_weights(30, rng);
  std::vector<std::uint32_t> counts(30);
  std::vector<double> copy_weights(30);
  const auto size_of = [&](Resampling method) {
    const std::uint32_t drawn = make_resampler(method)->untrimmed(w, 30, rng, counts, copy_weights);
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), drawn);
    return drawn;
  };
  std::uint32_t least = 30, most = 30;
  const std::uint32_t rounded = size_of(Resampling::rounding_copy);
  for (int k = 0; k < 200; ++k) {
    const std::uint32_t branched = size_of(Resampling::branching);
    least = std::min(least, branched);
    most = std::max(most, branched);
    EXPECT_EQ(size_of(Resampling::rounding_copy), rounded);
  }
  EXPECT_LT(least, 30u);
  EXPECT_GT(most, 30u);
}

TEST(RemoveDuplicates, TakesOneByOneFromTheLargest) {
  Rng rng(13);
  for (int round = 0; round < 300; ++round) {
    std::vector<std::uint32_t> counts(1 + rng.index(12));
    for (auto& n : counts) n = static_cast<std::uint32_t>(rng.index(6));
    std::vector<std::uint32_t> greedy = counts;
    const auto copies = static_cast<std::uint32_t>(rng.index(12));
    std::uint32_t taken = 0;
    for (; taken < copies; ++taken) {
      const auto most = std::ranges::max_element(greedy);
      if (*most < 2) break;
      --*most;
    }
    EXPECT_EQ(remove_duplicates(copies, counts), taken);
    EXPECT_EQ(counts, greedy);
  }
}

TEST(PlaceInSlots, SurvivorsStayAndCopiesFillTheDead) {
  const std::vector<std::uint32_t> counts{0, 3, 1, 0, 0, 2};
  std::vector<std::uint32_t> ancestors(6);
  place_in_slots(counts, ancestors);
  EXPECT_EQ(ancestors, (std::vector<std::uint32_t>{1, 1, 2, 1, 5, 5}));
}

TEST(PlaceInSlots, KeepsCountsForAnySizes) {
  Rng rng(3);
  for (const std::size_t n : {1u, 4u, 30u}) {
    for (const std::uint32_t size : {1u, 4u, 17u, 60u}) {
      std::vector<double> w(n);
      for (double& v : w) v = std::pow(rng.uniform(), 6);
      const auto counts = draw(Resampling::ssp, w, size, rng);
      std::vector<std::uint32_t> ancestors(size), seen(n, 0);
      place_in_slots(counts, ancestors);
      for (const auto a : ancestors) ++seen[a];
      EXPECT_EQ(seen, counts);
      for (std::size_t i = 0; i < std::min<std::size_t>(n, size); ++i) {
        if (counts[i] > 0) {
          EXPECT_EQ(ancestors[i], i);
        }
      }
    }
  }
}

}  // namespace
}  // namespace noctule::particle
