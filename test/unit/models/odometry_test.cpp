#include "models/odometry.hpp"

#include <gtest/gtest.h>

namespace noctule::models {
namespace {

TEST(OdometryRandomWalk, ASumOfStraightStepsDoesNotDependOnHowManyThereAre) {
  const OdometryRandomWalk noise{.along = 0.07, .drift = radians(2.5), .turn = radians(4.0)};
  const Pose2 whole{2.0, 0.0, 0.0};
  PoseGaussian sum;
  for (int i = 0; i < 64; ++i) {
    const Pose2 step{2.0 / 64, 0.0, 0.0};
    sum = sum * PoseGaussian{step, noise.covariance(step)};
  }
  EXPECT_LT((sum.covariance - noise.covariance(whole)).norm(), 1e-9 + 1e-3 * noise.covariance(whole).norm());
  EXPECT_NEAR(sum.covariance(0, 0), 0.07 * 0.07 * 2.0, 1e-12);
  EXPECT_NEAR(std::sqrt(sum.covariance(2, 2)), radians(2.5) * std::sqrt(2.0), 1e-12);
}

TEST(OdometryRandomWalk, AgreesWithTheStraightStepOfTheOtherModelUpToTheDistance) {
  const OdometryRandomWalk walk{.along = 0.0, .drift = radians(0.7), .turn = 0.0};
  const OdometryNoise steps{.distance = 0.0, .turn = 0.0, .drift = radians(0.7)};
  EXPECT_LT((walk.covariance({-1.3, 0.0, 0.0}) - steps.straight(-1.3)).norm(), 1e-15);
}

TEST(OdometryRandomWalk, TurnsWithItsFrame) {
  const OdometryRandomWalk noise;
  const Pose2 frame{0.0, 0.0, 0.9};
  const Pose2 step{0.3, -0.1, 0.2};
  const Vector2 turned = frame * step.position();
  const Matrix3 j = compose_jacobian_right(frame);
  EXPECT_LT((noise.covariance({turned.x(), turned.y(), 0.2}) - j * noise.covariance(step) * j.transpose()).norm(),
            1e-15);
}

TEST(OdometryRandomWalk, StandingStillIsCertain) {
  EXPECT_EQ(OdometryRandomWalk{}.covariance({}), Matrix3::Zero());
}

}  // namespace
}  // namespace noctule::models
