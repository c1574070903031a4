/// Maps are made with the poses that the mapper was told to use.
#include "modules/mapper_module.hpp"

#include <gtest/gtest.h>

#include "heard.hpp"
#include "noctule/contour_errors.hpp"
#include "noctule/contour_map.hpp"
#include "noctule/ground_truth.hpp"
#include "noctule/odometry.hpp"
#include "noctule/path_estimate.hpp"
#include "noctule/slam_estimate.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::modules {
namespace {

constexpr int kStops = 15;
constexpr double kStep = 0.12;

std::int64_t utime_of(int stop) {
  return 1'000'000 * (stop + 1);
}

Pose2 pose_of(int stop) {
  return {kStep * stop, 0.0, 0.0};
}

/// A wall along the way, 1 m to the left.
UltrasonicScan scan_at(int stop) {
  UltrasonicScan scan;
  scan.stamp = {utime_of(stop), stop};
  scan.half_angle = radians(15.0);
  scan.min_range = 0.02;
  scan.max_range = 4.0;
  for (const double axis : {84.0, 90.0, 96.0}) scan.beams.push_back({{0.0, 0.0, radians(axis)}, 1.0, Echo::hit});
  return scan;
}

Room room() {
  return {{{"left", {1.0, kPi / 2.0}, -2.0, 1.0}}, {}};
}

class MapperModuleTest : public ::testing::Test {
 protected:
  std::unique_ptr<MapperModule> mapper(PoseSource poses) {
    return std::make_unique<MapperModule>(bus_, MapperModuleParameters{}, MapperRole{poses, Pose2{}, room()});
  }
  template <class Value>
  void send(const char* channel, const Value& value) {
    bus_.publish(channel, convert::to_message(value));
    bus_.drain();
  }
  void send_poses(int stop) {
    Odometry o;
    o.stamp = {utime_of(stop), stop};
    o.increment.x = stop == 0 ? 0.0 : kStep;
    send("ODOMETRY", o);
    send("GROUND_TRUTH", GroundTruth{{utime_of(stop), stop}, pose_of(stop)});
  }
  void send_estimate(int stop) {
    SlamEstimate estimate;
    estimate.stamp = {utime_of(stop), stop};
    estimate.pose = pose_of(stop);
    estimate.particles = 1;
    estimate.effective_sample_size = 1.0;
    estimate.distinct_particles = estimate.distinct_ancestors = 1;
    send("SLAM_ESTIMATE", estimate);
  }
  void drive() {
    for (int stop = 0; stop < kStops; ++stop) {
      send_poses(stop);
      send("ULTRASONIC_SCAN", scan_at(stop));
      send_estimate(stop);
    }
  }
  void send_path(const Pose2& moved_by) {
    PathEstimate path;
    path.stamp.utime = utime_of(kStops - 1);
    for (int stop = 0; stop < kStops; ++stop) path.poses.push_back({stop, utime_of(stop), moved_by * pose_of(stop)});
    send("SLAM_PATH", path);
  }
  static void expect_wall(const contour_map& map, double rho) {
    ASSERT_EQ(map.wall_count, 1);
    EXPECT_NEAR(map.walls[0].rho_m, rho, 0.005);
    EXPECT_NEAR(map.walls[0].theta_rad, kPi / 2.0, 0.01);
  }

  bus::Bus bus_;
  Heard<contour_map> maps_{bus_, "CONTOUR_MAP"};
  Heard<contour_map> known_pose_{bus_, "CONTOUR_MAP_KNOWN_POSE"};
  Heard<contour_map> dead_reckoning_{bus_, "CONTOUR_MAP_DEAD_RECKONING"};
  Heard<contour_errors> errors_{bus_, "CONTOUR_ERRORS"};
  Heard<module_status> statuses_{bus_, "MODULE_STATUS"};
};

TEST_F(MapperModuleTest, EverySourceOfPosesHasItsChannel) {
  const auto slam = mapper(PoseSource::slam), truth = mapper(PoseSource::ground_truth),
             odometry = mapper(PoseSource::odometry);
  drive();
  send_path({});
  for (Module* module : {slam.get(), truth.get(), odometry.get()}) module->finish();
  bus_.drain();
  for (const auto* heard : {&maps_, &known_pose_, &dead_reckoning_}) {
    ASSERT_FALSE(heard->all.empty());
    expect_wall(heard->all.back(), 1.0);
    EXPECT_EQ(heard->all.back().utime, utime_of(kStops - 1));
  }
}

TEST_F(MapperModuleTest, TheFinalMapIsMadeOnTheFinalPath) {
  const auto slam = mapper(PoseSource::slam);
  drive();
  ASSERT_GT(maps_.all.size(), 1u) << "maps while running";
  expect_wall(maps_.all.back(), 1.0);
  send_path({0.0, 0.25, 0.0});
  slam->finish();
  bus_.drain();
  expect_wall(maps_.all.back(), 1.25);
}

TEST_F(MapperModuleTest, ErrorsAgainstTheKnownRoom) {
  const auto slam = mapper(PoseSource::slam);
  drive();
  send_path({0.0, 0.02, 0.0});
  slam->finish();
  bus_.drain();
  const contour_errors& errors = errors_.all.back();
  EXPECT_EQ(errors.walls_found, 1);
  EXPECT_EQ(errors.walls_invented, 0);
  ASSERT_EQ(errors.wall_count, 1);
  EXPECT_NEAR(errors.walls[0].d_rho_m, 0.02, 0.005);
  EXPECT_EQ(errors.walls[0].name, "left");
  EXPECT_EQ(errors_.all.size(), maps_.all.size());
}

TEST_F(MapperModuleTest, ScansWithoutPoseAreLeftOutAndTold) {
  const auto slam = mapper(PoseSource::slam);
  drive();
  send("ULTRASONIC_SCAN", scan_at(kStops));
  send_path({});
  slam->finish();
  bus_.drain();
  expect_wall(maps_.all.back(), 1.0);
  EXPECT_NE(statuses_.all.back().warning.find("1 of 16 scans have no pose"), std::string::npos);
}

TEST_F(MapperModuleTest, NothingIsSaidWhereNothingWasHeard) {
  const auto truth = mapper(PoseSource::ground_truth), odometry = mapper(PoseSource::odometry);
  send("ULTRASONIC_SCAN", scan_at(0));
  truth->finish();
  bus_.drain();
  EXPECT_TRUE(known_pose_.all.empty()) << "no truth, no map with known poses";
}

}  // namespace
}  // namespace noctule::modules
