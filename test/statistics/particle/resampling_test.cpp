/// Unbiasedness, bounds and variance of the resamplers, 4e4 draws each.
#include "particle/resampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/chi2.hpp"

namespace noctule::particle {
namespace {

constexpr std::uint32_t kSize = 12;
constexpr int kDraws = 40000;

/// Twelve weights of a Dirichlet(0.6) distribution, in the given order.
std::vector<double> uneven_weights() {
  // Gamma(0.6) by Marsaglia and Tsang with the boost for shapes below 1.
  Rng rng(20);
  std::vector<double> w(kSize);
  for (double& v : w) {
    const double d = 1.6 - 1.0 / 3.0, c = 1.0 / std::sqrt(9.0 * d);
    for (;;) {
      const double x = rng.normal(), t = std::pow(1.0 + c * x, 3);
      if (t > 0.0 && std::log(rng.uniform()) < 0.5 * x * x + d - d * t + d * std::log(t)) {
        v = d * t * std::pow(rng.uniform(), 1.0 / 0.6);
        break;
      }
    }
  }
  const double total = std::accumulate(w.begin(), w.end(), 0.0);
  for (double& v : w) v /= total;
  return w;
}

struct Moments {
  std::vector<double> mean = std::vector<double>(kSize, 0.0);
  std::vector<double> variance = std::vector<double>(kSize, 0.0);
  std::vector<double> mass = std::vector<double>(kSize, 0.0);           ///< mean of n_i copy_weights_i
  std::vector<double> mass_variance = std::vector<double>(kSize, 0.0);  ///< about the weight
  double largest_deviation = 0.0;
  [[nodiscard]] double total_variance() const { return std::accumulate(variance.begin(), variance.end(), 0.0); }
};

Moments measure(Resampling method, const std::vector<double>& w, std::uint64_t seed, bool trimmed = true) {
  const auto resampler = make_resampler(method);
  Moments m;
  std::vector<std::uint32_t> counts(w.size());
  std::vector<double> copy_weights(w.size());
  for (int k = 0; k < kDraws; ++k) {
    Rng rng(seed, stream_id("test"), static_cast<std::uint64_t>(k));
    if (trimmed) {
      resampler->offspring(w, kSize, rng, counts, copy_weights);
    } else {
      resampler->untrimmed(w, kSize, rng, counts, copy_weights);
    }
    for (std::size_t i = 0; i < w.size(); ++i) {
      const double mass = counts[i] * copy_weights[i];
      m.mass[i] += mass / kDraws;
      m.mass_variance[i] += (mass - w[i]) * (mass - w[i]) / kDraws;
      m.mean[i] += counts[i];
      const double deviation = counts[i] - kSize * w[i];
      m.variance[i] += deviation * deviation;
      m.largest_deviation = std::max(m.largest_deviation, std::abs(deviation));
    }
  }
  for (double& v : m.mean) v /= kDraws;
  for (double& v : m.variance) v /= kDraws;
  return m;
}

void expect_unbiased(const Moments& m, const std::vector<double>& w) {
  for (std::size_t i = 0; i < w.size(); ++i) {
    EXPECT_LT(std::abs(m.mean[i] - kSize * w[i]), 4.0 * std::sqrt(m.variance[i] / kDraws) + 1e-12) << "particle " << i;
  }
}

/// sum f (1 - f) of the fractional parts f of M w: no unbiased scheme with whole offspring has less variance.
double variance_floor(const std::vector<double>& w) {
  double sum = 0.0;
  for (const double v : w) {
    const double f = kSize * v - std::floor(kSize * v);
    sum += f * (1.0 - f);
  }
  return sum;
}

TEST(ResamplingStatistics, MultinomialHasMultinomialMomentsAndCounts) {
  const auto w = uneven_weights();
  const auto m = measure(Resampling::multinomial, w, 1);
  expect_unbiased(m, w);
  double expected = 0.0;
  for (const double v : w) expected += kSize * v * (1.0 - v);
  EXPECT_NEAR(m.total_variance(), expected, 0.03 * expected);

  // Chi-square of the distribution of one particle's count: binomial(M, w).
  const auto resampler = make_resampler(Resampling::multinomial);
  const std::vector<double> two{0.3, 0.7};
  std::vector<int> histogram(kSize + 1, 0);
  std::vector<std::uint32_t> counts(2);
  for (int k = 0; k < kDraws; ++k) {
    Rng rng(9, stream_id("test"), static_cast<std::uint64_t>(k));
    resampler->offspring(two, kSize, rng, counts);
    ++histogram[counts[0]];
  }
  double chi2 = 0.0;
  int cells = 0;
  for (std::uint32_t k = 0; k <= kSize; ++k) {
    const double log_choose = std::lgamma(kSize + 1.0) - std::lgamma(k + 1.0) - std::lgamma(kSize - k + 1.0);
    const double expected_count = kDraws * std::exp(log_choose + k * std::log(0.3) + (kSize - k) * std::log(0.7));
    if (expected_count < 5.0) continue;
    chi2 += std::pow(histogram[k] - expected_count, 2) / expected_count;
    ++cells;
  }
  EXPECT_LT(chi2, chi2_quantile(0.999, cells - 1));
}

TEST(ResamplingStatistics, StratifiedIsUnbiasedWithinTwoAndBelowMultinomial) {
  const auto w = uneven_weights();
  const auto m = measure(Resampling::stratified, w, 2);
  expect_unbiased(m, w);
  EXPECT_LT(m.largest_deviation, 2.0);
  EXPECT_LT(m.total_variance(), measure(Resampling::multinomial, w, 2).total_variance());
  EXPECT_GE(m.total_variance(), 0.98 * variance_floor(w));
}

class MinimumVariance : public testing::TestWithParam<Resampling> {};

TEST_P(MinimumVariance, IsUnbiasedWithinOneAndReachesTheFloor) {
  const auto w = uneven_weights();
  const auto m = measure(GetParam(), w, 3);
  expect_unbiased(m, w);
  EXPECT_LT(m.largest_deviation, 1.0 + 1e-9);
  EXPECT_NEAR(m.total_variance(), variance_floor(w), 0.03 * variance_floor(w));
}

TEST_P(MinimumVariance, ExpectationsFollowAPermutationOfTheParticles) {
  auto w = uneven_weights();
  std::rotate(w.begin(), w.begin() + 5, w.end());
  std::swap(w[0], w[9]);
  expect_unbiased(measure(GetParam(), w, 4), w);
}

INSTANTIATE_TEST_SUITE_P(Methods, MinimumVariance,
                         testing::Values(Resampling::systematic, Resampling::ssp, Resampling::residual_systematic,
                                         Resampling::rsr, Resampling::regularised));

TEST(ResamplingStatistics, ResidualHasTheVarianceOfItsRemainder) {
  const auto w = uneven_weights();
  const auto m = measure(Resampling::residual, w, 5);
  expect_unbiased(m, w);
  double left = 0.0, squares = 0.0;
  for (const double v : w) {
    const double f = kSize * v - std::floor(kSize * v);
    left += f;
    squares += f * f;
  }
  EXPECT_NEAR(m.total_variance(), left - squares / left, 0.03 * left);
}

TEST(ResamplingStatistics, BranchingReachesTheFloorAndTrimmingBiasesItLittle) {
  const auto w = uneven_weights();
  const auto m = measure(Resampling::branching, w, 6, false);
  expect_unbiased(m, w);
  EXPECT_LT(m.largest_deviation, 1.0);
  EXPECT_NEAR(m.total_variance(), variance_floor(w), 0.03 * variance_floor(w));
  const auto trimmed = measure(Resampling::branching, w, 6);
  for (std::size_t i = 0; i < w.size(); ++i) {
    const double bound = std::max(0.25, w[i] * variance_floor(w)) / kSize;
    EXPECT_LT(std::abs(trimmed.mean[i] - kSize * w[i]), bound + 4.0 * std::sqrt(trimmed.variance[i] / kDraws));
  }
}

TEST(ResamplingStatistics, RoundingCopyIsBiasedByUpToHalfACopyAndHasNoVariance) {
  auto w = uneven_weights();
  const auto m = measure(Resampling::rounding_copy, w, 7, false);
  for (std::size_t i = 0; i < w.size(); ++i) {
    EXPECT_LE(std::abs(m.mean[i] - kSize * w[i]), 0.5);
    EXPECT_NEAR(m.mean[i], std::floor(kSize * w[i] + 0.5), 1e-9);
  }
}

/// Chain m ends at i with probability [m = i] a_i + (1 - a_m) w_i, a = w / max w; chains are independent.
TEST(ResamplingStatistics, RejectionIsUnbiasedWithTheVarianceOfItsTrials) {
  const auto w = uneven_weights();
  const auto m = measure(Resampling::rejection, w, 8);
  expect_unbiased(m, w);
  const double largest = *std::ranges::max_element(w);
  double expected = 0.0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    for (std::size_t chain = 0; chain < w.size(); ++chain) {
      const double p = (chain == i ? w[i] / largest : 0.0) + (1.0 - w[chain] / largest) * w[i];
      expected += p * (1.0 - p);
    }
  }
  EXPECT_NEAR(m.total_variance(), expected, 0.03 * expected);
}

/// (1 - mean w / max w)^32 of the distance to the weights is left after 32 steps.
TEST(ResamplingStatistics, MetropolisForgetsItsStart) {
  const auto w = uneven_weights();
  const auto m = measure(Resampling::metropolis, w, 9);
  const double left = std::pow(1.0 - 1.0 / (kSize * *std::ranges::max_element(w)), 32);
  ASSERT_LT(left, 0.01);
  double multinomial = 0.0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    EXPECT_LT(std::abs(m.mean[i] - kSize * w[i]), left * kSize + 4.0 * std::sqrt(m.variance[i] / kDraws));
    multinomial += kSize * w[i] * (1.0 - w[i]);
  }
  EXPECT_NEAR(m.total_variance(), multinomial, 0.03 * multinomial);
}

class UnequalWeights : public testing::TestWithParam<Resampling> {};

TEST_P(UnequalWeights, StandForThoseOfTheParents) {
  auto w = uneven_weights();
  for (const std::uint64_t seed : {10u, 11u}) {
    const auto m = measure(GetParam(), w, seed);
    for (std::size_t i = 0; i < w.size(); ++i) {
      EXPECT_LT(std::abs(m.mass[i] - w[i]), 4.0 * std::sqrt(m.mass_variance[i] / kDraws) + 1e-12) << "particle " << i;
    }
    std::rotate(w.begin(), w.begin() + 5, w.end());
  }
}

TEST_P(UnequalWeights, AreEvenedOutWithoutBias) {
  const auto w = uneven_weights();
  const auto resampler = make_resampler(GetParam());
  std::vector<double> mean(w.size(), 0.0), variance(w.size(), 0.0);
  std::vector<std::uint32_t> counts(w.size());
  for (int k = 0; k < kDraws; ++k) {
    Rng rng(12, stream_id("test"), static_cast<std::uint64_t>(k));
    resampler->offspring(w, kSize, rng, counts);
    for (std::size_t i = 0; i < w.size(); ++i) {
      mean[i] += counts[i] / static_cast<double>(kDraws);
      variance[i] += std::pow(counts[i] - kSize * w[i], 2) / kDraws;
    }
  }
  // Evening out divides by the random sum of reallocated weights: a bias of second order, as in a weighted mean.
  const double ratio = GetParam() == Resampling::reallocation ? 1.0 / kSize : 0.0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    EXPECT_LT(std::abs(mean[i] - kSize * w[i]), 4.0 * std::sqrt(variance[i] / kDraws) + ratio + 1e-12) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, UnequalWeights,
                         testing::Values(Resampling::optimal, Resampling::reallocation, Resampling::partial));

}  // namespace
}  // namespace noctule::particle
