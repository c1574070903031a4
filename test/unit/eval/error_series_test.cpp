#include "eval/error_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace noctule::eval {
namespace {

TEST(ErrorStatistics, ClosedForm) {
  const ErrorStatistics s = error_statistics(std::vector<double>{3.0, 1.0, 4.0, 4.0});
  EXPECT_EQ(s.samples, 4);
  EXPECT_NEAR(s.rmse, std::sqrt(42.0 / 4), 1e-12);
  EXPECT_EQ(s.mean, 3.0);
  EXPECT_EQ(s.median, 3.5);
  EXPECT_NEAR(s.sd, std::sqrt(6.0 / 4), 1e-12);
  EXPECT_NEAR(s.rmse * s.rmse, s.mean * s.mean + s.sd * s.sd, 1e-12);
  EXPECT_EQ(s.min, 1.0);
  EXPECT_EQ(s.max, 4.0);
  EXPECT_TRUE(std::isnan(error_statistics({}).rmse));
  EXPECT_THROW((void)error_statistics(std::vector<double>{std::nan("")}), std::invalid_argument);
}

TEST(RmseOverRuns, AtEachTimeOverTheRunsThatLastThatLong) {
  const std::vector<std::vector<double>> runs{{3.0, 1.0}, {4.0, -1.0, 5.0}};
  const auto rmse = rmse_over_runs(runs);
  ASSERT_EQ(rmse.size(), 3u);
  EXPECT_NEAR(rmse[0], std::sqrt(12.5), 1e-12);
  EXPECT_NEAR(rmse[1], 1.0, 1e-12);
  EXPECT_NEAR(rmse[2], 5.0, 1e-12);
  EXPECT_TRUE(rmse_over_runs({}).empty());
  EXPECT_THROW((void)rmse_over_runs(std::vector<std::vector<double>>{{INFINITY}}), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::eval
