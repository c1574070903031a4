#include "eval/room_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/rng.hpp"

namespace noctule::eval {
namespace {

const Vector2 kPlace{1.4, 3.0};

/// An L of 5 by 4 m about kPlace; wall 3 is behind the corner for a ranger there.
Room l_room() {
  Room room;
  room.walls = {{"south", {0.0, -kPi / 2.0}, 0.0, 3.0},  {"east", {3.0, 0.0}, 0.0, 4.0},
                {"north", {4.0, kPi / 2.0}, -3.0, 2.0},  {"west", {2.0, -kPi}, -4.0, -2.0},
                {"step", {-2.0, -kPi / 2.0}, -2.0, 0.0}, {"inner west", {0.0, -kPi}, -2.0, 0.0}};
  return room;
}

/// The room's audible walls as they look after `map_T_room`.
ContourMap map_of(const Room& room, const Pose2& map_T_room) {
  ContourMap map;
  for (const int i : audible_walls(room, {&kPlace, 1})) {
    WallEstimate& w = map.walls.emplace_back();
    w.wall = normalised(transformed(map_T_room, room.walls[static_cast<std::size_t>(i)].wall));
  }
  return map;
}

TEST(AudibleWalls, AreThoseWhoseFootLiesOnThemInSight) {
  const Room room = l_room();
  EXPECT_EQ(audible_walls(room, {&kPlace, 1}), (std::vector<int>{0, 1, 2, 3}));
  const Vector2 low{1.4, 1.0};  // the inner wall hides nothing here: it is the one to the west
  EXPECT_EQ(audible_walls(room, {&low, 1}), (std::vector<int>{0, 1, 2, 5}));
  Room screened = room;
  screened.walls.push_back({"screen", {2.0, 0.0}, 2.5, 3.5});
  EXPECT_EQ(audible_walls(screened, {&kPlace, 1}), (std::vector<int>{0, 2, 3, 6}));
  const std::vector<Vector2> both{kPlace, low};
  EXPECT_EQ(audible_walls(room, both), (std::vector<int>{0, 1, 2, 3, 5}));
}

TEST(AlignWalls, RecoversAnyRigidMotion) {
  Rng rng(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose2 motion{rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), rng.uniform(-1.4, 1.4)};
    std::vector<std::pair<Wall, Wall>> pairs;
    for (const double theta : {0.1, 1.3, 2.9, -2.0}) {
      const Wall estimate{rng.uniform(0.5, 4.0), theta + rng.uniform(-0.2, 0.2)};
      pairs.emplace_back(estimate, normalised(transformed(motion, estimate)));
    }
    const auto found = align_walls(pairs);
    ASSERT_TRUE(found);
    EXPECT_LT(difference(*found, motion).norm(), 1e-12);
  }
}

TEST(AlignWalls, IsSilentWhereTheWallsLeaveADirectionOpen) {
  const Wall east{2.0, 0.0}, west{1.0, kPi}, nearly{3.0, radians(5.0)};
  EXPECT_FALSE(align_walls({}));
  EXPECT_FALSE(align_walls(std::vector<std::pair<Wall, Wall>>{{east, east}}));
  EXPECT_FALSE(align_walls(std::vector<std::pair<Wall, Wall>>{{east, east}, {west, west}, {nearly, nearly}}));
}

TEST(AlignToRoom, FindsAllOfAnExactMapWithoutError) {
  const Room room = l_room();
  const Pose2 room_T_map{0.12, -0.2, radians(8.0)};
  ContourMap map = map_of(room, inverse(room_T_map));
  map.walls.push_back({.wall = {1.0, radians(40.0)}});
  const Vector2 place = inverse(room_T_map) * kPlace;
  const RoomAlignment result = align_to_room(map, room, {&place, 1});
  EXPECT_EQ(result.found, 4);
  EXPECT_EQ(result.scored, 4);
  EXPECT_DOUBLE_EQ(result.recall, 1.0);
  EXPECT_EQ(result.invented_walls, std::vector<int>{4});
  EXPECT_LT(difference(result.room_T_map, room_T_map).norm(), 1e-12);
  EXPECT_LT(result.median_rho, 1e-12);
  EXPECT_LT(result.median_theta, 1e-12);
}

TEST(AlignToRoom, TheScoredWallIsLeftOutOfItsAlignment) {
  const Room room = l_room();
  const Pose2 room_T_map{0.05, 0.1, radians(-4.0)};
  const Vector2 place = inverse(room_T_map) * kPlace;
  for (std::size_t k = 0; k < 4; ++k) {
    ContourMap map = map_of(room, inverse(room_T_map));
    // Farther from the ranger and turned about the foot of the perpendicular.
    const double farther = 0.1, turn = radians(3.0);
    const Wall exact = map.walls[k].wall;
    const double distance = exact.distance(place);
    Wall moved{0.0, exact.theta + turn};
    moved.rho = moved.normal().dot(place) + distance + std::copysign(farther, distance);
    map.walls[k].wall = moved;
    const RoomAlignment result = align_to_room(map, room, {&place, 1});
    ASSERT_EQ(result.scored, 4);
    for (std::size_t i = 0; i < 4; ++i) {
      if (i == k) {
        EXPECT_NEAR(std::abs(result.walls[i].rho), farther, 1e-9) << k;
        EXPECT_NEAR(result.walls[i].theta, turn, 1e-9) << k;
      } else {
        EXPECT_GT(std::abs(result.walls[i].theta), radians(0.9)) << k;  // a third of it is in their alignments
      }
    }
  }
}

TEST(AlignToRoom, ScoresDoNotDependOnTheOrigin) {
  const Room room = l_room();
  ContourMap map = map_of(room, {0.05, -0.05, radians(2.0)});
  for (std::size_t i = 0; i < map.walls.size(); ++i) map.walls[i].wall.theta += radians(i % 2 == 0 ? 3.0 : -2.0);
  const RoomAlignment near = align_to_room(map, room, {&kPlace, 1});

  const Pose2 shift{30.0, -20.0, 0.0};
  Room far_room = room;
  for (RoomWall& w : far_room.walls) {
    const double moved = w.wall.tangent().dot(shift.position());
    w.wall = transformed(shift, w.wall);
    w.begin += moved;
    w.end += moved;
  }
  for (WallEstimate& w : map.walls) w.wall = transformed(shift, w.wall);
  const Vector2 far_place = shift * kPlace;
  const RoomAlignment far = align_to_room(map, far_room, {&far_place, 1});
  ASSERT_EQ(near.scored, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(near.walls[i].rho, far.walls[i].rho, 1e-9);
    EXPECT_NEAR(near.walls[i].theta, far.walls[i].theta, 1e-9);
  }
}

TEST(AlignToRoom, MissesWhatIsNotThereAndScoresNothingWithoutAnAlignment) {
  const Room room = l_room();
  ContourMap map = map_of(room, {});
  map.walls.resize(2);  // south and east: alone, neither can align the other
  const RoomAlignment two = align_to_room(map, room, {&kPlace, 1});
  EXPECT_EQ(two.found, 2);
  EXPECT_EQ(two.scored, 0);
  EXPECT_DOUBLE_EQ(two.recall, 0.5);
  EXPECT_TRUE(std::isnan(two.median_rho));

  const Vector2 outside{100.0, 100.0};
  const RoomAlignment none = align_to_room(map, room, {&outside, 1});
  EXPECT_TRUE(std::isnan(none.recall));
  EXPECT_EQ(none.invented_walls.size(), 2U);
}

TEST(AlignToRoom, GivesErrorsForTheReport) {
  const Room room = l_room();
  ContourMap map = map_of(room, {});
  map.walls.push_back({.wall = {1.0, radians(40.0)}});
  map.walls[1].wall.theta += radians(4.0);  // east
  const RoomAlignment alignment = align_to_room(map, room, {&kPlace, 1});
  const ContourErrors errors = contour_errors(alignment);
  ASSERT_EQ(errors.walls.size(), 4U);
  EXPECT_EQ(errors.walls_found(), 4);
  EXPECT_EQ(errors.invented_walls, std::vector<int>{4});
  EXPECT_EQ(errors.walls[1].name, "east");
  EXPECT_EQ(errors.walls[1].truth.rho, 3.0);
  EXPECT_NEAR(errors.walls[1].theta, radians(4.0), 1e-9);
  double sum = 0.0;
  for (const AlignedWall& w : alignment.walls) sum += std::abs(w.theta);
  EXPECT_NEAR(errors.other_walls.theta, sum / 4.0, 1e-12);

  map.walls.resize(2);
  const ContourErrors unscored = contour_errors(align_to_room(map, room, {&kPlace, 1}));
  EXPECT_EQ(unscored.walls_found(), 2);
  EXPECT_EQ(unscored.walls_missed(), 2);
  EXPECT_TRUE(unscored.walls[0].found() && std::isnan(unscored.walls[0].rho));
  EXPECT_TRUE(std::isnan(unscored.other_walls.rho));
}

TEST(AlignToRoom, RefusesWhatMakesNoSense) {
  const Room room = l_room();
  EXPECT_THROW((void)align_to_room({}, room, {}), std::invalid_argument);
  EXPECT_THROW((void)align_to_room({}, room, {&kPlace, 1}, {.rho_gate = 0.0}), std::invalid_argument);
  EXPECT_THROW((void)align_to_room({}, room, {&kPlace, 1}, {.theta_gate = -1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::eval
