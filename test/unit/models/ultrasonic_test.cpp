#include "models/ultrasonic.hpp"

#include <gtest/gtest.h>

#include "core/rng.hpp"

namespace noctule::models {
namespace {

constexpr double kDifference = 1e-6;

template <int D, class Make>
void expect_jacobians(const Vector2& p, const Eigen::Matrix<double, D, 1>& x, const Make& make) {
  const auto e = predict_echo(p, make(x));
  for (int k = 0; k < 2; ++k) {
    Vector2 h = Vector2::Zero();
    h[k] = kDifference;
    const auto a = predict_echo(Vector2(p + h), make(x)), b = predict_echo(Vector2(p - h), make(x));
    EXPECT_NEAR((a.range - b.range) / (2 * kDifference), e.range_by_position[k], 1e-7);
    EXPECT_NEAR(wrap(a.direction - b.direction) / (2 * kDifference), e.direction_by_position[k], 1e-6);
  }
  for (int k = 0; k < D; ++k) {
    Eigen::Matrix<double, D, 1> h = Eigen::Matrix<double, D, 1>::Zero();
    h[k] = kDifference;
    const auto a = predict_echo(p, make(x + h)), b = predict_echo(p, make(x - h));
    EXPECT_NEAR((a.range - b.range) / (2 * kDifference), e.range_by_feature[k], 1e-7);
    EXPECT_NEAR(wrap(a.direction - b.direction) / (2 * kDifference), e.direction_by_feature[k], 1e-6);
  }
}

TEST(PredictEcho, JacobiansMatchCentralDifferences) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Vector2 p(rng.uniform(-2, 2), rng.uniform(-2, 2));
    expect_jacobians<2>(p, Vector2(rng.uniform(1, 4), rng.uniform(-3, 3)), [](const Vector2& x) {
      return Wall{x[0], x[1]};
    });
    expect_jacobians<3>(p, Vector3(rng.uniform(3, 5), rng.uniform(-3, 3), rng.uniform(0.05, 0.4)),
                        [](const Vector3& x) {
                          return Cylinder{x.head<2>(), x[2]};
                        });
  }
}

TEST(PredictEcho, ACylinderOfGreatRadiusIsAWall) {
  const Wall wall{2.0, 0.7};
  constexpr double radius = 1e6;
  const Cylinder cylinder{wall.normal() * (wall.rho + radius), radius};
  const Vector2 p(0.3, -0.4);
  EXPECT_NEAR(predict_echo(p, wall).range, predict_echo(p, cylinder).range, 1e-6);
}

}  // namespace
}  // namespace noctule::models
