#include "eval/sensor_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/observation_order.hpp"
#include "core/rng.hpp"

namespace noctule::eval {
namespace {

/// A robot on circles of changing size; odometry over- and understates, ranges are scaled and shifted.
struct Robot {
  double distance_scale = 1.04, turn_scale = 0.9, range_scale = 1.02, range_bias = 0.05;
  double along = 0.0, turn = 0.0, range_sd = 0.0, bearing_sd = 0.0;
  int outliers_every = 0;
  std::vector<KnownLandmark> landmarks{{1, {3.0, 0.0}}, {2, {-1.0, 4.0}}, {3, {0.0, -5.0}}};

  [[nodiscard]] std::vector<Observation> drive(std::uint64_t seed) const {
    std::vector<Observation> out;
    Pose2 pose;
    out.emplace_back(GroundTruth{{0, 0}, pose});
    for (std::int64_t k = 1; k <= 6000; ++k) {
      Rng rng(seed, stream_id("calibration"), static_cast<std::uint64_t>(k));
      const std::int64_t utime = k * 100'000;
      const double way = 0.02, bend = 0.03 * std::sin(0.01 * static_cast<double>(k));
      const Pose2 step{way * std::cos(0.5 * bend), way * std::sin(0.5 * bend), bend};
      pose = pose * step;
      const double said_way = (way + rng.normal(0.0, along * std::sqrt(way))) / distance_scale;
      const double said_bend = (bend + rng.normal(0.0, turn * std::sqrt(std::abs(bend)))) / turn_scale;
      out.emplace_back(Odometry{{utime, 0},
                                {said_way * std::cos(0.5 * said_bend), said_way * std::sin(0.5 * said_bend), said_bend},
                                Matrix3::Zero()});
      out.emplace_back(GroundTruth{{utime, 0}, pose});
      if (k % 10 != 0) continue;
      LandmarkDetections message{{utime, 0}, {}, {}};
      for (const KnownLandmark& l : landmarks) {
        const Vector2 v = l.position - pose.position();
        LandmarkDetection d;
        d.id = l.id;
        d.range = range_scale * v.norm() + range_bias + rng.normal(0.0, range_sd);
        d.bearing = wrap(std::atan2(v.y(), v.x()) - pose.yaw + rng.normal(0.0, bearing_sd));
        if (outliers_every > 0 && k % (10 * outliers_every) == 0) d.range += 3.0;
        message.detections.push_back(d);
      }
      out.emplace_back(message);
    }
    put_in_order(out);
    return out;
  }
};

SensorCalibration calibrate(const Robot& robot, const std::vector<std::vector<Observation>>& runs) {
  return calibrate_sensors(runs, robot.landmarks);
}

TEST(SensorCalibration, TwoRunsSayMoreThanOne) {
  Robot robot;
  robot.along = robot.turn = robot.range_sd = robot.bearing_sd = 0.05;
  const SensorCalibration one = calibrate(robot, {robot.drive(1)}),
                          two = calibrate(robot, {robot.drive(1), robot.drive(2)});
  EXPECT_NEAR(two.turn_scale.sd, one.turn_scale.sd / std::sqrt(2.0), 0.2 * one.turn_scale.sd);
  EXPECT_NEAR(two.range_bias.sd, one.range_bias.sd / std::sqrt(2.0), 0.2 * one.range_bias.sd);
}

TEST(SensorCalibration, RecoversExactScales) {
  const Robot robot;
  const SensorCalibration c = calibrate(robot, {robot.drive(1)});
  EXPECT_NEAR(c.distance_scale.value, 1.04, 1e-4);
  EXPECT_NEAR(c.turn_scale.value, 0.9, 1e-6);
  EXPECT_NEAR(c.range_scale.value, 1.02, 1e-9);
  EXPECT_NEAR(c.range_bias.value, 0.05, 1e-9);
  EXPECT_NEAR(c.bearing_bias.value, 0.0, 1e-9);
  EXPECT_GT(c.windows, 250);
}

TEST(SensorCalibration, StatesItsErrorsAndTheNoiseThatRemains) {
  Robot robot;
  robot.along = 0.05;
  robot.turn = 0.1;
  robot.range_sd = 0.1;
  robot.bearing_sd = 0.02;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const SensorCalibration c = calibrate(robot, {robot.drive(seed)});
    const auto square = [](const Estimated& e, double truth) { return std::pow((e.value - truth) / e.sd, 2.0); };
    squares += square(c.distance_scale, 1.04) + square(c.turn_scale, 0.9) + square(c.range_bias, 0.05) +
               square(c.bearing_bias, 0.0);
    EXPECT_NEAR(c.along, 0.05, 0.01);
    EXPECT_NEAR(c.turn, 0.1, 0.03);
    EXPECT_NEAR(c.range_base + 4.0 * c.range_relative, 0.1, 0.01);
    EXPECT_NEAR(c.bearing_sd, 0.02, 0.002);
  }
  EXPECT_GT(squares, 17.0);  // chi-square with 40 degrees of freedom, 99.9 %
  EXPECT_LT(squares, 78.0);
}

TEST(SensorCalibration, LeavesOutGrossErrors) {
  Robot robot;
  robot.range_sd = 0.1;
  robot.outliers_every = 20;
  const SensorCalibration c = calibrate(robot, {robot.drive(1)});
  EXPECT_NEAR(c.range_bias.value, 0.05, 5.0 * c.range_bias.sd);
  EXPECT_GE(c.outliers, 80);
}

TEST(SensorCalibration, WithoutTruthThereIsNothing) {
  const Robot robot;
  std::vector<Observation> observations = robot.drive(1);
  std::erase_if(observations, [](const Observation& o) { return std::holds_alternative<GroundTruth>(o); });
  const SensorCalibration c = calibrate(robot, {observations});
  EXPECT_TRUE(std::isnan(c.distance_scale.value));
  EXPECT_TRUE(std::isnan(c.range_scale.value));
  EXPECT_EQ(c.windows + c.sightings, 0);
}

}  // namespace
}  // namespace noctule::eval
