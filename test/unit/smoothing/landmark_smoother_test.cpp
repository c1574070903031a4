#include "smoothing/landmark_smoother.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/chi2.hpp"
#include "core/error.hpp"
#include "smoothing/kalman.hpp"
#include "unit/smoothing/small_world.hpp"

namespace noctule::smoothing {
namespace {

SmoothedRun smooth(const SmallWorld& world, const SmallRun& run, const LandmarkSmootherParameters& parameters = {}) {
  LandmarkSmoother smoother(parameters, world.start);
  feed(smoother, run.observations);
  return smoother.solve();
}

double largest_error(const SmoothedRun& run, const SmallRun& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.truth.size(); ++i) {
    largest = std::max(largest, difference(run.path.poses[i].pose, truth.truth[i]).norm());
  }
  for (const LandmarkEstimate& l : run.map.landmarks) {
    largest = std::max(largest, (l.parameters.head<2>() - truth.landmarks[static_cast<std::size_t>(l.id)]).norm());
  }
  return largest;
}

double dead_reckoning_error(const SmallWorld& world, const SmallRun& run) {
  Pose2 pose = world.start;
  double largest = 0.0;
  std::size_t scan = 0;
  for (const Observation& o : run.observations) {
    if (const auto* odometry = std::get_if<Odometry>(&o)) pose = pose * odometry->increment;
    if (std::holds_alternative<LandmarkDetections>(o)) {
      largest = std::max(largest, (pose.position() - run.truth[scan++].position()).norm());
    }
  }
  return largest;
}

LandmarkDetections sighting(std::int64_t seq, std::vector<LandmarkDetection> detections) {
  return {.stamp = {seq * 1000, seq}, .sensor_in_base = {}, .detections = std::move(detections)};
}

LandmarkDetection detection(std::int64_t id, double range, double bearing) {
  LandmarkDetection d;
  d.range = range;
  d.bearing = bearing;
  d.covariance = Vector2(0.04, 0.01).asDiagonal();
  d.id = id;
  return d;
}

Odometry motion(const Pose2& increment, const Vector3& variances) {
  Odometry o;
  o.increment = increment;
  o.covariance = variances.asDiagonal();
  return o;
}

TEST(LandmarkSmoother, RecoversANoiselessRunExactly) {
  SmallWorld world;
  world.noise = 0.0;
  const SmallRun run = drive(world, 1);
  const SmoothedRun result = smooth(world, run);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.chi2, 1e-12);
  EXPECT_LT(largest_error(result, run), 1e-8);
  ASSERT_EQ(result.path.poses.size(), run.truth.size());
  EXPECT_EQ(result.path.poses[7].scan_seq, 7);
  EXPECT_EQ(result.path.poses[7].utime, 800'000);
  EXPECT_EQ(result.map.stamp, result.path.stamp);
  EXPECT_EQ(result.path.stamp.seq, world.scans - 1);
  EXPECT_TRUE(std::ranges::is_sorted(result.map.landmarks, {}, &LandmarkEstimate::id));
}

TEST(LandmarkSmoother, BeatsDeadReckoningAndFitsItsNoise) {
  const SmallWorld world;
  const SmallRun run = drive(world, 2);
  const SmoothedRun result = smooth(world, run);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(largest_error(result, run), 0.5 * dead_reckoning_error(world, run));
  EXPECT_GT(result.chi2, chi2_quantile(1e-4, result.dof));
  EXPECT_LT(result.chi2, chi2_quantile(1.0 - 1e-4, result.dof));
}

TEST(LandmarkSmoother, WithoutSightingsIsDeadReckoningWithItsCovariance) {
  SmallWorld world;
  world.landmarks = 0;
  world.steps_per_scan = 1;
  const LandmarkSmootherParameters parameters{.position_floor = 1e-3, .heading_floor = 1e-4};
  const SmallRun run = drive(world, 3);
  const SmoothedRun result = smooth(world, run, parameters);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.dof, 0);
  PoseGaussian pose{world.start, Matrix3::Zero()};
  std::size_t scan = 0;
  for (const Observation& o : run.observations) {
    if (const auto* odometry = std::get_if<Odometry>(&o)) {
      pose = pose *
             PoseGaussian{odometry->increment, odometry->covariance + Matrix3(Vector3(1e-6, 1e-6, 1e-8).asDiagonal())};
    } else {
      EXPECT_LT(difference(result.path.poses[scan].pose, pose.mean).norm(), 1e-9);
      EXPECT_LT((result.path_covariances[scan] - pose.covariance).norm(), 1e-9);
      ++scan;
    }
  }
}

/// A robot that can move on a line only, among landmarks on that line: ranges and motions are linear, the other
/// unknowns keep out of it by symmetry.
TEST(LandmarkSmoother, EqualsTheKalmanSmootherOnALine) {
  using Line = KalmanSmoother<3>;
  constexpr double kRangeVariance = 0.04, kStepVariance = 0.02, kFloor = 1e-6;
  Rng rng(4);
  LandmarkSmoother smoother({.position_floor = kFloor, .heading_floor = kFloor});
  const double first[] = {10.0 + rng.normal(0, 0.2), 14.0 + rng.normal(0, 0.2)};
  smoother.update(sighting(0, {detection(0, first[0], 0.0), detection(1, first[1], 0.0)}));
  Line kalman({Vector3(0.0, first[0], first[1]), Vector3(0.0, kRangeVariance, kRangeVariance).asDiagonal()});
  double x = 0.0;
  for (int k = 1; k <= 20; ++k) {
    const double step = 0.3 + rng.normal(0, 0.1);
    x += 0.3;
    smoother.predict(motion({step, 0, 0}, {kStepVariance, 1e-4, 1e-4}));
    Matrix3 q = Matrix3::Zero();
    q(0, 0) = kStepVariance + kFloor * kFloor;
    kalman.predict(Matrix3::Identity(), q, {step, 0, 0});
    LandmarkDetections scan = sighting(k, {});
    for (int id = 0; id < 2; ++id) {
      if ((k + id) % 3 == 0) continue;
      const double range = 10.0 + 4.0 * id - x + rng.normal(0, 0.2);
      scan.detections.push_back(detection(id, range, 0.0));
      Eigen::RowVector3d h(-1.0, 0.0, 0.0);
      h[1 + id] = 1.0;
      kalman.update<1>(VectorD<1>(range), h, MatrixD<1>(kRangeVariance));
    }
    smoother.update(scan);
  }
  const SmoothedRun run = smoother.solve();
  const auto states = kalman.smoothed();
  ASSERT_EQ(run.path.poses.size(), states.size());
  for (std::size_t k = 0; k < states.size(); ++k) {
    EXPECT_NEAR(run.path.poses[k].pose.x, states[k].mean[0], 1e-8);
    EXPECT_NEAR(run.path_covariances[k](0, 0), states[k].covariance(0, 0), 1e-8);
    EXPECT_NEAR(run.path.poses[k].pose.y, 0.0, 1e-12);
  }
  for (int id = 0; id < 2; ++id) {
    const LandmarkEstimate& l = run.map.landmarks[static_cast<std::size_t>(id)];
    EXPECT_NEAR(l.parameters[0], states.back().mean[1 + id], 1e-8);
    EXPECT_NEAR(l.covariance(0, 0), states.back().covariance(1 + id, 1 + id), 1e-8);
  }
}

TEST(LandmarkSmoother, ConvergesFromFarAway) {
  SmallWorld world;
  world.landmarks = 60;
  world.size = 120.0;
  world.radius = 40.0;
  world.scans = 400;
  world.step = 0.3;
  world.odometry_sd = {0.05, 0.02, 0.012};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const SmallRun run = drive(world, seed);
    EXPECT_GT(dead_reckoning_error(world, run), 10.0);
    const SmoothedRun result = smooth(world, run);
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.chi2, chi2_quantile(1.0 - 1e-4, result.dof)) << "seed " << seed;
    // The way there must not matter.
    EXPECT_NEAR(smooth(world, run, {.batch = 10}).chi2, result.chi2, 1e-6 * result.chi2);
  }
}

TEST(LandmarkSmoother, OrderOfDetectionsAndNamesOfLandmarksDoNotMatter) {
  const SmallWorld world;
  const SmallRun run = drive(world, 6);
  SmallRun other = run;
  const auto renamed = [&](std::int64_t id) { return 1000 - 7 * id; };
  for (Observation& o : other.observations) {
    if (auto* scan = std::get_if<LandmarkDetections>(&o)) {
      std::ranges::reverse(scan->detections);
      for (LandmarkDetection& d : scan->detections) d.id = renamed(d.id);
    }
  }
  const SmoothedRun a = smooth(world, run), b = smooth(world, other);
  for (std::size_t i = 0; i < a.path.poses.size(); ++i) {
    EXPECT_LT(difference(a.path.poses[i].pose, b.path.poses[i].pose).norm(), 1e-7);
    EXPECT_LT((a.path_covariances[i] - b.path_covariances[i]).norm(), 1e-8);
  }
  ASSERT_EQ(a.map.landmarks.size(), b.map.landmarks.size());
  for (const LandmarkEstimate& l : a.map.landmarks) {
    const auto twin = std::ranges::find(b.map.landmarks, renamed(l.id), &LandmarkEstimate::id);
    ASSERT_NE(twin, b.map.landmarks.end());
    EXPECT_EQ(twin->observations, l.observations);
    EXPECT_LT((twin->parameters - l.parameters).norm(), 1e-7);
    EXPECT_LT((twin->covariance - l.covariance).norm(), 1e-8);
  }
}

TEST(LandmarkSmoother, MovesWithItsStart) {
  SmallWorld world;
  const SmallRun run = drive(world, 7);
  const SmoothedRun here = smooth(world, run);
  const Pose2 move{-20.0, 35.0, 2.9};
  world.start = move * world.start;
  const SmoothedRun there = smooth(world, run);
  EXPECT_NEAR(there.chi2, here.chi2, 1e-8 * here.chi2);
  for (std::size_t i = 0; i < here.path.poses.size(); ++i) {
    EXPECT_LT(difference(there.path.poses[i].pose, move * here.path.poses[i].pose).norm(), 1e-6);
  }
}

TEST(LandmarkSmoother, ComposesWhatComesBetweenScans) {
  const PoseGaussian a{{0.5, 0.1, 0.3}, Vector3(1e-3, 2e-3, 3e-4).asDiagonal()};
  const PoseGaussian b{{0.2, -0.1, -0.5}, Vector3(2e-3, 1e-3, 5e-4).asDiagonal()};
  LandmarkSmoother two, one;
  Odometry o;
  o.increment = a.mean;
  o.covariance = a.covariance;
  two.predict(o);
  o.increment = b.mean;
  o.covariance = b.covariance;
  two.predict(o);
  o.increment = (a * b).mean;
  o.covariance = (a * b).covariance;
  one.predict(o);
  two.update(sighting(0, {}));
  one.update(sighting(0, {}));
  EXPECT_EQ(two.solve().path.poses[0].pose, one.solve().path.poses[0].pose);
  EXPECT_EQ(two.solve().path_covariances[0], one.solve().path_covariances[0]);
}

TEST(LandmarkSmoother, ScansWithoutMotionBetweenThemShareAPose) {
  LandmarkSmoother smoother;
  smoother.update(sighting(0, {detection(5, 2.0, 0.1)}));
  smoother.update(sighting(1, {detection(5, 2.2, 0.1)}));
  const SmoothedRun run = smoother.solve();
  ASSERT_EQ(run.path.poses.size(), 2u);
  EXPECT_EQ(run.path.poses[0].pose, Pose2{});
  EXPECT_EQ(run.path_covariances[1], Matrix3(Matrix3::Zero()));
  // Two equal sightings from a known place: their mean, with half the covariance.
  ASSERT_EQ(run.map.landmarks.size(), 1u);
  const LandmarkEstimate& l = run.map.landmarks[0];
  EXPECT_EQ(l.observations, 2);
  EXPECT_NEAR(l.parameters.head<2>().norm(), 2.1, 1e-9);
  const Vector2 along = Vector2(std::cos(0.1), std::sin(0.1));
  EXPECT_NEAR(along.dot(l.covariance.topLeftCorner<2, 2>() * along), 0.02, 1e-9);
  EXPECT_EQ(run.dof, 2);
}

/// Odometry from two controls has rank 2: the floor makes it a density, and its size hardly matters.
TEST(LandmarkSmoother, TakesOdometryOfRankTwo) {
  SmallWorld world;
  world.steps_per_scan = 1;
  SmallRun run = drive(world, 8);
  Rng rng(8, 1);
  const Vector3 first(0.02, 0.0, 0.0), second(0.0, 0.01, 0.01);  // what each control's error does
  for (Observation& o : run.observations) {
    if (auto* odometry = std::get_if<Odometry>(&o)) {
      const Vector3 error = rng.normal() * first + rng.normal() * second;
      odometry->increment = {world.step + error.x(), error.y(), world.step / world.radius + error.z()};
      odometry->covariance = first * first.transpose() + second * second.transpose();
    }
  }
  const SmoothedRun fine = smooth(world, run, {.position_floor = 1e-4, .heading_floor = 1e-5});
  const SmoothedRun finer = smooth(world, run, {.position_floor = 2e-5, .heading_floor = 2e-6});
  EXPECT_TRUE(fine.converged);
  EXPECT_TRUE(finer.converged);
  for (std::size_t i = 0; i < fine.path.poses.size(); ++i) {
    const Matrix3& p = fine.path_covariances[i];
    EXPECT_TRUE(p.allFinite());
    EXPECT_LT((fine.path.poses[i].pose.position() - finer.path.poses[i].pose.position()).norm(),
              0.05 * std::sqrt(p.trace()));
    EXPECT_NEAR(finer.path_covariances[i].trace(), p.trace(), 0.02 * p.trace());
  }
}

TEST(LandmarkSmoother, RobustLossForgivesAnOutlier) {
  SmallWorld world;
  SmallRun run = drive(world, 9);
  const SmoothedRun clean = smooth(world, run);
  for (Observation& o : run.observations) {
    if (auto* scan = std::get_if<LandmarkDetections>(&o); scan != nullptr && scan->stamp.seq == 30) {
      scan->detections.at(0).range += 5.0;
    }
  }
  const double plain = largest_error(smooth(world, run), run);
  for (const Loss loss : {Loss::huber, Loss::cauchy}) {
    const SmoothedRun robust = smooth(world, run, {.loss = loss});
    EXPECT_LT(largest_error(robust, run), plain);
    EXPECT_GT(robust.chi2, clean.chi2 + 1000.0);  // of the plain residuals
  }
}

TEST(LandmarkSmoother, MayBeAskedAgain) {
  const SmallWorld world;
  const SmallRun run = drive(world, 10);
  LandmarkSmoother smoother({}, world.start);
  EXPECT_TRUE(smoother.solve().converged);
  EXPECT_TRUE(smoother.solve().path.poses.empty());
  const std::vector<Observation> half(run.observations.begin(), run.observations.begin() + 150);
  feed(smoother, half);
  EXPECT_EQ(smoother.solve().path.poses.size(), 30u);
  feed(smoother, {run.observations.begin() + 150, run.observations.end()});
  const SmoothedRun again = smoother.solve(), whole = smooth(world, run);
  for (std::size_t i = 0; i < run.truth.size(); ++i) EXPECT_EQ(again.path.poses[i].pose, whole.path.poses[i].pose);
}

TEST(LandmarkSmoother, Refusals) {
  EXPECT_THROW(LandmarkSmoother({.position_floor = 0.0}), InputError);
  EXPECT_THROW(LandmarkSmoother({.batch = 0}), InputError);
  EXPECT_THROW(LandmarkSmoother({}, {std::numeric_limits<double>::quiet_NaN(), 0, 0}), InputError);
  LandmarkSmoother smoother;
  try {
    smoother.update(sighting(4, {detection(-1, 1.0, 0.0)}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("landmark detections 4"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("id"), std::string::npos) << error.what();
  }
  LandmarkDetection d = detection(1, 1.0, 0.0);
  d.covariance.setZero();
  EXPECT_THROW(smoother.update(sighting(0, {d})), InputError);
  d = detection(1, 1.0, 0.0);
  d.kind = DetectionKind::bearing_only;
  EXPECT_THROW(smoother.update(sighting(0, {d})), InputError);
  EXPECT_THROW(smoother.predict(motion({std::nan(""), 0, 0}, {1, 1, 1})), InputError);
  EXPECT_THROW(smoother.predict(motion({0, 0, 0}, {-1, 1, 1})), InputError);
  EXPECT_TRUE(smoother.solve().path.poses.empty());  // nothing refused was kept
}

}  // namespace
}  // namespace noctule::smoothing
