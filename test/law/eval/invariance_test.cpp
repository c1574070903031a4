/// Laws of the measures: what must not change a figure, does not.
#include <gtest/gtest.h>

#include <cmath>

#include "core/rng.hpp"
#include "eval/contour_error.hpp"
#include "eval/published_contours.hpp"
#include "eval/trajectory.hpp"

namespace noctule::eval {
namespace {

std::vector<PosePair> noisy_pairs(std::uint64_t seed) {
  Rng rng(seed);
  std::vector<PosePair> pairs;
  Pose2 truth{0.3, -1.2, 0.7};
  for (int i = 0; i < 80; ++i) {
    truth = truth * Pose2{0.1, 0.0, rng.normal(0.02, 0.1)};
    const Pose2 noise{rng.normal(0, 0.05), rng.normal(0, 0.05), rng.normal(0, 0.1)};
    pairs.push_back({i * 100'000, truth * noise, truth});
  }
  return pairs;
}

TEST(TrajectoryLaws, ErrorsSurviveACommonRigidMotion) {
  const std::vector<PosePair> pairs = noisy_pairs(3);
  std::vector<PosePair> moved = pairs;
  const Pose2 motion{-7.0, 2.5, 2.1};
  for (PosePair& p : moved) p = {p.utime, motion * p.estimate, motion * p.truth};
  EXPECT_NEAR(pose_errors(moved).position_rmse, pose_errors(pairs).position_rmse, 1e-12);
  EXPECT_NEAR(pose_errors(moved).heading_rmse, pose_errors(pairs).heading_rmse, 1e-12);
  for (const Alignment a : {Alignment::none, Alignment::rigid, Alignment::similarity}) {
    EXPECT_NEAR(absolute_trajectory_error(moved, a), absolute_trajectory_error(pairs, a), 1e-12);
  }
}

TEST(TrajectoryLaws, AlignedAndRelativeErrorsSurviveAMotionOfTheEstimate) {
  const std::vector<PosePair> pairs = noisy_pairs(4);
  std::vector<PosePair> moved = pairs;
  const Pose2 motion{3.0, -4.0, -2.6};
  for (PosePair& p : moved) p.estimate = motion * p.estimate;
  const double ate = absolute_trajectory_error(pairs, Alignment::rigid);
  EXPECT_NEAR(absolute_trajectory_error(moved, Alignment::rigid), ate, 1e-12);
  EXPECT_LE(ate, pose_errors(pairs).position_rmse);
  EXPECT_LE(absolute_trajectory_error(pairs, Alignment::similarity), ate);

  const auto segments = segments_by_length(pairs, 1.0);
  const RelativePoseErrors before = relative_pose_errors(pairs, segments);
  const RelativePoseErrors after = relative_pose_errors(moved, segments);
  EXPECT_GT(before.segments, 60);
  EXPECT_NEAR(after.translation_rmse, before.translation_rmse, 1e-12);
  EXPECT_NEAR(after.rotation_rmse, before.rotation_rmse, 1e-12);
}

TEST(TrajectoryLaws, NeesSurvivesARotationOfTheFrame) {
  Matrix3 covariance;
  covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  const Pose2 truth{1, 2, 3.0}, estimate{1.1, 1.8, -3.1};
  const Pose2 motion{0, 0, 1.3};
  Matrix3 turn = Matrix3::Identity();
  turn.topLeftCorner<2, 2>() << std::cos(1.3), -std::sin(1.3), std::sin(1.3), std::cos(1.3);
  EXPECT_NEAR(nees(motion * estimate, turn * covariance * turn.transpose(), motion * truth),
              nees(estimate, covariance, truth), 1e-10);
}

TEST(ContourLaws, RotationAboutTheOriginLeavesRotationFreeErrors) {
  const Room& room = published_room();
  Rng rng(9);
  ContourMap map;
  for (const RoomWall& w : room.walls) {
    map.walls.push_back({.wall = {w.wall.rho + rng.normal(0, 0.01), w.wall.theta + rng.normal(0, 0.02)}});
  }
  const ContourErrors before = contour_errors(map, room);
  for (WallEstimate& w : map.walls) w.wall.theta += 0.05;
  const ContourErrors after = contour_errors(map, room);
  EXPECT_NEAR(after.common_rotation, before.common_rotation + 0.05, 1e-12);
  EXPECT_NEAR(after.all_walls.theta_rotation_free, before.all_walls.theta_rotation_free, 1e-12);
  EXPECT_NEAR(after.all_walls.rho, before.all_walls.rho, 1e-12);
}

TEST(ContourLaws, MovingMapAndRoomTogetherKeepsTheAssociation) {
  const Room& room = published_room();
  const Pose2 motion{0.2, -0.1, 0.8};  // small enough to keep the origin inside
  Room moved_room = room;
  ContourMap map, moved_map;
  Rng rng(12);
  for (RoomWall& w : moved_room.walls) {
    const Wall estimate{w.wall.rho + rng.normal(0, 0.02), w.wall.theta + rng.normal(0, 0.02)};
    map.walls.push_back({.wall = estimate});
    moved_map.walls.push_back({.wall = normalised(transformed(motion, estimate))});
    w.wall = transformed(motion, w.wall);
  }
  for (RoomCylinder& c : moved_room.cylinders) {
    const Cylinder estimate{c.cylinder.centre + Vector2(rng.normal(0, 0.02), rng.normal(0, 0.02)), 0.11};
    map.cylinders.push_back({.cylinder = estimate});
    moved_map.cylinders.push_back({.cylinder = {motion * estimate.centre, estimate.radius}});
    c.cylinder.centre = motion * c.cylinder.centre;
  }
  const ContourErrors a = contour_errors(map, room), b = contour_errors(moved_map, moved_room);
  for (std::size_t i = 0; i < a.walls.size(); ++i) {
    EXPECT_EQ(a.walls[i].estimate, b.walls[i].estimate);
    EXPECT_NEAR(a.walls[i].theta, b.walls[i].theta, 1e-12);
  }
  EXPECT_NEAR(a.cylinder_mae_radius, b.cylinder_mae_radius, 1e-12);
  EXPECT_NEAR(a.cylinders[1].centre.norm(), b.cylinders[1].centre.norm(), 1e-12);
}

}  // namespace
}  // namespace noctule::eval
