#include "modules/posed_scans.hpp"

#include <gtest/gtest.h>

namespace noctule::modules {
namespace {

using Between = Trajectory::Between;

Trajectory two_poses(Between between) {
  Trajectory t(between);
  t.add(100'000, {0.0, 0.0, 0.0});
  t.add(200'000, {1.0, 0.0, 0.5});
  return t;
}

TEST(Trajectory, BetweenKnownPoses) {
  EXPECT_FALSE(two_poses(Between::nothing).at(150'000));
  EXPECT_EQ(two_poses(Between::hold).at(150'000), (Pose2{0.0, 0.0, 0.0}));
  const auto pose = two_poses(Between::linear).at(150'000);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x, 0.5, 1e-12);
  EXPECT_NEAR(pose->yaw, 0.25, 1e-12);
}

TEST(Trajectory, AtKnownPosesAndOutside) {
  for (const Between between : {Between::nothing, Between::hold, Between::linear}) {
    const Trajectory t = two_poses(between);
    EXPECT_FALSE(t.at(99'999));
    EXPECT_EQ(t.at(200'000).value().x, 1.0);
    EXPECT_EQ(t.at(300'000).has_value(), between == Between::hold);
  }
}

TEST(Trajectory, LinearDoesNotBridgeGaps) {
  Trajectory t(Between::linear);
  t.add(0, {});
  t.add(1'000'000, {1.0, 0.0, 0.0});
  EXPECT_FALSE(t.at(500'000));
}

TEST(Trajectory, OdometryMovesTheLatestPose) {
  Trajectory t(Between::hold);
  const Pose2 start{1.0, 2.0, kPi / 2.0};
  Odometry forward;
  forward.increment.x = 0.5;
  forward.stamp.utime = 10;
  t.move(forward, start);
  forward.stamp.utime = 20;
  t.move(forward, start);
  EXPECT_NEAR(t.at(15).value().y, 2.5, 1e-12);
  EXPECT_NEAR(t.at(20).value().y, 3.0, 1e-12);
  EXPECT_NEAR(t.at(20).value().x, 1.0, 1e-12);
}

TEST(Trajectory, OldPosesAreIgnoredEqualTimesReplace) {
  Trajectory t = two_poses(Between::nothing);
  t.add(150'000, {9.0, 9.0, 0.0});
  EXPECT_EQ(t.poses().size(), 2u);
  t.add(200'000, {2.0, 0.0, 0.0});
  EXPECT_EQ(t.at(200'000).value().x, 2.0);
  t.begin(0, {5.0, 5.0, 0.0});
  EXPECT_EQ(t.poses().size(), 2u);
}

TEST(PosedScans, LeavesOutScansWithoutPose) {
  std::vector<UltrasonicScan> scans(3);
  scans[0].stamp = {100'000, 0};
  scans[1].stamp = {150'000, 1};
  scans[2].stamp = {200'000, 2};
  const auto posed = posed_scans(scans, two_poses(Between::nothing));
  ASSERT_EQ(posed.size(), 2u);
  EXPECT_EQ(posed[1].scan.stamp.seq, 2);
  EXPECT_EQ(posed[1].base_in_map.x, 1.0);
}

}  // namespace
}  // namespace noctule::modules
