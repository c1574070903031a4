#include <gtest/gtest.h>

#include "core/chi2.hpp"
#include "core/gaussian.hpp"
#include "unit/sim/heptagon.hpp"
#include "unit/sim/recording.hpp"

namespace noctule::sim {
namespace {

using test::Recording;

constexpr double kOneInAThousand = 0.0005;  // on either side

RobotParameters one_ping(DriveModel model) {
  RobotParameters robot = test::paper002();
  robot.drive.model = model;
  robot.sonar.stepper.pings = 1;
  return robot;
}

/// Sum of squares of numbers that should be standard normal.
struct ChiSquare {
  double sum = 0.0;
  int n = 0;
  void add(double standardised) {
    sum += standardised * standardised;
    ++n;
  }
  [[nodiscard]] bool consistent() const {
    return sum > chi2_quantile(kOneInAThousand, n) && sum < chi2_quantile(1.0 - kOneInAThousand, n);
  }
};

/// Errors of one run summed up over steps (from stop to stop) and over turns on the spot.
struct Sums {
  ChiSquare length, drift, turn;

  void add(const Recording& run) {
    const models::OdometryNoise noise;
    double length_error = 0.0, yaw_error = 0.0, way = 0.0, turn_error = 0.0;
    bool turning = false;
    Pose2 before;
    const Odometry* latest = nullptr;
    for (const Observation& o : run.all) {
      if (const auto* odometry = std::get_if<Odometry>(&o)) latest = odometry;
      if (const auto* truth = std::get_if<GroundTruth>(&o); truth != nullptr && latest != nullptr) {
        const Pose2 step = between(before, truth->base_in_map);
        const Vector3 error = difference(latest->increment, step);
        const bool on_the_spot = step.position().norm() < 1e-12;
        if (turning && !on_the_spot) turn.add(std::exchange(turn_error, 0.0) / noise.turn);
        turning = on_the_spot;
        if (on_the_spot) {
          turn_error += error.z();
        } else {
          length_error += error.x();
          yaw_error += error.z();
          way += step.position().norm();
        }
        before = truth->base_in_map;
        latest = nullptr;
      }
      if (std::holds_alternative<UltrasonicScan>(o) && way > 0.0) {
        length.add(length_error / (noise.distance * way));
        drift.add(yaw_error / (noise.drift * std::sqrt(way)));
        length_error = yaw_error = way = 0.0;
      }
    }
  }
};

constexpr int kRuns = 40;

Sums errors(const models::OdometryNoise& noise) {
  RobotParameters robot = one_ping(DriveModel::turn_and_go);
  robot.odometry = noise;
  Sums sums;
  for (int seed = 1; seed <= kRuns; ++seed) sums.add(Recording(Simulator(test::heptagon(), robot, seed)));
  return sums;
}

TEST(OdometryStatistics, StepsAndTurnsErrAsTheParametersSay) {
  const Sums sums = errors({});
  EXPECT_EQ(sums.length.n, 133 * kRuns);
  EXPECT_EQ(sums.turn.n, 15 * kRuns);  // one at each way-point but the first and the last
  EXPECT_TRUE(sums.length.consistent()) << sums.length.sum / sums.length.n;
  EXPECT_TRUE(sums.drift.consistent()) << sums.drift.sum / sums.drift.n;
  EXPECT_TRUE(sums.turn.consistent()) << sums.turn.sum / sums.turn.n;
}

TEST(OdometryStatistics, TheBoundsNoticeAQuarterMoreNoise) {
  const models::OdometryNoise right;
  const Sums sums = errors({1.25 * right.distance, 1.25 * right.turn, 1.25 * right.drift});
  EXPECT_FALSE(sums.length.consistent());
  EXPECT_FALSE(sums.drift.consistent());
  EXPECT_FALSE(sums.turn.consistent());
}

/// NEES of the pose after the first `metres`, by odometry and its reported covariance alone.
double nees(const Recording& run, double metres) {
  PoseGaussian pose;
  double way = 0.0;
  Pose2 truth;
  for (const Observation& o : run.all) {
    if (const auto* odometry = std::get_if<Odometry>(&o)) {
      pose = pose * PoseGaussian{odometry->increment, odometry->covariance};
    }
    if (const auto* t = std::get_if<GroundTruth>(&o)) {
      way += (t->base_in_map.position() - truth.position()).norm();
      truth = t->base_in_map;
      if (way > metres) break;
    }
  }
  return mahalanobis2<3>(difference(pose.mean, truth), pose.covariance);
}

TEST(OdometryStatistics, IntegratedOdometryIsConsistentWithItsCovariance) {
  constexpr int kSeeds = 150;
  const Interval bounds = nees_bounds(3, kSeeds, 1.0 - 2.0 * kOneInAThousand);
  for (const DriveModel model : {DriveModel::turn_and_go, DriveModel::front_axle}) {
    for (const double metres : {1.0, 8.0}) {
      double sum = 0.0;
      for (int seed = 1; seed <= kSeeds; ++seed) {
        sum += nees(Recording(Simulator(test::heptagon(), one_ping(model), seed)), metres);
      }
      EXPECT_GT(sum / kSeeds, bounds.low) << metres;
      EXPECT_LT(sum / kSeeds, bounds.high) << metres;
    }
  }
}

TEST(OdometryStatistics, TurnsOfASteeredRobotAddUpToOneTurnPerWaypoint) {
  // All the turning between two way-points counts as one turn, so the reported heading variances of a run sum up to
  // 15 turns and the drift of the way. The first leg needs no steering.
  const Recording run(Simulator(test::heptagon(), one_ping(DriveModel::front_axle), 1));
  const models::OdometryNoise noise;
  double variance = 0.0, way = 0.0;
  for (std::size_t i = 0; i < run.odometry.size(); ++i) variance += run.odometry[i].covariance(2, 2);
  for (std::size_t i = 1; i < run.truth.size(); ++i) {
    way += (run.truth[i].base_in_map.position() - run.truth[i - 1].base_in_map.position()).norm();
  }
  EXPECT_NEAR(variance - noise.drift * noise.drift * way, 15 * noise.turn * noise.turn, 1e-9);
}

}  // namespace
}  // namespace noctule::sim
