#include "mapping/circle_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/angles.hpp"

namespace noctule::mapping {
namespace {

std::vector<Vector2> arc(const Cylinder& c, double from, double to, int count) {
  std::vector<Vector2> points;
  for (int i = 0; i < count; ++i) {
    const double a = from + (to - from) * i / (count - 1);
    points.push_back(c.centre + c.radius * Vector2(std::cos(a), std::sin(a)));
  }
  return points;
}

std::vector<PointWithCovariance> uncertain(const std::vector<Vector2>& points, double sigma) {
  std::vector<PointWithCovariance> result;
  for (const Vector2& p : points) result.push_back({p, sigma * sigma * Matrix2::Identity()});
  return result;
}

TEST(CircleFits, RecoverCirclesExactly) {
  const Cylinder truth{{0.60, -1.20}, 0.106346};
  for (const double extent : {0.5, 1.5, 3.0, 6.0}) {
    const auto points = arc(truth, 0.3, 0.3 + extent, 24);
    const auto geometric = fit_circle(uncertain(points, 0.003));
    ASSERT_TRUE(geometric);
    for (const Cylinder& c : {*kasa_circle(points), *taubin_circle(points), geometric->circle}) {
      EXPECT_NEAR((c.centre - truth.centre).norm(), 0.0, 1e-8) << extent;
      EXPECT_NEAR(c.radius, truth.radius, 1e-8) << extent;
    }
  }
}

TEST(CircleFits, CovarianceOfTheFullCircleIsTheClosedForm) {
  // n points all around: var x = var y = 2 sigma^2 / n, var R = sigma^2 / n, uncorrelated.
  constexpr double sigma = 0.003;
  auto points = arc({{1.0, 2.0}, 0.15}, 0.0, kTwoPi, 25);
  points.pop_back();
  const auto fit = fit_circle(uncertain(points, sigma));
  ASSERT_TRUE(fit);
  const Matrix3 expected = (sigma * sigma / 24.0) * Vector3(2.0, 2.0, 1.0).asDiagonal();
  EXPECT_LT((fit->covariance - expected).norm(), 1e-12);
}

TEST(CircleFits, RefuseWhatDoesNotDetermineACircle) {
  const std::vector<Vector2> two{{0, 0}, {1, 0}}, line{{0, 0}, {1, 1}, {2, 2}, {3, 3}};
  EXPECT_FALSE(kasa_circle(two));
  EXPECT_FALSE(taubin_circle(two));
  EXPECT_FALSE(kasa_circle(line));
  EXPECT_FALSE(taubin_circle(line));
  EXPECT_FALSE(fit_circle(uncertain(line, 0.01)));
  EXPECT_FALSE(taubin_circle(std::vector<Vector2>(5, Vector2(1.0, 1.0))));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)fit_circle(uncertain({{0, 0}, {1, nan}, {2, 0}}, 0.01)), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::mapping
