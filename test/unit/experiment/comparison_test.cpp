#include "experiment/comparison.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/limits.hpp"
#include "core/rng.hpp"
#include "unit/experiment/fake_scenario.hpp"

namespace noctule::experiment {
namespace {

std::vector<Row> rows(const std::string& filter, const std::vector<double>& values, std::uint64_t first_seed = 1) {
  std::vector<Row> all;
  for (std::size_t i = 0; i < values.size(); ++i) {
    all.push_back({"s", filter, "N=5", first_seed + i, "error", "m", values[i], values[i] > 100.0});
  }
  return all;
}

TEST(Compare, PairsBySeedAndReportsPercentOfTheOther) {
  const Comparison c = compare(rows("new", {1.0, 2.0, 4.0}), rows("old", {2.0, 4.0, 5.0}));
  EXPECT_EQ(c.subject, (Subject{"s", "new", "N=5"}));
  EXPECT_EQ(c.against, (Subject{"s", "old", "N=5"}));
  EXPECT_EQ(c.pairs, 3);
  EXPECT_EQ(c.dropped, 0);
  EXPECT_NEAR(c.difference, -4.0 / 3, 1e-12);
  EXPECT_NEAR(c.percent, -100.0 * 4 / 11, 1e-10);
  // By hand: sd of (-1, -2, -1) is 1/sqrt(3), t = -4, P(|T_2| > 4) = 1 - 4 / sqrt(18).
  EXPECT_NEAR(c.p_value, 1.0 - 4.0 / std::sqrt(18.0), 1e-12);
  EXPECT_NEAR(c.ci95.high - c.ci95.low, 2 * 4.302652730 / 3.0, 1e-8);
  EXPECT_DOUBLE_EQ(c.p_permutation, 2.0 / 8);
  EXPECT_LE(c.bootstrap95.low, c.difference);
  EXPECT_GE(c.bootstrap95.high, c.difference);
}

TEST(Compare, SharedNoiseCancels) {
  std::vector<double> a, b;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const double world = 10.0 * Rng(seed).normal();
    a.push_back(world + 0.1);
    b.push_back(world);
  }
  const Comparison c = compare(rows("a", a), rows("b", b));
  EXPECT_NEAR(c.difference, 0.1, 1e-12);
  EXPECT_LT(c.ci95.high - c.ci95.low, 1e-10);
}

TEST(Compare, CountsWhatIsNoPair) {
  // Seeds 1..5 against 2..6: 1 and 6 stand alone, at 3 and 4 one has no number.
  const Comparison c = compare(rows("a", {1, 1, kNan, 1, 1}), rows("b", {0, 0, kNan, 0, 0}, 2));
  EXPECT_EQ(c.pairs, 2);
  EXPECT_EQ(c.dropped, 4);
  EXPECT_EQ(c.difference, 1.0);
}

TEST(Compare, DivergedRunsAreCountedAndStayInTheMean) {
  const Comparison c = compare(rows("a", {1, 101}), rows("b", {1, 1}));
  EXPECT_EQ(c.diverged, 1);
  EXPECT_EQ(c.against_diverged, 0);
  EXPECT_EQ(c.pairs, 2);
  EXPECT_EQ(c.difference, 50.0);
}

TEST(Compare, NoPairsMeansNoClaim) {
  const Comparison c = compare(rows("a", {kNan, 1.0}), rows("b", {1.0, kNan}));
  EXPECT_EQ(c.pairs, 0);
  EXPECT_EQ(c.dropped, 2);
  EXPECT_TRUE(std::isnan(c.difference));
  EXPECT_TRUE(std::isnan(c.p_value));
  const Comparison single = compare(rows("a", {2.0}), rows("b", {1.0}));
  EXPECT_EQ(single.difference, 1.0);
  EXPECT_TRUE(std::isnan(single.p_value));
}

TEST(Holm, ClosedForm) {
  // Holm (1979): sorted p times (m, m - 1, ...), never falling, at most 1.
  const std::vector<double> corrected = holm(std::vector<double>{0.01, 0.04, 0.03, 0.005});
  EXPECT_DOUBLE_EQ(corrected[3], 0.02);
  EXPECT_DOUBLE_EQ(corrected[0], 0.03);
  EXPECT_DOUBLE_EQ(corrected[2], 0.06);
  EXPECT_DOUBLE_EQ(corrected[1], 0.06);
  EXPECT_EQ(holm(std::vector<double>{0.7, 0.9}), (std::vector<double>{1.0, 1.0}));
  const std::vector<double> with_nan = holm(std::vector<double>{0.01, kNan});
  EXPECT_DOUBLE_EQ(with_nan[0], 0.01);
  EXPECT_TRUE(std::isnan(with_nan[1]));
  EXPECT_TRUE(holm({}).empty());
}

/// The definition of the closed test that Holm's method shortcuts: a hypothesis falls when every intersection that
/// holds it falls by Bonferroni.
double closed_test(const std::vector<double>& p, std::size_t hypothesis) {
  double worst = 0.0;
  for (std::size_t set = 1; set < (std::size_t{1} << p.size()); ++set) {
    if ((set >> hypothesis & 1) == 0) continue;
    double smallest = 1.0;
    int members = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      if ((set >> i & 1) == 0) continue;
      ++members;
      smallest = std::min(smallest, p[i]);
    }
    worst = std::max(worst, std::min(1.0, members * smallest));
  }
  return worst;
}

TEST(Holm, EqualsTheClosedTestByBonferroni) {
  for (std::uint64_t trial = 0; trial < 50; ++trial) {
    Rng rng(5, 0, trial);
    std::vector<double> p(6);
    for (double& x : p) x = std::pow(rng.uniform(), 3.0);
    const std::vector<double> corrected = holm(p);
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(corrected[i], closed_test(p, i), 1e-15);
  }
}

TEST(SignFlip, ExactForFewDifferences) {
  EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<double>{1.0, 2.0, 3.0}), 0.25);
  EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<double>{-1.0, -2.0, -3.0}), 0.25);
  // |sum| >= 2: all signs but those of sum 0: {1,2,-3} and its mirror.
  EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<double>{1.0, -2.0, 3.0}), 0.75);
  EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<double>{0.0, 0.0}), 1.0);
  EXPECT_TRUE(std::isnan(sign_flip_p_value({})));
  EXPECT_THROW((void)sign_flip_p_value(std::vector<double>{kNan}), std::invalid_argument);
}

TEST(SignFlip, RandomFlipsApproachTheExactValue) {
  // Eleven differences exactly; the same with zeros behind, which change no sum, by random flips.
  std::vector<double> few{0.3, -0.1, 0.8, 0.4, 0.2, -0.5, 0.9, 0.1, 0.6, -0.2, 0.25};
  const double exact = sign_flip_p_value(few);
  few.resize(80, 0.0);
  const double random = sign_flip_p_value(few);
  EXPECT_NEAR(random, exact, 4 * std::sqrt(exact * (1 - exact) / 9999));
  EXPECT_EQ(sign_flip_p_value(few), random);
}

TEST(Correct, IsOverAllThatIsShown) {
  std::vector<Comparison> shown{compare(rows("a", {1, 2, 4}), rows("b", {2, 4, 5})),
                                compare(rows("c", {1, 2, 3.5}), rows("b", {1, 2, 3}))};
  correct(shown);
  EXPECT_DOUBLE_EQ(shown[0].p_holm, 2 * shown[0].p_value);
  EXPECT_DOUBLE_EQ(shown[1].p_holm, std::max(shown[1].p_value, shown[0].p_holm));
}

TEST(Comparisons, AreReadBackAsWritten) {
  const Folder folder;
  const std::vector<Comparison> all{compare(rows("a", {1, kNan, 4}), rows("b", {2, 4, 5})),
                                    compare(rows("a", {kNan}), rows("b", {2}))};
  std::ostringstream text;
  write_comparisons(text, all);
  std::ofstream(folder / "c.csv") << text.str();
  const std::vector<Comparison> again = read_comparisons(folder / "c.csv");
  std::ostringstream second;
  write_comparisons(second, again);
  EXPECT_EQ(second.str(), text.str());
  EXPECT_EQ(again[0].difference, all[0].difference);
  EXPECT_TRUE(std::isnan(again[1].p_value));
}

}  // namespace
}  // namespace noctule::experiment
