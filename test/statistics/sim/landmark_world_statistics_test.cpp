#include <gtest/gtest.h>

#include "core/chi2.hpp"
#include "core/gaussian.hpp"
#include "models/range_bearing.hpp"
#include "sim/landmark_world.hpp"

namespace noctule::sim {
namespace {

/// A square of 40 m driven round and round, five landmarks.
LandmarkWorldParameters square(int loops) {
  LandmarkWorldParameters p;
  p.world.waypoints = {{40, 0}, {40, 40}, {0, 40}, {0, 0}};
  p.world.landmarks = {{50, -10}, {50, 50}, {-10, 50}, {-10, -10}, {20, 20}};
  p.world.loops = loops;
  return p;
}

/// Mean and standard deviation of what should be standard normal.
struct Standardised {
  double sum = 0.0, squares = 0.0;
  int n = 0;
  void add(double z) {
    sum += z;
    squares += z * z;
    ++n;
  }
  /// Four standard errors on either side.
  [[nodiscard]] bool centred() const { return std::abs(sum) < 4.0 * std::sqrt(n); }
  [[nodiscard]] double sd() const { return std::sqrt(squares / n); }
};

TEST(LandmarkWorldStatistics, ControlsErrAsStated) {
  const LandmarkWorldParameters p = square(50);
  const auto steps = plan_steps({}, p.world.waypoints, p.world.loops, p.vehicle);
  Standardised speed, steering;
  LandmarkWorld source(p, 1);
  std::size_t i = 0;
  while (const auto o = source.next()) {
    const auto* odometry = std::get_if<Odometry>(&*o);
    if (odometry == nullptr) continue;
    // The increment of the front axle: a chord of length v dt in the direction of the wheels.
    const Pose2& d = odometry->increment;
    speed.add((d.position().norm() * p.vehicle.control_rate - p.vehicle.speed) / p.vehicle.speed_sd);
    steering.add((std::atan2(d.y, d.x) - steps[i++].steering) / p.vehicle.steering_sd);
  }
  ASSERT_GT(speed.n, 100'000);
  EXPECT_TRUE(speed.centred() && steering.centred());
  EXPECT_NEAR(speed.sd(), 1.0, 0.01);
  EXPECT_NEAR(steering.sd(), 1.0, 0.01);
}

TEST(LandmarkWorldStatistics, SightingsErrAsStatedAndOutliersAreTheirShare) {
  LandmarkWorldParameters p = square(400);
  p.sensor.outliers = 0.1;
  Standardised range, bearing;
  int outliers = 0;
  LandmarkWorld source(p, 2);
  Pose2 truth;
  while (const auto o = source.next()) {
    if (const auto* t = std::get_if<GroundTruth>(&*o)) truth = t->base_in_map;
    if (!std::holds_alternative<LandmarkDetections>(*o)) continue;
    for (const LandmarkDetection& d : source.informed().detections) {
      const KnownLandmark& l = source.world().landmarks[static_cast<std::size_t>(d.id)];
      const Vector2 z = models::predict_range_bearing(truth, l.position).z;
      range.add((d.range - z[0]) / std::sqrt(d.covariance(0, 0)));
      bearing.add(wrap(d.bearing - z[1]) / std::sqrt(d.covariance(1, 1)));
      outliers += d.covariance(0, 0) > 0.02;
    }
  }
  ASSERT_GT(range.n, 100'000);
  EXPECT_TRUE(range.centred() && bearing.centred());
  EXPECT_NEAR(range.sd(), 1.0, 0.01);
  EXPECT_NEAR(bearing.sd(), 1.0, 0.01);
  EXPECT_NEAR(outliers, 0.1 * range.n, 4.0 * std::sqrt(0.09 * range.n));
}

/// NEES of dead reckoning and its stated covariance after so many controls.
double nees(const LandmarkWorldParameters& p, std::uint64_t seed, int controls) {
  const auto steps = plan_steps({}, p.world.waypoints, 1, p.vehicle);
  LandmarkWorld source(p, seed);
  PoseGaussian pose;
  for (int i = 0; i < controls;) {
    const auto o = source.next();
    if (const auto* odometry = std::get_if<Odometry>(&*o)) {
      pose = pose * PoseGaussian{odometry->increment, odometry->covariance};
      ++i;
    }
  }
  const Pose2& truth = steps[static_cast<std::size_t>(controls) - 1].pose;
  return mahalanobis2<3>(difference(pose.mean, truth), pose.covariance);
}

TEST(LandmarkWorldStatistics, OdometryIsConsistentWithItsCovariance) {
  constexpr int kSeeds = 300;
  const Interval bounds = nees_bounds(3, kSeeds, 0.999);
  for (const int controls : {40, 800}) {
    double sum = 0.0;
    for (int seed = 1; seed <= kSeeds; ++seed) sum += nees(square(1), static_cast<std::uint64_t>(seed), controls);
    EXPECT_GT(sum / kSeeds, bounds.low) << controls;
    EXPECT_LT(sum / kSeeds, bounds.high) << controls;
  }
}

}  // namespace
}  // namespace noctule::sim
