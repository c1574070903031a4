#include "core/unscented.hpp"

#include <gtest/gtest.h>

#include "core/pair.hpp"
#include "core/pose2.hpp"

namespace noctule {
namespace {

Matrix3 some_covariance() {
  Matrix3 a;
  a << 0.3, 0.1, 0.0, -0.2, 0.5, 0.1, 0.05, 0.0, 0.02;
  return a * a.transpose();
}

TEST(Unscented, PointsReproduceTheMomentsAlsoOfSingularGaussians) {
  const Vector3 mean(1.0, -2.0, 0.5);
  Matrix3 flat = Matrix3::Zero();
  flat.topLeftCorner<2, 2>() << 4.0, 2.0, 2.0, 1.0;  // rank 1
  for (const Matrix3& covariance : {some_covariance(), flat, Matrix3(Matrix3::Zero())}) {
    for (const UnscentedScaling s :
         {UnscentedScaling{}, UnscentedScaling{1.0, 2.0, 0.0}, UnscentedScaling{0.5, 0.0, 1.0}}) {
      const UnscentedWeights w(3, s);
      EXPECT_NEAR(w.mean_centre + 6.0 * w.other, 1.0, 1e-14);
      const auto points = sigma_points<3>(mean, semidefinite_cholesky<3>(covariance), w.spread);
      Vector3 m;
      Matrix3 p;
      unscented_moments<3>(points, w, m, p);
      EXPECT_LT((m - mean).norm(), 1e-13);
      EXPECT_LT((p - covariance).norm(), 1e-12);
    }
  }
}

/// Of a linear map the transform is exact.
TEST(Unscented, IsTheKalmanFilterOnLinearModels) {
  const Vector3 mean(1.0, -2.0, 0.5);
  const Matrix3 covariance = some_covariance();
  Matrix3 f;
  f << 1.0, 0.2, -0.3, 0.0, 0.9, 0.4, 0.1, 0.0, 1.1;
  const UnscentedWeights w(3, {});
  auto points = sigma_points<3>(mean, semidefinite_cholesky<3>(covariance), w.spread);
  for (auto& p : points) p = (f * p + Vector3(1.0, 2.0, 3.0)).eval();
  Vector3 m;
  Matrix3 p;
  unscented_moments<3>(points, w, m, p);
  EXPECT_LT((m - (f * mean + Vector3(1.0, 2.0, 3.0))).norm(), 1e-12);
  EXPECT_LT((p - f * covariance * f.transpose()).norm(), 1e-12);
}

TEST(SemidefiniteCholesky, IsASquareRoot) {
  Matrix3 rank2 = Matrix3::Zero();
  rank2 += Vector3(1.0, 2.0, 0.1) * Vector3(1.0, 2.0, 0.1).transpose();
  rank2 += Vector3(0.3, -1.0, 0.02) * Vector3(0.3, -1.0, 0.02).transpose();
  for (const Matrix3& p : {some_covariance(), rank2, Matrix3(Matrix3::Zero()), Matrix3(1e-12 * rank2)}) {
    const Matrix3 l = semidefinite_cholesky<3>(p);
    EXPECT_LE((l * l.transpose() - p).norm(), 1e-9 * p.norm());
  }
}

TEST(FastAtan2, IsTheArcTangentInAllQuadrants) {
  Rng rng(1);
  double worst = 0.0;
  for (int k = 0; k < 200000; ++k) {
    const double scale = std::pow(10.0, rng.uniform(-12.0, 12.0));
    const double y[] = {scale * rng.normal(), rng.normal()}, x[] = {rng.normal(), scale * rng.normal()};
    const Pair angle = fast_atan2(Pair{y[0], y[1]}, Pair{x[0], x[1]});
    for (int i = 0; i < 2; ++i) {
      worst = std::max(worst, std::abs(angle[i] - std::atan2(y[i], x[i])));
      EXPECT_EQ(angle[i], fast_atan2(y[i], x[i]));
    }
  }
  EXPECT_LT(worst, 1e-15);
  for (const double y : {-1.0, 0.0, 1.0}) {
    for (const double x : {-1.0, 0.0, 1.0}) EXPECT_NEAR(fast_atan2(y, x), std::atan2(y, x), 1e-15) << y << " " << x;
  }
}

TEST(WrapNear, IsTheNearestTurn) {
  Rng rng(2);
  for (int k = 0; k < 10000; ++k) {
    const double angle = rng.uniform(-100.0, 100.0);
    const double wrapped = wrap_near(angle);
    EXPECT_LE(std::abs(wrapped), kPi + 1e-12);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), 1e-12);
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), 1e-12);
  }
}

}  // namespace
}  // namespace noctule
