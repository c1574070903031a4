#include <gtest/gtest.h>

#include <algorithm>

#include "core/chi2.hpp"
#include "core/error.hpp"
#include "core/gaussian.hpp"
#include "filters/slam/fastslam.hpp"
#include "filters/slam/make_slam_filter.hpp"
#include "unit/filters/landmark_world.hpp"

namespace noctule::filters {
namespace {

using test::drive;
using test::feed;
using test::LandmarkScanStep;
using test::small_web;

/// Parameters of every filter over point landmarks, with so many particles.
std::vector<SlamFilterParameters> all_filters(int particles) {
  std::vector<SlamFilterParameters> result{FastSlam1Parameters{},    FastSlam2Parameters{}, UFastSlamParameters{},
                                           PsoUFastSlamParameters{}, WocpfParameters{},     EkfSlamParameters{}};
  FastSlam1Parameters each;
  each.sample = Sampling::odometry;
  result.push_back(each);
  UFastSlamParameters y2008;
  y2008.variant = UnscentedVariant::y2008;
  result.push_back(y2008);
  PsoUFastSlamParameters b;
  b.weighting = SwarmWeighting::importance;
  b.when = SwarmMoves::always;
  result.push_back(b);
  WocpfParameters first;
  first.base = WocpfBase::fastslam1;
  result.push_back(first);
  for (auto& p : result) {
    std::visit(
        [particles](auto& q) {
          if constexpr (requires { q.particles; }) q.particles = particles;
        },
        p);
  }
  return result;
}
/// The same with one change.
template <class Change>
SlamFilterParameters with(SlamFilterParameters p, Change change) {
  std::visit(
      [&](auto& q) {
        if constexpr (requires(LandmarkSlamParameters & base) { base = q; })
          change(static_cast<LandmarkSlamParameters&>(q));
      },
      p);
  return p;
}

void expect_same(const SlamFilter& a, const SlamFilter& b) {
  EXPECT_EQ(a.estimate().pose, b.estimate().pose);
  EXPECT_EQ(a.estimate().covariance, b.estimate().covariance);
  EXPECT_EQ(a.estimate().effective_sample_size, b.estimate().effective_sample_size);
  const auto map_a = a.map().landmarks, map_b = b.map().landmarks;
  ASSERT_EQ(map_a.size(), map_b.size());
  for (std::size_t k = 0; k < map_a.size(); ++k) {
    EXPECT_EQ(map_a[k].id, map_b[k].id);
    EXPECT_EQ(map_a[k].parameters, map_b[k].parameters);
    EXPECT_EQ(map_a[k].covariance, map_b[k].covariance);
  }
}

TEST(LandmarkSlam, OneParticleWithoutNoiseIsExact) {
  auto world = small_web();
  world.sensor_in_base = {0.3, -0.1, 0.2};
  world.range_sd = 1e-6;
  world.bearing_sd = 1e-7;  // the mean of an unscented start lies this squared times half the range from its mode
  for (const bool known : {true, false}) {
    const auto run = drive(world, 20.0, 1, 0.0, known);
    for (const auto& p : all_filters(1)) {
      const auto filter = make_slam_filter(p, 9, {});
      for (const auto& step : run) {
        feed(*filter, step);
        ASSERT_LT(difference(filter->estimate().pose, step.truth).norm(), 1e-9) << kSlamFilterNames[p.index()];
      }
      const auto map = filter->map().landmarks;
      ASSERT_GE(map.size(), 10u);
      for (const auto& m : map) {
        double nearest = 1.0;
        for (const Vector2& l : world.landmarks) nearest = std::min(nearest, (l - m.parameters.head<2>()).norm());
        EXPECT_LT(nearest, 1e-9);
        EXPECT_TRUE(known ? m.id >= 0 : m.id < -1);
      }
    }
  }
}

TEST(LandmarkSlam, ThreadsAndStorageChangeNoBit) {
  const auto world = small_web();
  for (const bool known : {true, false}) {
    const auto run = drive(world, 10.0, 2, 1.0, known);
    for (const auto& p : all_filters(60)) {
      const auto reference = make_slam_filter(with(p, [](auto& q) { q.storage = MapStorage::flat; }), 5, {}, 1);
      const auto threads = make_slam_filter(with(p, [](auto& q) { q.storage = MapStorage::flat; }), 5, {}, 2);
      const auto shared = make_slam_filter(with(p, [](auto& q) { q.storage = MapStorage::shared; }), 5, {}, 2);
      for (const auto& step : run) {
        feed(*reference, step);
        feed(*threads, step);
        feed(*shared, step);
      }
      if (reference->estimate().particles > 0) {
        EXPECT_LT(reference->estimate().distinct_particles, 60);
      }
      expect_same(*reference, *threads);
      expect_same(*reference, *shared);
    }
  }
}

TEST(LandmarkSlam, TheOrderOfNamedSightingsChangesNoBit) {
  const auto run = drive(small_web(), 10.0, 3);
  for (const auto& p : all_filters(20)) {
    const auto a = make_slam_filter(p, 5, {}), b = make_slam_filter(p, 5, {});
    for (auto step : run) {
      feed(*a, step);
      std::ranges::reverse(step.detections.detections);
      feed(*b, step);
    }
    expect_same(*a, *b);
  }
}

TEST(LandmarkSlam, BeatsDeadReckoningAndKeepsTheMap) {
  std::vector<std::vector<LandmarkScanStep>> runs;
  double drift = 0.0;
  for (const std::uint64_t seed : {4, 5, 6}) {
    runs.push_back(drive(small_web(), 100.0, seed));
    Pose2 reckoned;
    for (const auto& step : runs.back()) {
      for (const Odometry& o : step.odometry) reckoned = reckoned * o.increment;
      drift += (reckoned.position() - step.truth.position()).norm();
    }
  }
  for (const bool known : {true, false}) {
    for (const auto& p : all_filters(20)) {
      double error = 0.0;
      for (auto run : runs) {
        const auto filter = make_slam_filter(p, 5, {});
        for (auto& step : run) {
          if (!known) {
            for (auto& d : step.detections.detections) d.id = -1;
          }
          feed(*filter, step);
          error += (filter->estimate().pose.position() - step.truth.position()).norm();
        }
        EXPECT_GE(filter->map().landmarks.size(), 15u);
        EXPECT_LE(filter->map().landmarks.size(), 40u);
        EXPECT_EQ(filter->collapses(), 0);
      }
      EXPECT_LT(error, 0.5 * drift) << kSlamFilterNames[p.index()] << (known ? " known" : " unknown");
    }
  }
}

/// One scan of one landmark that is known for certain: the proposal is the Kalman update of the pose.
TEST(FastSlam2, TheFirstMomentsOfTheProposalAreTheKalmanUpdateOfThePose) {
  FastSlam2Parameters p;
  p.particles = 40000;
  p.resample_below = 0.0;
  FastSlam2 filter(p, 3, {1.0, 2.0, 0.7});
  LandmarkDetections first;
  const Matrix2 certain = 1e-14 * Matrix2::Identity();
  first.detections.push_back({.range = 5.0, .bearing = 0.4, .covariance = certain, .id = 7});
  filter.update(first);  // the pose is certain: so is the landmark
  Odometry o;
  o.increment = {0.3, 0.02, 0.1};
  o.covariance << 1e-3, 1e-4, 2e-4, 1e-4, 2e-3, 1e-4, 2e-4, 1e-4, 1e-3;
  filter.predict(o);
  const Pose2 start{1.0, 2.0, 0.7};
  const Vector2 landmark = start * Vector2(5.0 * std::cos(0.4), 5.0 * std::sin(0.4));
  const PoseGaussian prior = PoseGaussian{start, Matrix3::Zero()} * PoseGaussian{o.increment, o.covariance};
  const auto predicted = models::predict_range_bearing(prior.mean, landmark);
  LandmarkDetections second;
  second.stamp.seq = 1;
  const Matrix2 r = Vector2(4e-4, 1e-4).asDiagonal();
  second.detections.push_back(
      {.range = predicted.z[0] + 0.02, .bearing = predicted.z[1] - 0.01, .covariance = r, .id = 7});
  filter.update(second);

  Eigen::Matrix<double, 2, 3> h;
  const Vector2 d = landmark - prior.mean.position();
  const double q = d.squaredNorm(), range = std::sqrt(q);
  h << -d.x() / range, -d.y() / range, 0.0, d.y() / q, -d.x() / q, -1.0;
  Vector3 mean = prior.mean.vector();
  Matrix3 covariance = prior.covariance;
  const auto result = joseph_update<3, 2>(mean, covariance, Vector2(0.02, -0.01), h, r);
  const double se = std::sqrt(covariance.diagonal().maxCoeff() / p.particles);
  EXPECT_LT(difference(filter.estimate().pose, {mean[0], mean[1], mean[2]}).cwiseAbs().maxCoeff(), 4.0 * se);
  EXPECT_LT((filter.estimate().covariance - covariance).norm(), 0.03 * covariance.norm());
  EXPECT_NEAR(filter.estimate().nis, result.nis / 2.0, 1e-6);
}

TEST(Wocpf, WithoutBoundOnKIsFastSlam2BitForBit) {
  const auto run = drive(small_web(), 20.0, 5);
  FastSlam2Parameters base;
  base.particles = 20;
  WocpfParameters p;
  p.particles = 20;
  for (const double k : {0.0, 1e300}) {
    p.offspring.k = k;
    const auto a = make_slam_filter(base, 5, {}), b = make_slam_filter(p, 5, {});
    for (const auto& step : run) {
      feed(*a, step);
      feed(*b, step);
    }
    EXPECT_LT(a->estimate().distinct_ancestors, 20);
    expect_same(*a, *b);
  }
}

/// Drawing once a scan from the summed motion, or with every message: the same spread to first order.
TEST(FastSlam1, SamplingOnceAScanIsSamplingWithEveryMessageToFirstOrder) {
  const auto run = drive(small_web(), 0.2, 6);
  SlamEstimate estimates[2];
  for (const Sampling sample : {Sampling::scan, Sampling::odometry}) {
    FastSlam1Parameters p;
    p.particles = 100000;
    p.sample = sample;
    FastSlam1 filter(p, 5);
    for (const Odometry& o : run[0].odometry) filter.predict(o);
    filter.update(LandmarkDetections{});
    estimates[sample == Sampling::odometry] = filter.estimate();
  }
  const double n = 100000.0;
  for (int i = 0; i < 3; ++i) {
    const double sd = std::sqrt(estimates[0].covariance(i, i));
    EXPECT_LT(std::abs(difference(estimates[0].pose, estimates[1].pose)[i]), 5.0 * sd * std::sqrt(2.0 / n));
    // relative error of a variance: sqrt(2 / n), of two
    EXPECT_NEAR(estimates[1].covariance(i, i) / estimates[0].covariance(i, i), 1.0, 5.0 * 2.0 / std::sqrt(n));
  }
}

TEST(LandmarkSlam, RefusesWhatItCannotUse) {
  for (const auto& p : all_filters(3)) {
    const auto filter = make_slam_filter(p, 1, {});
    LandmarkDetections d;
    d.detections.push_back({.range = 2.0, .bearing = 0.0, .covariance = Matrix2::Identity(), .id = 1});
    filter->update(d);
    EXPECT_THROW(filter->update(d), InputError);  // the same seq again
    d.stamp.seq = 1;
    d.detections[0].kind = DetectionKind::bearing_only;
    d.detections[0].covariance(1, 1) = 0.0;
    EXPECT_THROW(filter->update(d), InputError);
    d.detections[0].covariance(1, 1) = 1.0;
    d.detections[0].kind = DetectionKind::range_bearing;
    d.detections[0].range = std::nan("");
    EXPECT_THROW(filter->update(d), InputError);
    Odometry o;
    o.increment.x = std::nan("");
    EXPECT_THROW(filter->predict(o), InputError);
    EXPECT_THROW(filter->update(UltrasonicScan{}, ContourFeatures{}), InputError);
    d.detections[0].range = 2.0;
    filter->update(d);  // refused messages left it as it was
    EXPECT_EQ(filter->map().landmarks.size(), 1u);
    EXPECT_EQ(filter->map().landmarks[0].observations, 2);
  }
}

/// A scan that no particle can explain: weights start again, and what follows is finite.
TEST(LandmarkSlam, SurvivesTotalCollapse) {
  for (const int particles : {1, 2, 3, 5, 10}) {
    for (const auto& p : all_filters(particles)) {
      const auto filter = make_slam_filter(p, 1, {});
      const Matrix2 r = Vector2(1e-300, 1e-300).asDiagonal();
      LandmarkDetections d;
      for (int k = 0; k < 4; ++k) {
        d.stamp.seq = k;
        d.detections = {{.range = 2.0 + k, .bearing = 0.1 * k, .covariance = 1e-8 * Matrix2::Identity(), .id = 1}};
        if (k == 2) d.detections[0].covariance = r;
        if (k == 3) d.detections[0].range = 1e200;
        try {
          filter->update(d);
        } catch (const InputError&) {  // the determinant of r is 0
        }
        EXPECT_TRUE(filter->estimate().pose.finite());
        EXPECT_TRUE(filter->estimate().covariance.allFinite());
        for (const auto& m : filter->map().landmarks) EXPECT_TRUE(m.parameters.allFinite() && m.covariance.allFinite());
      }
      EXPECT_GE(filter->collapses(), 1);
    }
  }
}

/// Ten thousand improbable scans: products of likelihoods underflow, sums of logs do not, and resampling never stops.
TEST(LandmarkSlam, NeitherUnderflowsNorStopsResampling) {
  const auto world = small_web();
  auto run = drive(world, 60.0, 7);
  for (const auto& p : all_filters(10)) {
    const auto filter = make_slam_filter(p, 1, {});
    int late = 0;
    for (std::size_t k = 0; k < run.size(); ++k) {
      auto step = run[k];
      for (auto& d : step.detections.detections) d.covariance *= 0.01;  // far too sure of itself
      feed(*filter, step);
      if (k > run.size() / 2) late += filter->estimate().resampled;
      ASSERT_TRUE(filter->estimate().pose.finite());
    }
    if (filter->estimate().particles > 0) {
      EXPECT_GT(late, 50) << kSlamFilterNames[p.index()];
    }
  }
}

}  // namespace
}  // namespace noctule::filters
