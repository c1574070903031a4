#include "filters/slam/ufastslam.hpp"

#include <gtest/gtest.h>

#include "core/gaussian.hpp"
#include "filters/slam/fastslam.hpp"
#include "unit/filters/landmark_world.hpp"

namespace noctule::filters {
namespace {

LandmarkDetections one(std::int64_t seq, double range, double bearing, const Matrix2& covariance) {
  LandmarkDetections d;
  d.stamp.seq = seq;
  d.detections.push_back({.range = range, .bearing = bearing, .covariance = covariance, .id = 3});
  return d;
}

Odometry some_motion() {
  Odometry o;
  o.increment = {0.3, 0.02, 0.1};
  o.covariance << 1e-3, 1e-4, 2e-4, 1e-4, 2e-3, 1e-4, 2e-4, 1e-4, 1e-3;
  return o;
}

SlamEstimate after_one_landmark(UnscentedVariant variant, double landmark_variance) {
  UFastSlamParameters p;
  p.particles = 500;
  p.resample_below = 0.0;
  p.variant = variant;
  UFastSlam filter(p, 3);
  filter.update(one(0, 5.0, 0.4, landmark_variance * Matrix2::Identity()));
  filter.predict(some_motion());
  filter.update(one(1, 4.8, 0.3, Vector2(4e-4, 1e-4).asDiagonal().toDenseMatrix()));
  return filter.estimate();
}

TEST(UFastSlam, ErbIsThe2008FormWhereLandmarksAreCertain) {
  const auto erb = after_one_landmark(UnscentedVariant::erb, 1e-16);
  const auto y2008 = after_one_landmark(UnscentedVariant::y2008, 1e-16);
  EXPECT_LT(difference(erb.pose, y2008.pose).norm(), 1e-9);
  EXPECT_LT((erb.covariance - y2008.covariance).norm(), 1e-9);
  EXPECT_NEAR(erb.effective_sample_size, y2008.effective_sample_size, 1e-6);
  // Where they are not, the 2008 form is surer of the pose than the landmark allows.
  const auto wide = after_one_landmark(UnscentedVariant::erb, 1e-2);
  const auto wide_2008 = after_one_landmark(UnscentedVariant::y2008, 1e-2);
  EXPECT_GT(wide.covariance.trace(), 1.2 * wide_2008.covariance.trace());
}

/// Small noise makes the models linear: both proposals are the Kalman update then.
TEST(UFastSlam, IsFastSlam2WhereNoiseIsSmall) {
  const auto run = [](auto filter) {
    filter.update(one(0, 5.0, 0.4, 1e-10 * Matrix2::Identity()));
    Odometry o = some_motion();
    o.covariance *= 1e-6;
    filter.predict(o);
    filter.update(one(1, 4.75, 0.31, Vector2(4e-8, 1e-8).asDiagonal().toDenseMatrix()));
    return filter.estimate();
  };
  UFastSlamParameters u;
  FastSlam2Parameters f;
  u.particles = f.particles = 200;
  const auto a = run(UFastSlam(u, 3)), b = run(FastSlam2(f, 3));
  const double sd = std::sqrt(b.covariance.diagonal().maxCoeff());
  EXPECT_LT(difference(a.pose, b.pose).norm(), 1e-2 * sd);
  EXPECT_LT((a.covariance - b.covariance).norm(), 1e-2 * b.covariance.norm());
}

/// Moving particles by a swarm and weighing them by importance leaves the posterior as it was.
TEST(PsoUFastSlam, WeighedByImportanceItSamplesThePosteriorOfTheProposal) {
  PsoUFastSlamParameters p;
  p.particles = 4000;
  p.resample_below = 0.0;
  p.when = SwarmMoves::always;
  p.weighting = SwarmWeighting::importance;
  PsoUFastSlam swarm(p, 3);
  UFastSlam plain(p, 3);
  for (UFastSlam* filter : {static_cast<UFastSlam*>(&swarm), &plain}) {
    filter->update(one(0, 5.0, 0.4, 1e-6 * Matrix2::Identity()));
    filter->predict(some_motion());
    filter->update(one(1, 4.75, 0.31, Vector2(4e-4, 1e-4).asDiagonal().toDenseMatrix()));
  }
  const auto a = swarm.estimate(), b = plain.estimate();
  const double effective = swarm.particles(p.particles).particles.size() * 0.2;
  for (int i = 0; i < 3; ++i) {
    const double sd = std::sqrt(b.covariance(i, i));
    EXPECT_NEAR(difference(a.pose, b.pose)[i], 0.0, 5.0 * sd / std::sqrt(effective));
    EXPECT_NEAR(a.covariance(i, i) / b.covariance(i, i), 1.0, 0.2);
  }
}

}  // namespace
}  // namespace noctule::filters
