#include "models/motion.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "core/rng.hpp"

namespace noctule::models {
namespace {

using Predict = std::function<MotionPrediction(const Pose2&, double, double)>;

constexpr double kDt = 0.3;

const Predict kEuler = [](const Pose2& p, double v, double w) {
  return predict_unicycle(p, v, w, kDt, Integration::euler);
};
const Predict kArc = [](const Pose2& p, double v, double w) { return predict_unicycle(p, v, w, kDt); };
const Predict kFrontAxle = [](const Pose2& p, double v, double g) { return predict_front_axle(p, v, g, 0.12, kDt); };

void expect_jacobians(const Predict& predict, const Pose2& p, double u0, double u1) {
  constexpr double h = 1e-6;
  const MotionPrediction m = predict(p, u0, u1);
  Matrix3 by_pose;
  by_pose.col(0) = difference(predict({p.x + h, p.y, p.yaw}, u0, u1).pose, predict({p.x - h, p.y, p.yaw}, u0, u1).pose);
  by_pose.col(1) = difference(predict({p.x, p.y + h, p.yaw}, u0, u1).pose, predict({p.x, p.y - h, p.yaw}, u0, u1).pose);
  by_pose.col(2) = difference(predict({p.x, p.y, p.yaw + h}, u0, u1).pose, predict({p.x, p.y, p.yaw - h}, u0, u1).pose);
  Eigen::Matrix<double, 3, 2> by_control;
  by_control.col(0) = difference(predict(p, u0 + h, u1).pose, predict(p, u0 - h, u1).pose);
  by_control.col(1) = difference(predict(p, u0, u1 + h).pose, predict(p, u0, u1 - h).pose);
  EXPECT_LT((by_pose / (2 * h) - m.by_pose).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((by_control / (2 * h) - m.by_control).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(MotionModels, JacobiansMatchCentralDifferences) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Pose2 p{rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-3, 3)};
    const double v = rng.uniform(-1, 1);
    for (const double w : {rng.uniform(-3, 3), 1e-3, 1e-9, 0.0}) {
      expect_jacobians(kEuler, p, v, w);
      expect_jacobians(kArc, p, v, w);
    }
    expect_jacobians(kFrontAxle, p, v, rng.uniform(-0.5, 0.5));
  }
}

TEST(Unicycle, ArcReturnsToItsStartAfterOneTurn) {
  const Pose2 start{0.4, -0.2, 1.1};
  const double w = 0.7, dt = kTwoPi / w / 50.0;
  Pose2 p = start;
  for (int i = 0; i < 50; ++i) p = predict_unicycle(p, 0.5, w, dt).pose;
  EXPECT_LT(difference(p, start).norm(), 1e-12);
}

TEST(Unicycle, ArcIsTheSameInOneStepOrMany) {
  const Pose2 start{0.1, 0.2, -0.3};
  for (const double w : {2.0, 1e-3, 1e-8, 0.0}) {
    Pose2 p = start;
    for (int i = 0; i < 10; ++i) p = predict_unicycle(p, 0.5, w, 0.1).pose;
    EXPECT_LT(difference(p, predict_unicycle(start, 0.5, w, 1.0).pose).norm(), 1e-14) << w;
  }
}

TEST(Unicycle, EulerIsOffByHalfSpeedTimesTurnRateTimesTimeSquared) {
  const double v = 0.8, w = 0.6, dt = 1e-3;
  const Vector3 error = difference(predict_unicycle({}, v, w, dt, Integration::euler).pose,
                                   predict_unicycle({}, v, w, dt, Integration::arc).pose);
  EXPECT_NEAR(error.head<2>().norm() / (v * w * dt * dt / 2), 1.0, 1e-3);
  EXPECT_EQ(error[2], 0.0);
}

TEST(FrontAxle, TurnsAboutTheCentreThatGeometryGives) {
  // The front axle runs on a circle of radius wheelbase / sin(steering): after the circle's period it is back.
  const double wheelbase = 0.12, steering = radians(30), speed = 0.2;
  const double period = kTwoPi * wheelbase / std::sin(steering) / speed;
  constexpr int kSteps = 100000;
  Pose2 p;
  for (int i = 0; i < kSteps; ++i) p = predict_front_axle(p, speed, steering, wheelbase, period / kSteps).pose;
  EXPECT_LT(difference(p, Pose2{}).norm(), 1e-4);
}

TEST(FrontAxle, GoesStraightWithoutSteering) {
  const Pose2 p = predict_front_axle({1.0, 2.0, 0.5}, 0.4, 0.0, 0.12, 2.5).pose;
  EXPECT_LT(difference(p, {1.0 + std::cos(0.5), 2.0 + std::sin(0.5), 0.5}).norm(), 1e-15);
}

}  // namespace
}  // namespace noctule::models
