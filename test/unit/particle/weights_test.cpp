#include "particle/weights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/limits.hpp"

namespace noctule::particle {
namespace {

TEST(Weights, StartUniformWithFullSampleSize) {
  const Weights w(8);
  EXPECT_DOUBLE_EQ(w.effective_sample_size(), 8.0);
  for (const double v : w.linear()) EXPECT_DOUBLE_EQ(v, 0.125);
}

TEST(Weights, MultiplyIsBayesRuleFarBelowTheSmallestDouble) {
  Weights w(3);
  // Likelihoods 1e-2000 times (1, 2, 5): evidence is their mean.
  const double tiny = -2000.0 * std::log(10.0);
  const std::vector<double> likelihoods{tiny, tiny + std::log(2.0), tiny + std::log(5.0)};
  EXPECT_NEAR(w.multiply(likelihoods), tiny + std::log(8.0 / 3.0), 1e-9);
  const auto linear = w.linear();  // logs of 4605 carry rounding errors of 1e-12
  EXPECT_NEAR(linear[0], 1.0 / 8.0, 1e-11);
  EXPECT_NEAR(linear[2], 5.0 / 8.0, 1e-11);
  EXPECT_NEAR(w.effective_sample_size(), 64.0 / 30.0, 1e-11);
  EXPECT_EQ(w.collapses(), 0);
}

TEST(Weights, CollapseIsCountedAndLeavesUniformWeights) {
  Weights w(4);
  EXPECT_TRUE(std::isfinite(w.multiply(std::vector{0.0, -kInf, -1.0, -2.0})));
  EXPECT_EQ(w.log()[1], -kInf);
  EXPECT_EQ(w.multiply(std::vector{-kInf, 0.0, -kInf, -kInf}), -kInf);
  EXPECT_EQ(w.collapses(), 1);
  EXPECT_DOUBLE_EQ(w.effective_sample_size(), 4.0);
}

TEST(Weights, RefuseNotANumber) {
  Weights w(2);
  w.multiply(std::vector{0.0, -1.0});
  const auto before = w.linear();
  EXPECT_THROW(w.multiply(std::vector{std::nan(""), 0.0}), std::domain_error);
  EXPECT_THROW(w.multiply(std::vector{0.0, kInf}), std::domain_error);
  EXPECT_THROW(w.multiply(std::vector{0.0}), std::invalid_argument);
  EXPECT_EQ(w.linear(), before);
  EXPECT_THROW(Weights(0), std::invalid_argument);
}

TEST(Weights, AreAssignedUpToTheirSum) {
  Weights w(2);
  w.assign(std::vector{std::log(3.0), 0.0});
  EXPECT_NEAR(w.linear()[0], 0.75, 1e-15);
  EXPECT_THROW(w.assign(std::vector{std::nan(""), 0.0}), std::domain_error);
  EXPECT_THROW(w.assign(std::vector{-kInf, -kInf}), std::domain_error);
  EXPECT_NEAR(w.linear()[0], 0.75, 1e-15);
}

}  // namespace
}  // namespace noctule::particle
