#include "smoothing/kalman.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "core/pose2.hpp"

namespace noctule::smoothing {
namespace {

using Vector1 = VectorD<1>;
using Matrix1 = MatrixD<1>;

Matrix1 scalar(double v) {
  return Matrix1::Constant(v);
}

TEST(Kalman, ConstantStateIsTheWeightedMean) {
  KalmanSmoother<1> filter({Vector1(1.0), scalar(4.0)});
  double information = 1.0 / 4.0, weighted = 1.0 / 4.0;
  for (const double z : {2.0, -1.0, 0.5}) {
    const UpdateResult r = filter.update<1>(Vector1(z), scalar(1.0), scalar(0.5));
    const double variance = 1.0 / information + 0.5, innovation = z - weighted / information;
    EXPECT_NEAR(r.nis, innovation * innovation / variance, 1e-12);
    EXPECT_NEAR(r.log_likelihood, log_gaussian(innovation, variance), 1e-12);
    information += 1.0 / 0.5;
    weighted += z / 0.5;
  }
  EXPECT_NEAR(filter.estimate().mean[0], weighted / information, 1e-12);
  EXPECT_NEAR(filter.estimate().covariance(0, 0), 1.0 / information, 1e-12);
}

TEST(Kalman, RandomWalkSettlesAtTheRootOfItsRiccatiEquation) {
  constexpr double q = 0.3, r = 2.0;
  KalmanSmoother<1> filter({Vector1(0.0), scalar(50.0)});
  for (int k = 0; k < 100; ++k) {
    filter.predict(scalar(1.0), scalar(q));
    filter.update<1>(Vector1(0.0), scalar(1.0), scalar(r));
  }
  const double predicted = 0.5 * (q + std::sqrt(q * q + 4.0 * q * r));
  EXPECT_NEAR(filter.estimate().covariance(0, 0), predicted - q, 1e-12);
  // Far from both ends the smoothed variance is that of two such filters, one from either side.
  const double both = 1.0 / (1.0 / (predicted - q) + 1.0 / predicted);
  EXPECT_NEAR(filter.smoothed()[50].covariance(0, 0), both, 1e-9);
}

/// All states and measurements of a run as one Gaussian, conditioned at once.
TEST(Kalman, EqualsTheJointGaussian) {
  constexpr int kTimes = 9, n = 2 * kTimes;
  Rng rng(5);
  Gaussian<2> prior{{0.5, -1.0}, (Matrix2() << 2.0, 0.3, 0.3, 1.0).finished()};
  KalmanSmoother<2> kalman(prior);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n), z(kTimes - 2);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n), h = Eigen::MatrixXd::Zero(kTimes - 2, n);
  mean.head<2>() = prior.mean;
  covariance.topLeftCorner<2, 2>() = prior.covariance;
  double log_likelihood = 0.0;
  constexpr double r = 0.4;
  int measurements = 0;
  for (int k = 0; k < kTimes; ++k) {
    if (k > 0) {
      const Matrix2 f = (Matrix2() << 1.0, 0.5, rng.normal(0.0, 0.2), 0.9).finished();
      const Vector2 u(rng.normal(), rng.normal());
      const Vector2 g(0.5, 1.0);
      const Matrix2 q = 0.2 * g * g.transpose();  // singular
      kalman.predict(f, q, u);
      mean.segment<2>(2 * k) = f * mean.segment<2>(2 * k - 2) + u;
      const Eigen::MatrixXd cross = f * covariance.middleRows(2 * k - 2, 2);
      covariance.middleRows(2 * k, 2) = cross;
      covariance.middleCols(2 * k, 2) = cross.transpose();
      covariance.block<2, 2>(2 * k, 2 * k) = f * covariance.block<2, 2>(2 * k - 2, 2 * k - 2) * f.transpose() + q;
    }
    if (k == 3 || k == 4) continue;  // nothing measured
    const Eigen::RowVector2d row(1.0, rng.normal());
    h.block<1, 2>(measurements, 2 * k) = row;
    z[measurements] = rng.normal(0.0, 2.0);
    log_likelihood += kalman.update<1>(Vector1(z[measurements]), row, scalar(r)).log_likelihood;
    ++measurements;
  }
  const Eigen::MatrixXd s = h * covariance * h.transpose() + r * Eigen::MatrixXd::Identity(measurements, measurements);
  const Eigen::MatrixXd gain = covariance * h.transpose() * s.inverse();
  EXPECT_NEAR(log_likelihood, log_gaussian<Eigen::Dynamic>(z - h * mean, s), 1e-10);
  mean += gain * (z - h * mean);
  covariance -= gain * h * covariance;
  const auto smoothed = kalman.smoothed();
  ASSERT_EQ(smoothed.size(), static_cast<std::size_t>(kTimes));
  for (int k = 0; k < kTimes; ++k) {
    const auto& state = smoothed[static_cast<std::size_t>(k)];
    EXPECT_LT((state.mean - mean.segment<2>(2 * k)).norm(), 1e-10) << k;
    EXPECT_LT((state.covariance - covariance.block(2 * k, 2 * k, 2, 2)).norm(), 1e-10) << k;
  }
}

TEST(Kalman, WithoutMeasurementsSmoothingChangesNothing) {
  KalmanSmoother<1> kalman({Vector1(3.0), scalar(1.0)});
  kalman.predict(scalar(2.0), scalar(0.5), Vector1(1.0));
  const auto filtered = kalman.filtered(), smoothed = kalman.smoothed();
  ASSERT_EQ(smoothed.size(), 2u);
  EXPECT_DOUBLE_EQ(smoothed[0].mean[0], 3.0);
  EXPECT_DOUBLE_EQ(smoothed[1].mean[0], 7.0);
  EXPECT_DOUBLE_EQ(smoothed[0].covariance(0, 0), filtered[0].covariance(0, 0));
}

TEST(Kalman, RefusesASingularPrediction) {
  KalmanSmoother<1> kalman({Vector1(0.0), scalar(0.0)});
  kalman.predict(scalar(1.0), scalar(0.0));
  EXPECT_THROW((void)kalman.smoothed(), std::domain_error);
}

}  // namespace
}  // namespace noctule::smoothing
