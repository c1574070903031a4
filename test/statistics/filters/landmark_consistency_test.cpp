/// The landmark filters' covariances are honest in the first seconds, as far as Rao-Blackwellised filters and EKF-SLAM
/// are: normalised errors of the pose over independent runs within chi-square bounds.
#include <gtest/gtest.h>

#include "core/chi2.hpp"
#include "core/gaussian.hpp"
#include "filters/slam/make_slam_filter.hpp"
#include "unit/filters/landmark_world.hpp"

namespace noctule::filters {
namespace {

/// Mean normalised squared error of the pose at the end of so many runs.
double mean_nees(const SlamFilterParameters& p, int runs, double duration, double odometry_variance = 1.0) {
  const auto world = test::small_web();
  double sum = 0.0;
  for (int seed = 1; seed <= runs; ++seed) {
    const auto filter = make_slam_filter(p, static_cast<std::uint64_t>(seed), {});
    auto run = test::drive(world, duration, static_cast<std::uint64_t>(seed));
    for (auto& step : run) {
      for (auto& o : step.odometry) o.covariance *= odometry_variance;
      test::feed(*filter, step);
    }
    sum += mahalanobis2<3>(difference(filter->estimate().pose, run.back().truth), filter->estimate().covariance);
  }
  return sum / runs;
}

TEST(LandmarkConsistency, EkfSlamOverThirtySeconds) {
  constexpr int runs = 30;
  const auto bounds = nees_bounds(3, runs, 0.999);
  const double nees = mean_nees(EkfSlamParameters{}, runs, 30.0);
  EXPECT_GT(nees, bounds.low);
  EXPECT_LT(nees, bounds.high);
  EXPECT_GT(mean_nees(EkfSlamParameters{}, runs, 30.0, 0.05), bounds.high);  // a filter that trusts odometry too much
}

TEST(LandmarkConsistency, FastSlam2WithManyParticlesOverFiveSeconds) {
  constexpr int runs = 20;
  FastSlam2Parameters p;
  p.particles = 400;
  const auto bounds = nees_bounds(3, runs, 0.999);
  const double nees = mean_nees(p, runs, 5.0);
  EXPECT_GT(nees, bounds.low);
  EXPECT_LT(nees, bounds.high);
}

}  // namespace
}  // namespace noctule::filters
