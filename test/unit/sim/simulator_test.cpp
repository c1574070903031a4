#include "sim/simulator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/observation_order.hpp"
#include "unit/sim/heptagon.hpp"
#include "unit/sim/recording.hpp"

namespace noctule::sim {
namespace {

using test::Recording;

std::int64_t utime(const Observation& o) {
  return stamp_of(o).utime;
}

bool equal(const UltrasonicScan& a, const UltrasonicScan& b) {
  return a.stamp == b.stamp && std::ranges::equal(a.beams, b.beams, [](const auto& x, const auto& y) {
           return x.sensor_in_base == y.sensor_in_base && x.range == y.range && x.echo == y.echo;
         });
}
bool equal(const Odometry& a, const Odometry& b) {
  return a.stamp == b.stamp && a.increment == b.increment && a.covariance == b.covariance;
}
bool equal(const GroundTruth& a, const GroundTruth& b) {
  return a.stamp == b.stamp && a.base_in_map == b.base_in_map;
}
template <class Value>
bool all_equal(const std::vector<Value>& a, const std::vector<Value>& b) {
  return std::ranges::equal(a, b, [](const Value& x, const Value& y) { return equal(x, y); });
}

Recording record(const RobotParameters& robot, std::uint64_t seed, const WorldParameters& world = test::heptagon()) {
  return Recording(Simulator(world, robot, seed));
}

TEST(Simulator, StreamIsInOrderAndCountsWithoutGaps) {
  const Recording r = record(test::paper002(), 1);
  std::int64_t odometry = 0, truth = 0, scans = 0;
  for (std::size_t i = 0; i < r.all.size(); ++i) {
    const Observation& o = r.all[i];
    if (i > 0) {
      ASSERT_GE(utime(o), utime(r.all[i - 1]));
    }
    if (const auto* x = std::get_if<Odometry>(&o)) {
      EXPECT_EQ(x->stamp.seq, odometry++);
      ASSERT_TRUE(std::holds_alternative<GroundTruth>(r.all[i + 1]));
      EXPECT_EQ(utime(r.all[i + 1]), utime(o));
    }
    if (const auto* x = std::get_if<GroundTruth>(&o)) {
      EXPECT_EQ(x->stamp.seq, truth++);
    }
    if (const auto* x = std::get_if<UltrasonicScan>(&o)) {
      EXPECT_EQ(x->stamp.seq, scans++);
      ASSERT_TRUE(std::holds_alternative<GroundTruth>(r.all[i - 1]));
      EXPECT_EQ(utime(r.all[i - 1]), utime(o));
      EXPECT_EQ(x->beams.size(), 60u);
    }
  }
}

TEST(Simulator, PinnedRunHas134StopsAndTheDurationOfItsParts) {
  const WorldParameters world = test::heptagon();
  const RobotParameters robot = test::paper002();
  const Recording r = record(robot, 1);
  ASSERT_EQ(r.scans.size(), 10u + 133u);

  double way = 0.0, turning = 0.0, heading = 0.0;
  Vector2 at = world.path.start.position();
  for (int loop = 0; loop < 2; ++loop) {
    for (const Vector2& place : world.path.waypoints) {
      const Vector2 leg = place - at;
      if (leg.norm() == 0.0) continue;
      way += leg.norm();
      const double bearing = std::atan2(leg.y(), leg.x());
      turning += std::abs(wrap(bearing - heading));
      heading = bearing;
      at = place;
    }
  }
  EXPECT_EQ(std::ceil(way / 0.12), 133.0);
  const double duration = 143 * 60 * 0.06 + way / robot.drive.speed + turning / robot.drive.turn_rate;
  EXPECT_NEAR(seconds(r.scans.back().stamp.utime), duration, 2e-6);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(r.scans[i].stamp.utime, 3600000 * (i + 1));
}

TEST(Simulator, FirstLegNeedsNoTurn) {
  const Recording r = record(test::paper002(), 1);
  for (std::size_t i = 0; r.truth[i].base_in_map.x < 1.5; ++i) EXPECT_EQ(r.truth[i].base_in_map.yaw, 0.0);
}

TEST(Simulator, StopsAreTheSpacingApartAlongTheWay) {
  const Recording r = record(test::paper002(), 1);
  double way = 0.0;
  int stops = 0;
  Pose2 last;
  for (const Observation& o : r.all) {
    if (const auto* t = std::get_if<GroundTruth>(&o)) {
      way += (t->base_in_map.position() - last.position()).norm();
      last = t->base_in_map;
    }
    if (std::holds_alternative<UltrasonicScan>(o) && way > 0.0 && stops < 132) {
      EXPECT_NEAR(way, 0.12 * ++stops, 1e-9);
    }
  }
  EXPECT_EQ(stops, 132);
  EXPECT_LT(last.position().norm(), 1e-12);  // the path ends where it began
}

TEST(Simulator, OdometryComesAtTheRateWhileMoving) {
  const Recording r = record(test::paper002(), 1);
  for (std::size_t i = 1; i < r.all.size(); ++i) {
    if (std::holds_alternative<Odometry>(r.all[i])) {
      EXPECT_LE(utime(r.all[i]) - utime(r.all[i - 1]), 100001);
    }
  }
}

TEST(Simulator, OdometryFreeOfNoiseIntegratesToTheTruth) {
  for (const DriveModel model : {DriveModel::turn_and_go, DriveModel::front_axle}) {
    RobotParameters robot = test::paper002();
    robot.drive.model = model;
    robot.odometry = {0.0, 0.0, 0.0};
    const Recording r = record(robot, 1);
    Pose2 pose;
    for (std::size_t i = 0; i < r.all.size(); ++i) {
      if (const auto* o = std::get_if<Odometry>(&r.all[i])) {
        pose = pose * o->increment;
        EXPECT_TRUE(o->covariance.isZero());
      }
      if (const auto* t = std::get_if<GroundTruth>(&r.all[i])) {
        ASSERT_LT(difference(pose, t->base_in_map).norm(), 1e-12);
      }
    }
  }
}

TEST(Simulator, SameSeedSameRunOtherSeedSameTruth) {
  const Recording a = record(test::paper002(), 7), b = record(test::paper002(), 7), c = record(test::paper002(), 8);
  EXPECT_TRUE(all_equal(a.odometry, b.odometry));
  EXPECT_TRUE(all_equal(a.scans, b.scans));
  EXPECT_TRUE(all_equal(a.truth, c.truth));
  EXPECT_FALSE(all_equal(a.odometry, c.odometry));
  EXPECT_FALSE(all_equal(a.scans, c.scans));
}

TEST(Simulator, SensorsDrawFromStreamsOfTheirOwn) {
  const RobotParameters robot = test::paper002();
  const Recording reference = record(robot, 3);

  RobotParameters changed = robot;  // odometry does not touch the ranges
  changed.odometry.distance = 0.2;
  EXPECT_TRUE(all_equal(record(changed, 3).scans, reference.scans));

  changed = robot;  // nor the sonar the odometry
  changed.sonar.noise.base = 0.01;
  changed.sonar.outliers = 0.3;
  EXPECT_TRUE(all_equal(record(changed, 3).odometry, reference.odometry));
}

TEST(Simulator, OneEffectOfTheSonarDoesNotShiftAnother) {
  RobotParameters robot = test::paper002();
  robot.sonar.quantisation = 0.0;
  robot.sonar.min_range = 0.0;
  robot.sonar.max_range = 8.0;  // nothing is dropped
  const Recording reference = record(robot, 3);
  RobotParameters changed = robot;
  changed.sonar.outliers = 0.2;
  const Recording outliers = record(changed, 3);
  changed = robot;
  changed.sonar.hit.peak = 0.7;
  const Recording deaf = record(changed, 3);
  int same = 0, other = 0, lost = 0, heard = 0;
  for (std::size_t i = 0; i < reference.scans.size(); ++i) {
    for (std::size_t k = 0; k < 60; ++k) {
      const UltrasonicBeam& beam = reference.scans[i].beams[k];
      const UltrasonicBeam& wrong = outliers.scans[i].beams[k];
      EXPECT_EQ(beam.echo == Echo::none, wrong.echo == Echo::none);  // who hears is drawn apart from what is heard
      if (beam.echo == Echo::hit && wrong.echo == Echo::hit) ++(beam.range == wrong.range ? same : other);
      const UltrasonicBeam& quiet = deaf.scans[i].beams[k];
      if (beam.echo != Echo::hit) continue;
      ++heard;
      if (quiet.echo != Echo::hit) ++lost;
    }
  }
  EXPECT_NEAR(other / double(same + other), 0.18, 0.04);
  EXPECT_NEAR(lost / double(heard), 1.0 - 0.7 / 0.98, 0.05);
}

TEST(Simulator, AddedRangerLeavesTheOthersAsTheyWere) {
  RobotParameters robot = test::paper002();
  robot.sonar.mounting = Mounting::fixed;
  for (int i = 0; i < 12; ++i) robot.sonar.mounts.push_back({Pose2{0.05, 0.0, radians(30.0 * i)}});
  WorldParameters world = test::heptagon();
  world.path.waypoints.resize(4);
  world.path.loops = 1;
  const Recording twelve = record(robot, 1, world);
  robot.sonar.mounts.push_back({Pose2{-0.05, 0.0, kPi}});
  const Recording thirteen = record(robot, 1, world);
  for (std::size_t i = 0; i < twelve.scans.size(); ++i) {
    for (std::size_t k = 0; k < 12; ++k) {
      // The noise schedule counts time, and thirteen pings take longer; the first scans are in the first third.
      if (i < 5) {
        EXPECT_EQ(twelve.scans[i].beams[k].range, thirteen.scans[i].beams[k].range);
      }
      EXPECT_EQ(twelve.scans[i].beams[k].sensor_in_base, thirteen.scans[i].beams[k].sensor_in_base);
    }
  }
  EXPECT_EQ(twelve.scans[0].stamp.utime, 12 * 60000);
  EXPECT_EQ(thirteen.scans[0].stamp.utime, 13 * 60000);
}

TEST(Simulator, ParallelFiringTakesOnePingAndHearsCrosstalk) {
  RobotParameters robot = test::paper002();
  robot.sonar.mounting = Mounting::fixed;
  for (int i = 0; i < 8; ++i)
    robot.sonar.mounts.push_back({Pose2{0.0, 0.0, radians(45.0 * i)} * Pose2{0.08, 0.0, 0.0}});
  robot.sonar.half_angle = radians(30);
  robot.sonar.outliers = 0.0;
  const Recording in_turn = record(robot, 1);
  robot.sonar.firing = Firing::parallel;
  const Recording parallel = record(robot, 1);
  EXPECT_EQ(parallel.scans[0].stamp.utime, 60000);
  const auto hits = [](const Recording& r) {
    std::ptrdiff_t n = 0;
    for (const auto& s : r.scans) n += std::ranges::count(s.beams, Echo::hit, &UltrasonicBeam::echo);
    return n;
  };
  EXPECT_GT(100 * hits(parallel), 102 * hits(in_turn));
}

TEST(Simulator, KnowsItsWorld) {
  const Simulator simulator(test::heptagon(), test::paper002(), 1);
  EXPECT_EQ(simulator.world().name, "heptagon");
  ASSERT_TRUE(simulator.world().room.has_value());
  EXPECT_EQ(simulator.world().room->walls.size(), 7u);
  EXPECT_EQ(simulator.world().room->walls[6].name, "7");
  EXPECT_EQ(simulator.world().room->cylinders[0].name, "1");
  EXPECT_EQ(simulator.world().start_in_map, Pose2{});
  EXPECT_TRUE(simulator.world().landmarks.empty());
}

TEST(Simulator, RobotWithoutWaypointsListensWhereItStands) {
  WorldParameters world = test::heptagon();
  world.path.waypoints.clear();
  const Recording r = record(test::paper002(), 1, world);
  EXPECT_EQ(r.scans.size(), 10u);
  EXPECT_TRUE(r.odometry.empty());
}

TEST(Simulator, RangesAreWithinTheLimitsAndQuantised) {
  for (const UltrasonicScan& scan : record(test::paper002(), 5).scans) {
    for (const UltrasonicBeam& b : scan.beams) {
      if (b.echo != Echo::hit) {
        EXPECT_EQ(b.range, 0.0);
        continue;
      }
      EXPECT_GE(b.range, 0.02);
      EXPECT_LE(b.range, 4.0);
      EXPECT_NEAR(b.range / 0.003, std::round(b.range / 0.003), 1e-9);
    }
  }
}

TEST(Simulator, FrontAxleDrivePassesNearEveryWaypoint) {
  WorldParameters world = test::heptagon();
  RobotParameters robot = test::paper002();
  robot.drive.model = DriveModel::front_axle;
  const Recording r = record(robot, 1, world);
  for (const Vector2& place : world.path.waypoints) {
    const double nearest = std::transform_reduce(
        r.truth.begin(), r.truth.end(), 1e9, [](double a, double b) { return std::min(a, b); },
        [&](const GroundTruth& t) { return (t.base_in_map.position() - place).norm(); });
    EXPECT_LT(nearest, robot.drive.waypoint_radius + robot.drive.speed / robot.drive.odometry_rate);
  }
  // The steering limits the curvature: |dyaw| <= way sin(max_steering) / wheelbase.
  for (std::size_t i = 1; i < r.truth.size(); ++i) {
    const Pose2 step = between(r.truth[i - 1].base_in_map, r.truth[i].base_in_map);
    EXPECT_LE(std::abs(step.yaw), step.position().norm() * 0.5 / 0.12 + 1e-12);
  }
}

}  // namespace
}  // namespace noctule::sim
