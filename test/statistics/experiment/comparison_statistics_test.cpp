/// Intervals cover as often as they say, and p-values are uniform where there is no difference.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/chi2.hpp"
#include "core/rng.hpp"
#include "experiment/comparison.hpp"

namespace noctule::experiment {
namespace {

/// Two filters over seeds that share their world: a - b has the given mean and, by `noise`, distribution.
template <class Noise>
Comparison simulate(std::uint64_t trial, int n, double mean_difference, const Noise& noise) {
  std::vector<Row> a, b;
  Rng rng(31, stream_id("comparison"), trial);
  for (int i = 0; i < n; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    const double world = 5.0 + rng.normal();
    a.push_back({"s", "a", "", seed, "error", "m", world + mean_difference + noise(rng), false});
    b.push_back({"s", "b", "", seed, "error", "m", world, false});
  }
  return compare(a, b);
}

const auto kNormal = [](Rng& rng) { return 0.5 * rng.normal(); };

bool covers(const Interval& interval, double truth) {
  return interval.low <= truth && truth <= interval.high;
}

TEST(ComparisonStatistics, IntervalsCoverTheTrueDifference) {
  constexpr int kTrials = 400, kN = 30;
  constexpr double kTruth = 0.2;
  int t = 0, bootstrap = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const Comparison c = simulate(trial, kN, kTruth, kNormal);
    t += covers(c.ci95, kTruth) ? 1 : 0;
    bootstrap += covers(c.bootstrap95, kTruth) ? 1 : 0;
  }
  const auto bound = [](double p) { return 4 * std::sqrt(p * (1 - p) / kTrials); };
  EXPECT_NEAR(t / static_cast<double>(kTrials), 0.95, bound(0.95));
  // Percentiles of resampled means of normal values are those of a normal distribution with the variance over n, so
  // that the coverage is known: a little low for few values.
  const double expected = 1.0 - 2.0 * eval::student_t_cdf(-1.959964 * std::sqrt((kN - 1.0) / kN), kN - 1.0);
  EXPECT_NEAR(bootstrap / static_cast<double>(kTrials), expected, bound(expected));
}

TEST(ComparisonStatistics, IntervalsCoverSkewedDifferencesNearly) {
  constexpr int kTrials = 400, kN = 60, kResamples = 500;
  int t = 0, bootstrap = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    Rng rng(33, stream_id("comparison"), trial);
    std::vector<double> differences(kN);
    for (double& d : differences) d = -std::log(rng.uniform()) - 1.0;
    t += covers(eval::t_interval(differences), 0.0) ? 1 : 0;
    bootstrap += covers(eval::bootstrap_interval(differences, trial, 0.95, kResamples), 0.0) ? 1 : 0;
  }
  // Edgeworth: the skewness of an exponential costs the interval about a per cent at n = 60.
  EXPECT_NEAR(t / static_cast<double>(kTrials), 0.94, 4 * std::sqrt(0.94 * 0.06 / kTrials));
  EXPECT_NEAR(bootstrap / static_cast<double>(kTrials), 0.94, 4 * std::sqrt(0.94 * 0.06 / kTrials));
}

/// Chi-square statistic of the p-values over ten equal classes; its 99.9 % bound is 27.9.
class Uniformity {
 public:
  void add(double p) {
    ++counts_[std::min<std::size_t>(9, static_cast<std::size_t>(10.0 * p))];
    ++n_;
  }
  [[nodiscard]] double statistic() const {
    double sum = 0.0;
    for (const int count : counts_) sum += (count - n_ / 10.0) * (count - n_ / 10.0) / (n_ / 10.0);
    return sum;
  }

 private:
  std::array<int, 10> counts_{};
  int n_ = 0;
};

TEST(ComparisonStatistics, PValuesAreUniformWithoutADifference) {
  constexpr int kTrials = 500, kN = 16;
  Uniformity t, permutation;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const Comparison c = simulate(trial, kN, 0.0, kNormal);
    t.add(c.p_value);
    permutation.add(c.p_permutation);
  }
  const double bound = chi2_quantile(0.999, 9);
  EXPECT_LT(t.statistic(), bound);
  EXPECT_LT(permutation.statistic(), bound);
}

TEST(ComparisonStatistics, HolmKeepsTheChanceOfAnyFalseClaim) {
  constexpr int kTrials = 1500, kComparisons = 8;
  int any = 0, uncorrected = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    Rng rng(32, stream_id("holm"), trial);
    std::vector<double> p(kComparisons);
    for (double& x : p) x = rng.uniform();
    const auto below = [](double x) { return x < 0.05; };
    uncorrected += std::ranges::any_of(p, below) ? 1 : 0;
    any += std::ranges::any_of(holm(p), below) ? 1 : 0;
  }
  const double expected = 1.0 - std::pow(1.0 - 0.05 / kComparisons, kComparisons);  // independent hypotheses
  EXPECT_NEAR(any / static_cast<double>(kTrials), expected, 4 * std::sqrt(expected * (1 - expected) / kTrials));
  EXPECT_GT(uncorrected, 5 * any);
}

}  // namespace
}  // namespace noctule::experiment
