#include "particle/resampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace noctule::particle {
namespace {

constexpr Resampling kAll[] = {Resampling::multinomial, Resampling::stratified, Resampling::systematic,
                               Resampling::ssp};

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
        std::vector<double> w(n);
        for (double& v : w) v = std::pow(rng.uniform(), 8);
        const auto counts = draw(GetParam(), w, size, rng);
        rng();  // another stream position next time
        EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), size);
      }
    }
  }
}

TEST_P(EveryResampler, GivesExactlySoManyOffspringToAMillion) {
  constexpr std::uint32_t n = 1000000;
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

INSTANTIATE_TEST_SUITE_P(Methods, EveryResampler, testing::ValuesIn(kAll));

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
