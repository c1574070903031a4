/// A linear-Gaussian case, where the Kalman filter is exact: a robot that drives straight at a wall with certain
/// heading. State (x, rho): position along the way and the wall's distance from the start.
#include <gtest/gtest.h>

#include "unit/filters/recording.hpp"

namespace noctule::filters {
namespace {

constexpr double kMotionSd = 0.02, kRangeSd = 0.01, kWall = 3.0, kStep = 0.1;
constexpr int kSteps = 12, kParticles = 4000;

TEST(ParticleSlam, AgreesWithTheKalmanFilterOnALinearGaussianCase) {
  auto p = test::with_particles(kParticles);
  p.echo.range_noise = {.base = kRangeSd, .relative = 0.0};
  p.echo.clutter_fraction = 1e-12;
  double worst_mean = 0.0, mean_ratio = 0.0;
  constexpr int runs = 10;
  for (std::uint64_t run = 0; run < runs; ++run) {
    Rng rng(100 + run, stream_id("test.kalman"));
    ParticleSlam filter(p, run);
    Vector2 mean(0.0, 0.0);
    Matrix2 covariance = Matrix2::Zero();
    double x = 0.0;
    int resamplings = 0;
    for (int k = 0; k < kSteps; ++k) {
      if (k > 0) {
        const double reported = kStep + rng.normal(0.0, kMotionSd);
        x += kStep;
        Odometry o;
        o.increment.x = reported;
        o.covariance(0, 0) = kMotionSd * kMotionSd;
        filter.predict(o);
        mean[0] += reported;
        covariance(0, 0) += kMotionSd * kMotionSd;
      }
      const double range = kWall - x + rng.normal(0.0, kRangeSd);
      UltrasonicScan scan;
      scan.stamp.seq = k;
      scan.half_angle = radians(15.0);
      scan.beams.push_back({Pose2{}, range, Echo::hit});
      ContourFeatures features;
      if (k == 0) {
        ContourFeature wall;
        wall.type = ContourType::wall;
        wall.has_wall = true;
        wall.wall = {kWall + 0.05, 0.0};
        wall.surface = {kWall + 0.05, 0.0};
        wall.readings = {{0, 0}};
        features.features.push_back(wall);
        mean[1] = kWall + 0.05;
        covariance(1, 1) = p.contour_landmarks.range_sd * p.contour_landmarks.range_sd;
      }
      filter.update(scan, features);
      joseph_update<2, 1>(mean, covariance, VectorD<1>(range - (mean[1] - mean[0])), Eigen::RowVector2d(-1.0, 1.0),
                          MatrixD<1>(kRangeSd * kRangeSd));
      resamplings += filter.estimate().resampled;
      if (k == 0) continue;

      const auto e = filter.estimate();
      const double sd = std::sqrt(covariance(0, 0));
      worst_mean = std::max(worst_mean, std::abs(e.pose.x - mean[0]) / sd);
      mean_ratio += e.covariance(0, 0) / covariance(0, 0) / (runs * (kSteps - 1));
    }
    EXPECT_GT(resamplings, 0);
  }
  // Monte Carlo error of the mean of 4000 particles: 0.016 sd, more after each resampling.
  EXPECT_LT(worst_mean, 0.2);
  EXPECT_NEAR(mean_ratio, 1.0, 0.05);
}

}  // namespace
}  // namespace noctule::filters
