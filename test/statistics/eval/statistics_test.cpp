#include "eval/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/angles.hpp"
#include "core/gaussian.hpp"
#include "eval/trajectory.hpp"

namespace noctule::eval {
namespace {

TEST(Statistics, ClosedForms) {
  const std::vector<double> v{2, 4, 4, 4, 5, 5, 7, 9};
  EXPECT_EQ(mean(v), 5.0);
  EXPECT_NEAR(standard_deviation(v), std::sqrt(32.0 / 7), 1e-12);
  EXPECT_EQ(quantile(v, 0.0), 2.0);
  EXPECT_EQ(quantile(v, 1.0), 9.0);
  EXPECT_EQ(quantile(v, 0.5), 4.5);
  EXPECT_NEAR(quantile(std::vector<double>{10, 0}, 0.25), 2.5, 1e-12);
}

TEST(Statistics, RefuseNothingAndNotANumber) {
  const std::vector<double> bad{1.0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THROW((void)mean({}), std::invalid_argument);
  EXPECT_THROW((void)mean(bad), std::invalid_argument);
  EXPECT_THROW((void)quantile(bad, 0.5), std::invalid_argument);
  EXPECT_THROW((void)bootstrap_interval(bad, 1), std::invalid_argument);
  EXPECT_THROW((void)paired_difference(bad, bad), std::invalid_argument);
  EXPECT_THROW((void)quantile(std::vector<double>{1.0}, 1.5), std::invalid_argument);
  EXPECT_THROW((void)paired_difference(bad, std::vector<double>{1.0}), std::invalid_argument);
}

TEST(StudentT, KnownQuantiles) {
  EXPECT_NEAR(student_t_quantile(0.975, 1), 12.706204736, 1e-8);
  EXPECT_NEAR(student_t_quantile(0.975, 10), 2.228138852, 1e-8);
  EXPECT_NEAR(student_t_quantile(0.025, 10), -2.228138852, 1e-8);
  EXPECT_NEAR(student_t_quantile(0.975, 1e6), 1.959966, 1e-5);
  EXPECT_NEAR(student_t_cdf(1.0, 1), 0.75, 1e-12);
  EXPECT_THROW((void)student_t_quantile(1.0, 3), std::domain_error);
  EXPECT_THROW((void)student_t_cdf(1.0, 0), std::domain_error);
}

TEST(Intervals, CoverTheMeanAsOftenAsTheySay) {
  constexpr int kTrials = 2000, kN = 12;
  int covered = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    Rng rng(21, 0, trial);
    std::vector<double> v(kN);
    for (double& x : v) x = rng.normal(3.0, 2.0);
    const Interval i = t_interval(v);
    covered += i.low <= 3.0 && 3.0 <= i.high ? 1 : 0;
  }
  EXPECT_NEAR(covered / static_cast<double>(kTrials), 0.95, 4 * std::sqrt(0.95 * 0.05 / kTrials));
}

TEST(Intervals, BootstrapAgreesWithStudentForManyNormalValues) {
  std::vector<double> v(400);
  Rng rng(22);
  for (double& x : v) x = rng.normal(-1.0, 5.0);
  const Interval t = t_interval(v), b = bootstrap_interval(v, 1);
  EXPECT_NEAR(b.low, t.low, 0.08);
  EXPECT_NEAR(b.high, t.high, 0.08);
  const Interval again = bootstrap_interval(v, 1);
  EXPECT_EQ(b.low, again.low);
  EXPECT_EQ(b.high, again.high);
  EXPECT_TRUE(std::isnan(t_interval(std::vector<double>{1.0}).low));
}

TEST(PairedDifference, ClosedForm) {
  const std::vector<double> a{1.0, 2.0, 4.0}, b{2.0, 4.0, 5.0};
  const PairedDifference d = paired_difference(a, b);
  EXPECT_EQ(d.n, 3);
  EXPECT_NEAR(d.mean, -4.0 / 3, 1e-12);
  EXPECT_NEAR(d.sd, std::sqrt(1.0 / 3), 1e-12);
  EXPECT_NEAR(d.relative, -4.0 / 11, 1e-12);
  // t = -4 with 2 degrees of freedom: p = 1 - t / sqrt(t^2 + 2)
  EXPECT_NEAR(d.p_value, 1 - 4 / std::sqrt(18.0), 1e-12);
  EXPECT_EQ(paired_difference(a, a).p_value, 1.0);
}

TEST(PairedDifference, FindsWhatCommonNumbersMakeVisible) {
  std::vector<double> a, b;
  Rng rng(23);
  for (int i = 0; i < 50; ++i) {
    const double common = rng.normal(10, 5);
    a.push_back(common + rng.normal(0, 0.1));
    b.push_back(common + 0.1 + rng.normal(0, 0.1));
  }
  EXPECT_LT(paired_difference(a, b).p_value, 0.01);
}

/// The consistency test itself: right covariances keep the bounds, covariances half as large break them.
TEST(Nees, AverageKeepsItsBoundsOnlyWhenTheCovarianceIsRight) {
  constexpr int kRuns = 200;
  Matrix3 covariance;
  covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  const Matrix3 root = square_root<3>(covariance);
  std::vector<double> right, overconfident;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    Rng rng(31, 0, run);
    const Vector3 e = sample_gaussian<3>(root, rng);
    const Pose2 truth{1, 2, kPi - 0.02};
    const Pose2 estimate{truth.x + e.x(), truth.y + e.y(), wrap(truth.yaw + e.z())};
    right.push_back(nees(estimate, covariance, truth));
    overconfident.push_back(nees(estimate, 0.5 * covariance, truth));
  }
  const Interval bounds = nees_bounds(3, kRuns, 0.999);
  EXPECT_GT(nees_summary(right).mean, bounds.low);
  EXPECT_LT(nees_summary(right).mean, bounds.high);
  EXPECT_NEAR(nees_summary(right).inside, 0.95, 4 * std::sqrt(0.95 * 0.05 / kRuns));
  EXPECT_GT(nees_summary(overconfident).mean, bounds.high);
}

}  // namespace
}  // namespace noctule::eval
