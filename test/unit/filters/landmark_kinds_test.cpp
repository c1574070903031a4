/// Landmarks seen by bearing or range alone.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/chi2.hpp"
#include "core/gaussian.hpp"
#include "filters/slam/make_slam_filter.hpp"
#include "unit/filters/landmark_world.hpp"

namespace noctule::filters {
namespace {

using test::drive;
using test::feed;
using test::LandmarkScanStep;
using test::small_web;
using Run = std::vector<LandmarkScanStep>;

void reduce(LandmarkDetection& d, DetectionKind kind) {
  d.kind = kind;
  if (kind == DetectionKind::range_bearing) return;
  const Eigen::Index lost = kind == DetectionKind::bearing_only ? 0 : 1;
  (lost == 0 ? d.range : d.bearing) = 0.0;
  d.covariance.row(lost).setZero();
  d.covariance.col(lost).setZero();
}
Run reduced(Run run, DetectionKind kind) {
  for (auto& step : run) {
    for (auto& d : step.detections.detections) reduce(d, kind);
  }
  return run;
}

std::vector<SlamFilterParameters> particle_filters(int particles) {
  std::vector<SlamFilterParameters> result{FastSlam1Parameters{},    FastSlam2Parameters{}, UFastSlamParameters{},
                                           PsoUFastSlamParameters{}, WocpfParameters{},     ParticleSlamParameters{}};
  for (auto& p : result) {
    std::visit(
        [particles](auto& q) {
          if constexpr (requires { q.particles; }) q.particles = particles;
        },
        p);
  }
  return result;
}

/// What is not measured and what is measured with an error beyond all bounds teach the same.
TEST(LandmarkKinds, WhatIsNotMeasuredIsMeasuredInfinitelyBadly) {
  auto filters = particle_filters(20);
  filters.emplace_back(EkfSlamParameters{});
  const auto run = drive(small_web(), 4.0, 1);
  for (const auto kind : {DetectionKind::bearing_only, DetectionKind::range_only}) {
    for (const auto& p : filters) {
      const auto without = make_slam_filter(p, 5, {}), badly = make_slam_filter(p, 5, {});
      for (std::size_t i = 0; i < run.size(); ++i) {
        LandmarkScanStep a = run[i], b = run[i];
        if (i >= 5) {
          std::erase_if(a.detections.detections, [](const auto& d) { return d.id > 20; });  // not begun before
          std::erase_if(a.detections.detections, [&](const auto& d) {
            return std::ranges::none_of(run[0].detections.detections, [&](const auto& e) { return e.id == d.id; });
          });
          b = a;
          for (auto& d : a.detections.detections) reduce(d, kind);
          for (auto& d : b.detections.detections) {
            const Eigen::Index lost = kind == DetectionKind::bearing_only ? 0 : 1;
            d.covariance(lost, lost) = 1e12;
          }
        }
        feed(*without, a);
        feed(*badly, b);
      }
      EXPECT_LT(difference(without->estimate().pose, badly->estimate().pose).norm(), 1e-5) << p.index();
      EXPECT_LT((without->estimate().covariance - badly->estimate().covariance).norm(), 1e-5) << p.index();
      const auto a = without->map().landmarks, b = badly->map().landmarks;
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t k = 0; k < a.size(); ++k) {
        EXPECT_LT((a[k].parameters - b[k].parameters).norm(), 1e-5) << p.index();
        EXPECT_LT((a[k].covariance - b[k].covariance).norm(), 1e-5) << p.index();
      }
    }
  }
}

/// Landmarks seen from a path that is known: their normalised squared errors over many runs.
double landmark_nees(DetectionKind kind, double duration, int runs, int times, int& landmarks) {
  const auto world = small_web();
  FastSlam1Parameters p;
  p.particles = 1;
  double sum = 0.0;
  landmarks = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    const auto filter = make_slam_filter(p, 1, {});
    Pose2 at;
    std::int64_t seq = 0;
    for (auto& step : reduced(drive(world, duration, static_cast<std::uint64_t>(seed)), kind)) {
      Odometry o;
      o.increment = between(at, step.truth);
      filter->predict(o);
      at = step.truth;
      for (int k = 0; k < times; ++k) {
        step.detections.stamp.seq = seq++;
        filter->update(step.detections);
      }
    }
    for (const auto& l : filter->map().landmarks) {
      const Vector2 error = l.parameters.head<2>() - world.landmarks[static_cast<std::size_t>(l.id)];
      sum += mahalanobis2<2>(error, l.covariance.topLeftCorner<2, 2>());
      ++landmarks;
    }
  }
  return sum / landmarks;
}

/// Each sighting enters once, and the first Gaussian is as wide as its errors.
TEST(LandmarkKinds, LandmarksAlongAKnownPathAreConsistent) {
  constexpr int runs = 40;
  for (const auto kind : {DetectionKind::bearing_only, DetectionKind::range_only}) {
    int landmarks = 0;
    const double nees = landmark_nees(kind, 20.0, runs, 1, landmarks);
    ASSERT_GT(landmarks, 2 * runs);
    const auto bounds = nees_bounds(2, landmarks, 0.999);
    EXPECT_GT(nees, bounds.low) << static_cast<int>(kind);
    EXPECT_LT(nees, bounds.high) << static_cast<int>(kind);
    EXPECT_GT(landmark_nees(kind, 20.0, runs, 3, landmarks), bounds.high);  // the same sightings three times
  }
}

/// A robot that drives straight on cannot tell by ranges on which side a landmark is.
TEST(LandmarkKinds, RangesBeginALandmarkWhenItsMirrorImageIsExcluded) {
  FastSlam1Parameters p;
  p.particles = 1;
  const auto filter = make_slam_filter(p, 1, {});
  const Vector2 landmark(6.0, 4.0);
  Pose2 at;
  std::size_t on_the_way = 0;
  for (int k = 0; k < 60; ++k) {
    const Odometry o{{k, k}, {0.25, 0.0, k < 30 ? 0.0 : 0.05}};
    filter->predict(o);
    at = at * o.increment;
    LandmarkDetections d{{k, k}, {}, {}};
    d.detections.push_back({.kind = DetectionKind::range_only, .range = (landmark - at.position()).norm(), .id = 3});
    d.detections[0].covariance(0, 0) = 0.01;
    filter->update(d);
    if (k < 30) on_the_way = filter->map().landmarks.size();
  }
  EXPECT_EQ(on_the_way, 0u);
  ASSERT_EQ(filter->map().landmarks.size(), 1u);
  EXPECT_LT((filter->map().landmarks[0].parameters.head<2>() - landmark).norm(), 1e-3);
}

/// No parallax, no landmark: neither at rest nor straight ahead.
TEST(LandmarkKinds, BearingsWithoutParallaxBeginNothing) {
  const auto filter = make_slam_filter(particle_filters(3)[1], 1, {});
  Rng rng(3);
  for (int k = 0; k < 100; ++k) {
    filter->predict({{k, k}, {k < 50 ? 0.0 : 0.1, 0.0, 0.0}});
    LandmarkDetections d{{k, k}, {}, {}};
    d.detections.push_back({.kind = DetectionKind::bearing_only, .bearing = rng.normal(0.0, 0.01), .id = 3});
    d.detections[0].covariance(1, 1) = 1e-4;
    filter->update(d);
  }
  EXPECT_TRUE(filter->map().landmarks.empty());
}

/// All filters map the web by bearings, with and without names, and by ranges; however many threads, and whatever the
/// order of the sightings.
TEST(LandmarkKinds, EveryFilterMapsByThem) {
  auto world = small_web();
  world.speed_sd = 0.05;
  world.steering_sd = radians(1.0);
  world.bearing_sd = radians(0.5);
  world.range_sd = 0.05;
  world.max_range = 15.0;
  struct Case {
    DetectionKind kind;
    bool known;
  };
  for (const Case& c : {Case{DetectionKind::bearing_only, true}, Case{DetectionKind::range_only, true},
                        Case{DetectionKind::bearing_only, false}}) {
    const auto run = reduced(drive(world, 30.0, 2, 1.0, c.known), c.kind);
    for (const auto& p : particle_filters(40)) {
      const auto filter = make_slam_filter(p, 7, {}), other = make_slam_filter(p, 7, {}, 2);
      for (const auto& step : run) {
        feed(*filter, step);
        auto turned = step;
        if (c.known) std::ranges::reverse(turned.detections.detections);
        feed(*other, turned);
      }
      EXPECT_LT(difference(filter->estimate().pose, run.back().truth).head<2>().norm(), 1.0) << p.index();
      EXPECT_EQ(filter->estimate().pose, other->estimate().pose);
      const auto map = filter->map().landmarks;
      EXPECT_GE(map.size(), 3u) << p.index();
      for (const auto& l : map) {
        double error = kInf;  // in sd, the pose's own error besides
        const Matrix2 covariance = l.covariance.topLeftCorner<2, 2>() + 0.09 * Matrix2::Identity();
        for (const Vector2& truth : world.landmarks) {
          error = std::min(error, std::sqrt(mahalanobis2<2>(l.parameters.head<2>() - truth, covariance)));
        }
        EXPECT_LT(error, 4.0) << p.index() << " known " << c.known << " kind " << static_cast<int>(c.kind);
      }
    }
  }
}

/// Bearings of nothing agree on no place.
TEST(LandmarkKinds, ClutterBeginsNoLandmarks) {
  auto world = small_web();
  world.landmarks = {Vector2(8.0, -6.0)};
  world.bearing_sd = radians(1.0);
  FastSlam2Parameters p;
  p.particles = 20;
  int more = 0, missing = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    auto run = reduced(drive(world, 10.0, seed, 1.0, false), DetectionKind::bearing_only);
    Rng rng(seed, stream_id("test.clutter"));
    const auto filter = make_slam_filter(p, seed, {});
    for (auto& step : run) {
      for (int k = 0; k < 3; ++k) {
        LandmarkDetection& d = step.detections.detections.emplace_back();
        d.kind = DetectionKind::bearing_only;
        d.bearing = rng.uniform(-0.5 * kPi, 0.5 * kPi);
        d.covariance(1, 1) = world.bearing_sd * world.bearing_sd;
      }
      feed(*filter, step);
    }
    const auto map = filter->map().landmarks;
    const auto near = std::ranges::count_if(
        map, [&](const auto& l) { return (l.parameters.template head<2>() - world.landmarks[0]).norm() < 2.0; });
    missing += near == 0;
    more += static_cast<int>(map.size()) - static_cast<int>(near);
  }
  EXPECT_LE(more, 3);
  EXPECT_LE(missing, 1);
}

/// Landmarks begun by range and bearing go on by bearings, and bearings that come first do no harm.
TEST(LandmarkKinds, MixInOneMap) {
  const auto world = small_web();
  for (const auto& p : particle_filters(30)) {
    double whole = 0.0, mixed = 0.0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      auto run = drive(world, 15.0, seed);
      const auto filter = make_slam_filter(p, seed, {}), limit = make_slam_filter(p, seed, {});
      Rng rng(seed, stream_id("test.kinds"));
      for (auto step : run) {
        feed(*limit, step);
        for (auto& d : step.detections.detections) reduce(d, static_cast<DetectionKind>(rng.index(3)));
        feed(*filter, step);
      }
      whole += difference(limit->estimate().pose, run.back().truth).head<2>().norm();
      mixed += difference(filter->estimate().pose, run.back().truth).head<2>().norm();
      for (const auto& l : filter->map().landmarks) {
        EXPECT_LT((l.parameters.head<2>() - world.landmarks[static_cast<std::size_t>(l.id)]).norm(), 3.0);
      }
    }
    EXPECT_LT(mixed, 3.0 * whole + 1.0) << p.index();
  }
}

}  // namespace
}  // namespace noctule::filters
