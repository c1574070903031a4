#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

#include "core/error.hpp"
#include "core/gaussian.hpp"
#include "core/rng.hpp"
#include "filters/localisation/ekf_localisation.hpp"
#include "filters/rfs/gnn_tracker.hpp"

namespace noctule::filters {
namespace {

using Scan = std::vector<Vector2>;

TEST(GnnTracker, ConfirmsAnObjectAtTheStatedHitAndDropsItAfterTheStatedMisses) {
  GnnTracker tracker;  // 4 of 5, gone after 3 misses
  const std::vector<Vector2> seen{{100.0, -50.0}}, nothing;
  for (int k = 1; k <= 3; ++k) {
    tracker.update(seen);
    EXPECT_TRUE(tracker.objects().empty()) << k;
  }
  tracker.update(seen);
  ASSERT_EQ(tracker.objects().size(), 1u);
  const std::int64_t label = tracker.objects()[0].label;
  EXPECT_LT((tracker.objects()[0].position() - seen[0]).norm(), 1e-9);
  for (int k = 1; k <= 2; ++k) tracker.update(nothing);
  ASSERT_EQ(tracker.objects().size(), 1u);
  EXPECT_EQ(tracker.objects()[0].label, label);
  tracker.update(nothing);
  EXPECT_TRUE(tracker.objects().empty());
}

TEST(GnnTracker, WithoutClutterItIsTheKalmanFilter) {
  GnnTracker tracker;
  const ObjectModel model;
  ObjectEstimate kalman;
  for (int k = 0; k < 20; ++k) {
    Rng rng(1, stream_id("gnn"), static_cast<std::uint64_t>(k));
    const Vector2 z(5.0 * k + rng.normal(0.0, 10.0), -3.0 * k + rng.normal(0.0, 10.0));
    tracker.update(Scan{z});
    if (k == 0) {
      kalman = model.first_seen(0, z);
      continue;
    }
    const models::Matrix4 f = model.motion().transition();
    const models::Matrix24 h = models::ConstantVelocity::position();
    kalman.state = f * kalman.state;
    kalman.covariance = f * kalman.covariance * f.transpose() + model.motion().noise();
    const Matrix2 s = h * kalman.covariance * h.transpose() + 100.0 * Matrix2::Identity();
    const Eigen::Matrix<double, 4, 2> gain = kalman.covariance * h.transpose() * s.inverse();
    kalman.state += gain * (z - h * kalman.state);
    kalman.covariance = (models::Matrix4::Identity() - gain * h) * kalman.covariance;
  }
  ASSERT_EQ(tracker.objects().size(), 1u);
  EXPECT_LT((tracker.objects()[0].state - kalman.state).norm(), 1e-9);
  EXPECT_LT((tracker.objects()[0].covariance - kalman.covariance).norm(), 1e-8);
}

TEST(GnnTracker, TheOrderOfTheMeasurementsDoesNotMatterAndLabelsStay) {
  GnnTracker forward, backward;
  std::vector<std::int64_t> labels;
  for (int k = 0; k < 30; ++k) {
    std::vector<Vector2> scan{{10.0 * k, 0.0}, {300.0 - 10.0 * k, 60.0}, {0.0, 5.0 * k + 200.0}};
    forward.update(scan);
    std::reverse(scan.begin(), scan.end());
    backward.update(scan);
    ASSERT_EQ(forward.objects().size(), backward.objects().size());
    if (k == 5) {
      for (const ObjectEstimate& o : forward.objects()) labels.push_back(o.label);
    }
  }
  ASSERT_EQ(forward.objects().size(), 3u);
  double nearest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(forward.objects()[i].label, labels[i]);
    double best = 1e9;
    for (const ObjectEstimate& o : backward.objects()) {
      best = std::min(best, (o.position() - forward.objects()[i].position()).norm());
    }
    nearest = std::max(nearest, best);
  }
  EXPECT_LT(nearest, 1e-9);
}

TEST(GnnTracker, RefusesNumbersThatAreNotFiniteAndStaysAsItWas) {
  GnnTracker tracker;
  for (int k = 0; k < 5; ++k) tracker.update(Scan{{1.0, 2.0}});
  const auto before = tracker.objects();
  EXPECT_THROW(tracker.update(Scan{{1.0, 2.0}, {NAN, 0.0}}), InputError);
  ASSERT_EQ(tracker.objects().size(), 1u);
  EXPECT_EQ(tracker.objects()[0].state, before[0].state);
  GnnTrackerParameters p;
  p.confirm_hits = 6;
  EXPECT_THROW(GnnTracker{p}, InputError);
}

/// A robot on a circle, four landmarks, exact or noisy.
struct Drive {
  std::vector<KnownLandmark> map{{1, {5.0, 0.0}}, {2, {0.0, 7.0}}, {3, {-5.0, 3.0}}, {4, {0.0, -4.0}}};
  Matrix3 odometry = Vector3(1e-4, 1e-4, 4e-4).asDiagonal();
  Matrix2 sighting = Vector2(0.01, 0.001).asDiagonal();
  Pose2 sensor{0.2, -0.1, 0.3};

  /// NEES at each step of a run. \param ids sightings carry identities
  [[nodiscard]] std::vector<double> nees(std::uint64_t seed, bool ids) const {
    EkfLocalisation filter(map, {});
    std::vector<double> values;
    Pose2 truth;
    for (std::uint64_t k = 1; k <= 60; ++k) {
      Rng rng(seed, stream_id("localisation"), k);
      const Vector3 e = Vector3(rng.normal(0, 0.01), rng.normal(0, 0.01), rng.normal(0, 0.02));
      const Pose2 step{0.1, 0.0, 0.05};
      truth = truth * Pose2{step.x + e[0], step.y + e[1], step.yaw + e[2]};
      filter.predict({{}, step, odometry});
      LandmarkDetections message{{}, sensor, {}};
      for (const KnownLandmark& l : map) {
        const Vector2 d = inverse(truth * sensor) * l.position;
        LandmarkDetection z;
        z.range = d.norm() + rng.normal(0, 0.1);
        z.bearing = wrap(std::atan2(d.y(), d.x()) + rng.normal(0, std::sqrt(0.001)));
        z.covariance = sighting;
        if (ids) z.id = l.id;
        message.detections.push_back(z);
      }
      filter.update(message);
      const Vector3 error = difference(filter.pose().mean, truth);
      values.push_back(mahalanobis2<3>(error, filter.pose().covariance));
    }
    return values;
  }
};

TEST(EkfLocalisation, IsConsistentAndNeedsNoIdentitiesWhereLandmarksStandApart) {
  const Drive drive;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const std::vector<double> named = drive.nees(seed, true), anonymous = drive.nees(seed, false);
    sum += named.back();
    EXPECT_NEAR(named.back(), anonymous.back(), 1e-9) << seed;
  }
  EXPECT_GT(sum, 102.0);  // chi-square with 150 degrees of freedom, 99.9 %
  EXPECT_LT(sum, 211.0);
}

TEST(EkfLocalisation, GrossErrorsAndStrangersAreDropped) {
  const Drive drive;
  EkfLocalisation filter(drive.map, {});
  filter.predict({{}, {}, drive.odometry});
  LandmarkDetections message{{}, {}, {}};
  LandmarkDetection z;
  z.covariance = drive.sighting;
  z.range = 9.0;
  z.id = 1;
  message.detections.push_back(z);
  z.range = 4.0;
  z.id = 77;
  message.detections.push_back(z);
  filter.update(message);
  EXPECT_EQ(filter.pose().mean, Pose2{});
  EXPECT_EQ(filter.nis(), 0.0);
  message.detections[0].range = -1.0;
  EXPECT_THROW(filter.update(message), InputError);
  EXPECT_THROW(EkfLocalisation(drive.map, {NAN, 0.0, 0.0}), InputError);
}

}  // namespace
}  // namespace noctule::filters
