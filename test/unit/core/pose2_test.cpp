#include "core/pose2.hpp"

#include <gtest/gtest.h>

#include "core/rng.hpp"

namespace noctule {
namespace {

Pose2 random_pose(Rng& rng) {
  return {rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-kPi, kPi)};
}

TEST(Wrap, LiesInHalfOpenIntervalForAnyMagnitude) {
  for (const double a : {0.0, kPi, -kPi, 3 * kPi, -3 * kPi, 1e6, -1e6, 7.0}) {
    const double w = wrap(a);
    EXPECT_GE(w, -kPi);
    EXPECT_LT(w, kPi);
    EXPECT_NEAR(std::sin(w), std::sin(a), 1e-9);
    EXPECT_NEAR(std::cos(w), std::cos(a), 1e-9);
  }
}

TEST(Pose2, GroupLaws) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 a = random_pose(rng), b = random_pose(rng), c = random_pose(rng);
    EXPECT_LT(difference((a * b) * c, a * (b * c)).norm(), 1e-12);
    EXPECT_LT(difference(a * inverse(a), Pose2{}).norm(), 1e-12);
    EXPECT_LT(difference(a * between(a, b), b).norm(), 1e-12);
  }
}

TEST(Pose2, CompositionJacobiansMatchCentralDifferences) {
  Rng rng(2);
  constexpr double h = 1e-6;
  for (int i = 0; i < 100; ++i) {
    const Pose2 a = random_pose(rng), b = random_pose(rng);
    const Matrix3 left = compose_jacobian_left(a, b), right = compose_jacobian_right(a);
    for (int k = 0; k < 3; ++k) {
      const auto shifted = [k](Pose2 p, double d) {
        (k == 0 ? p.x : k == 1 ? p.y : p.yaw) += d;
        return p;
      };
      const Vector3 dl = difference(shifted(a, h) * b, shifted(a, -h) * b) / (2 * h);
      const Vector3 dr = difference(a * shifted(b, h), a * shifted(b, -h)) / (2 * h);
      EXPECT_LT((dl - left.col(k)).norm(), 1e-7);
      EXPECT_LT((dr - right.col(k)).norm(), 1e-7);
    }
  }
}

}  // namespace
}  // namespace noctule
