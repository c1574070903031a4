#include "mapping/line_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/rng.hpp"
#include "mapping/rho_theta.hpp"

namespace noctule::mapping {
namespace {

std::vector<PointWithCovariance> points_on(const Wall& wall, double from, double to, int count, double sigma) {
  std::vector<PointWithCovariance> points;
  for (int i = 0; i < count; ++i) {
    const double s = from + (to - from) * i / (count - 1);
    points.push_back({foot(wall) + s * wall.tangent(), sigma * sigma * Matrix2::Identity()});
  }
  return points;
}

TEST(FitLine, RecoversLinesOfEveryDirectionExactly) {
  for (double theta = -3.1; theta < 3.1; theta += 0.37) {
    const Wall wall{1.3, theta};
    const auto fit = fit_line(points_on(wall, -0.5, 1.2, 12, 0.01));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->wall.rho, wall.rho, 1e-12);
    EXPECT_NEAR(wrap(fit->wall.theta - wall.theta), 0.0, 1e-12);
    EXPECT_NEAR(fit->chi2, 0.0, 1e-12);
  }
}

TEST(FitLine, CovarianceIsTheClosedForm) {
  const Wall wall{2.0, 0.6};
  constexpr double sigma = 0.02;
  const auto points = points_on(wall, 0.5, 2.5, 21, sigma);
  const auto fit = fit_line(points);
  ASSERT_TRUE(fit);
  double spread = 0.0;
  for (int i = 0; i < 21; ++i) spread += std::pow(0.1 * i - 1.0, 2);
  const double var_theta = sigma * sigma / spread, l = 1.5;
  EXPECT_NEAR(fit->covariance(1, 1), var_theta, 1e-12);
  EXPECT_NEAR(fit->covariance(0, 1), l * var_theta, 1e-12);
  EXPECT_NEAR(fit->covariance(0, 0), sigma * sigma / 21 + l * l * var_theta, 1e-12);
}

TEST(FitLine, WeighsPointsByTheirVarianceAcrossTheLine) {
  // Two points far off, but uncertain in just that direction, must not turn the line.
  auto points = points_on({1.0, kPi / 2.0}, -1.0, 1.0, 10, 0.01);
  const Matrix2 tall = Vector2(1e-4, 1e4).asDiagonal();
  points.push_back({{-1.0, 1.5}, tall});
  points.push_back({{1.0, 0.5}, tall});
  const auto fit = fit_line(points);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->wall.rho, 1.0, 1e-5);
  EXPECT_NEAR(fit->wall.theta, kPi / 2.0, 1e-5);
}

TEST(FitLine, RefusesWhatDoesNotDetermineALine) {
  EXPECT_FALSE(fit_line({}));
  const PointWithCovariance p{{1.0, 2.0}, Matrix2::Identity()};
  EXPECT_FALSE(fit_line(std::vector{p}));
  EXPECT_FALSE(fit_line(std::vector{p, p}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)fit_line(std::vector{p, {{nan, 0.0}, Matrix2::Identity()}}), std::invalid_argument);
  EXPECT_THROW((void)fit_line(std::vector{p, {{0.0, 0.0}, Matrix2::Zero()}}), std::invalid_argument);
}

TEST(RhoTheta, OneLineHasTwoNames) {
  const Wall w{0.4, 2.0};
  EXPECT_TRUE(near(w, flipped(w), 1e-9, 1e-9));
  EXPECT_NEAR((foot(w) - foot(flipped(w))).norm(), 0.0, 1e-12);
  EXPECT_FALSE(near(w, {-0.4, 2.0}, 0.1, 0.1));
  EXPECT_NEAR(aligned(flipped(w), w).rho, 0.4, 1e-12);
  // Across the seam: rho just below and above 0.
  EXPECT_TRUE(near({0.01, 0.3}, {0.01, wrap(0.3 + kPi)}, 0.03, 0.01));
}

}  // namespace
}  // namespace noctule::mapping
