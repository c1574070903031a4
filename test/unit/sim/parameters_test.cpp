#include <gtest/gtest.h>

#include <functional>

#include "core/error.hpp"
#include "core/limits.hpp"
#include "sim/simulator.hpp"
#include "unit/sim/heptagon.hpp"

namespace noctule::sim {
namespace {

std::string refusal(const WorldParameters& world, const RobotParameters& robot) {
  try {
    Simulator simulator(world, robot, 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_refusal(const std::string& what, const std::function<void(WorldParameters&, RobotParameters&)>& change) {
  WorldParameters world = test::heptagon();
  RobotParameters robot = test::paper002();
  change(world, robot);
  const std::string message = refusal(world, robot);
  EXPECT_NE(message.find(what), std::string::npos) << "wanted: " << what << "\ngot: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(Parameters, PinnedWorldAndRobotAreSound) {
  EXPECT_EQ(refusal(test::heptagon(), test::paper002()), "accepted");
}

TEST(WorldParameters, RefusesAnEmptyWorld) {
  EXPECT_NE(refusal(WorldParameters{}, RobotParameters{}).find("got neither"), std::string::npos);
}

TEST(WorldParameters, RefusesPathsThatHitSomething) {
  using W = WorldParameters;
  using R = RobotParameters;
  expect_refusal("path.waypoints_cm[2]: expected a place inside the room, got (500, 45) cm",
                 [](W& w, R&) { w.path.waypoints[2].x() = 5.0; });
  expect_refusal(
      "path.waypoints_cm[1]: expected at least 5 cm from every obstacle, got (150, -57) cm 3 cm from wall '1'",
      [](W& w, R&) { w.path.waypoints[1].y() = -0.57; });
  expect_refusal("inside cylinder '2'", [](W& w, R&) { w.path.waypoints[3] = {1.8, 1.25}; });
  expect_refusal("path.start_cm_deg: expected at least 5 cm from every obstacle, got (60, 60) cm inside cylinder '1'",
                 [](W& w, R&) {
                   w.path.start = {0.6, 0.6, 0.0};
                 });
  expect_refusal("path.start_cm_deg: expected a place inside the room", [](W& w, R&) { w.path.start.x = -1.0; });
  expect_refusal(
      "path.waypoints_cm[1]: expected at least 5 cm from every obstacle, got a way to (120, 120) cm that passes",
      [](W& w, R&) {
        w.path.waypoints[1] = {1.2, 1.2};
      });
  expect_refusal("back to the first way-point", [](W& w, R&) {
    w.path.waypoints = {{0.3, 0.3}, {0.3, 1.2}, {1.2, 1.2}};
  });
}

TEST(WorldParameters, RefusesImpossibleNumbers) {
  using W = WorldParameters;
  using R = RobotParameters;
  expect_refusal("path.loops: expected a finite number >= 1, got 0", [](W& w, R&) { w.path.loops = 0; });
  expect_refusal("path.stop_spacing_cm: expected a finite number >= 0.1, got -12",
                 [](W& w, R&) { w.path.stop_spacing = -0.12; });
  expect_refusal("path.scans_at_start: expected a finite number >= 1, got 0",
                 [](W& w, R&) { w.path.scans_at_start = 0; });
  expect_refusal("room.cylinders[1].radius_cm: expected a finite number > 0, got -14.444",
                 [](W& w, R&) { w.room.cylinders[1].radius = -0.14444; });
  expect_refusal("room.walls[0].rho_cm: expected a finite number, got nan",
                 [](W& w, R&) { w.room.walls[0].rho = kNan; });
  expect_refusal("path.waypoints_cm: expected a finite number, got nan",
                 [](W& w, R&) { w.path.waypoints[0].x() = kNan; });
}

TEST(RobotParameters, RefusesImpossibleNumbers) {
  using W = WorldParameters;
  using R = RobotParameters;
  expect_refusal("robot 'paper002': sonar.stepper.pings: expected a finite number >= 1 and <= 10000, got 0",
                 [](W&, R& r) { r.sonar.stepper.pings = 0; });
  expect_refusal("sonar.half_angle_deg: expected a finite number > 0 and < 90, got 90",
                 [](W&, R& r) { r.sonar.half_angle = radians(90); });
  expect_refusal("sonar.outliers", [](W&, R& r) { r.sonar.outliers = 1.5; });
  expect_refusal("sonar.noise.base_cm", [](W&, R& r) { r.sonar.noise.base = 0.0; });
  expect_refusal("drive.speed_m_per_s: expected a finite number >= 0.001, got 0",
                 [](W&, R& r) { r.drive.speed = 0.0; });
  expect_refusal("odometry.turn_deg: expected a finite number >= 0, got -1",
                 [](W&, R& r) { r.odometry.turn = radians(-1.0); });
}

TEST(RobotParameters, RefusesSettingsThatDoNotFitTogether) {
  using W = WorldParameters;
  using R = RobotParameters;
  expect_refusal("sonar: mounts: expected at least 1", [](W&, R& r) { r.sonar.mounting = Mounting::fixed; });
  expect_refusal("sonar: firing: expected one_by_one", [](W&, R& r) { r.sonar.firing = Firing::parallel; });
  expect_refusal("min_range_cm: expected less than max_range_cm = 400, got 500",
                 [](W&, R& r) { r.sonar.min_range = 5.0; });
  expect_refusal("mixture: expected weights that sum to 1, got 1.1",
                 [](W&, R& r) { r.sonar.mixture[0].weight = 0.95; });
  expect_refusal("stage 2 of the noise schedule", [](W&, R& r) { r.sonar.schedule[1].start = 0.0; });
}

TEST(RobotParameters, RefusesSteeringThatCannotReachAWaypoint) {
  expect_refusal("drive.max_steering_deg: expected steering that reaches way-point", [](auto&, auto& r) {
    r.drive.model = DriveModel::front_axle;
    r.drive.max_steering = radians(5);
  });
}

}  // namespace
}  // namespace noctule::sim
