#include "eval/contour_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/limits.hpp"
#include "core/rng.hpp"
#include "eval/published_contours.hpp"

namespace noctule::eval {
namespace {

ContourMap exact_map(const Room& room) {
  ContourMap map;
  for (const RoomWall& w : room.walls) {
    WallEstimate estimate;
    estimate.wall = w.wall;
    map.walls.push_back(estimate);
  }
  for (const RoomCylinder& c : room.cylinders) {
    CylinderEstimate estimate;
    estimate.cylinder = c.cylinder;
    map.cylinders.push_back(estimate);
  }
  return map;
}

/// The printed columns lie so far from the truth that some of the PF's walls miss the gate: pair them without one.
ContourErrors published_errors(std::size_t method) {
  return contour_errors(published_contours()[method].map, published_room(), {.wall_gate = kInf});
}

double reduction_percent(double error, double reference) {
  return 100.0 * (1.0 - error / reference);
}

TEST(PublishedContours, DefinitionsReproduceThePapersReductions) {
  const ContourErrors pf = published_errors(0), vb = published_errors(1), apf = published_errors(2);
  for (const auto* e : {&pf, &vb, &apf}) {
    for (int i = 0; i < 7; ++i) EXPECT_EQ(e->walls[static_cast<std::size_t>(i)].estimate, i);
  }
  EXPECT_NEAR(100 * pf.other_walls.rho, 8.614, 5e-4);
  EXPECT_NEAR(100 * vb.other_walls.rho, 4.969, 5e-4);
  EXPECT_NEAR(100 * apf.other_walls.rho, 2.057, 5e-4);
  EXPECT_NEAR(degrees(pf.other_walls.theta), 3.777, 5e-4);
  EXPECT_NEAR(degrees(vb.other_walls.theta), 2.603, 6e-4);
  EXPECT_NEAR(degrees(apf.other_walls.theta), 2.124, 6e-4);
  EXPECT_NEAR(reduction_percent(apf.other_walls.rho, pf.other_walls.rho), 76.12, 5e-3);
  EXPECT_NEAR(reduction_percent(apf.other_walls.rho, vb.other_walls.rho), 58.60, 5e-3);
  EXPECT_NEAR(reduction_percent(apf.cylinders[1].mean_absolute(), pf.cylinders[1].mean_absolute()), 58.22, 5e-3);
  EXPECT_NEAR(reduction_percent(apf.cylinders[1].mean_absolute(), vb.cylinders[1].mean_absolute()), 42.15, 5e-3);
  EXPECT_NEAR(100 * pf.cylinders[0].mean_absolute(), 1.5184, 5e-5);
  EXPECT_NEAR(100 * apf.cylinders[0].mean_absolute(), 0.4271, 1e-4);  // its |dx| is printed 0.0001 too large
}

TEST(PublishedContours, RoomIsTheHeptagonOfItsVertices) {
  const Room& room = published_room();
  const double lengths[] = {2.6536, 1.8928, 0.8258, 0.8928, 2.4273, 1.2356, 2.2386};
  ASSERT_EQ(room.walls.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(room.walls[i].end - room.walls[i].begin, lengths[i], 6e-5) << i;
  EXPECT_TRUE(same_contours(room, published_room()));
  Room other = room;
  other.walls[3].wall.theta += 1e-3;
  EXPECT_FALSE(same_contours(room, other));
  other = room;
  other.cylinders.pop_back();
  EXPECT_FALSE(same_contours(room, other));
}

TEST(ContourErrors, ExactMapHasNone) {
  const Room& room = published_room();
  const ContourErrors e = contour_errors(exact_map(room), room);
  EXPECT_TRUE(e.complete());
  EXPECT_EQ(e.walls_found(), 7);
  EXPECT_EQ(e.other_walls.found, 6);
  EXPECT_EQ(e.all_walls.rho, 0.0);
  EXPECT_EQ(e.cylinder_mae, 0.0);
}

TEST(ContourErrors, KnowsTheTwoNamesOfALine) {
  const Room& room = published_room();
  ContourMap map = exact_map(room);
  for (WallEstimate& w : map.walls) w.wall = {-w.wall.rho - 0.01, w.wall.theta + 3 * kPi + 0.02};
  const ContourErrors e = contour_errors(map, room);
  for (const WallError& w : e.walls) {
    EXPECT_NEAR(w.rho, 0.01, 1e-12);
    EXPECT_NEAR(w.theta, 0.02, 1e-12);
    EXPECT_NEAR(w.theta_rotation_free, 0.0, 1e-12);
  }
  EXPECT_NEAR(e.common_rotation, 0.02, 1e-12);
}

TEST(ContourErrors, OrderOfTheMapDoesNotMatter) {
  const Room& room = published_room();
  ContourMap map = exact_map(room);
  Rng rng(5);
  for (WallEstimate& w : map.walls) {
    w.wall.rho += rng.normal(0, 0.02);
    w.wall.theta += rng.normal(0, 0.03);
  }
  const ContourErrors before = contour_errors(map, room);
  std::reverse(map.walls.begin(), map.walls.end());
  std::reverse(map.cylinders.begin(), map.cylinders.end());
  const ContourErrors after = contour_errors(map, room);
  EXPECT_EQ(before.other_walls.rho, after.other_walls.rho);
  EXPECT_EQ(before.all_walls.theta_rotation_free, after.all_walls.theta_rotation_free);
  EXPECT_EQ(after.walls[0].estimate, 6);
}

TEST(ContourErrors, CountsMissedAndInvented) {
  const Room& room = published_room();
  ContourMap map = exact_map(room);
  map.walls.erase(map.walls.begin() + 4);
  map.walls.push_back(map.walls[2]);  // the same wall twice: one of them is invented
  map.walls.back().wall.rho += 0.01;
  map.walls.push_back({.wall = {1.0, 2.2}});
  map.walls.push_back({.wall = {kNan, 0.0}});
  map.cylinders[0].cylinder.centre += Vector2(0.25, 0.2);  // 32 cm: beyond the gate
  map.cylinders[1].cylinder = {map.cylinders[1].cylinder.centre + Vector2(0.03, -0.06), 0.12444};
  const ContourErrors e = contour_errors(map, room);
  EXPECT_EQ(e.walls_found(), 6);
  EXPECT_EQ(e.walls_missed(), 1);
  EXPECT_FALSE(e.walls[4].found());
  EXPECT_EQ(e.walls[2].estimate, 2) << "the nearer of the two";
  EXPECT_EQ(e.invented_walls, (std::vector<int>{6, 7, 8}));
  EXPECT_EQ(e.cylinders_found(), 1);
  EXPECT_EQ(e.cylinders_missed(), 1);
  EXPECT_EQ(e.invented_cylinders, std::vector<int>{0});
  EXPECT_NEAR(e.cylinder_mae, (0.03 + 0.06 + 0.02) / 3, 1e-12);
  EXPECT_NEAR(e.cylinder_mae_radius, 0.02, 1e-12);
  EXPECT_FALSE(e.complete());
}

TEST(ContourErrors, GateStandsAtTheSumOfBothErrors) {
  Room room;
  room.walls.push_back({"east", {2.0, 0.3}, -1.0, 1.0});
  ContourMap map;
  map.walls.push_back({.wall = {2.0 + 0.099, 0.3 + radians(4.9)}});
  EXPECT_EQ(contour_errors(map, room).walls_found(), 1);
  map.walls[0].wall = {2.0 + 0.101, 0.3 + radians(5.1)};
  EXPECT_EQ(contour_errors(map, room).walls_found(), 0);
}

TEST(ContourErrors, AnchorWallIsLeftOutOfTheMeans) {
  const Room& room = published_room();
  ContourMap map = exact_map(room);
  map.walls[6].wall.rho += 0.06;
  map.walls[0].wall.rho += 0.03;
  EXPECT_NEAR(contour_errors(map, room).other_walls.rho, 0.06 / 6, 1e-12);
  EXPECT_NEAR(contour_errors(map, room).all_walls.rho, 0.09 / 7, 1e-12);
  EXPECT_NEAR(contour_errors(map, room, {.anchor_wall = "7"}).other_walls.rho, 0.03 / 6, 1e-12);
}

TEST(ContourErrors, NothingFoundIsNotZeroError) {
  const ContourErrors e = contour_errors({}, published_room());
  EXPECT_EQ(e.walls_missed(), 7);
  EXPECT_TRUE(std::isnan(e.other_walls.rho));
  EXPECT_TRUE(std::isnan(e.cylinder_mae));
  const ContourErrors empty = contour_errors({}, {});
  EXPECT_TRUE(empty.complete());
}

TEST(ContourErrors, RefusesBadParameters) {
  EXPECT_THROW((void)contour_errors({}, published_room(), {.rho_scale = 0.0}), std::invalid_argument);
  EXPECT_THROW((void)contour_errors({}, published_room(), {.wall_gate = kNan}), std::invalid_argument);
  EXPECT_THROW((void)contour_errors({}, published_room(), {.anchor_wall = "8"}), std::invalid_argument);
}

TEST(ContourMetrics, HaveTheNamesThatOthersRelyOn) {
  const Room& room = published_room();
  const auto metrics = contour_metrics(contour_errors(exact_map(room), room), "_known_pose");
  for (const char* name :
       {"walls_found", "walls_missed", "walls_invented", "cylinders_found", "cylinders_missed", "cylinders_invented",
        "wall_mae_rho", "wall_mae_theta", "cylinder_mae", "cylinder_mae_1", "cylinder_mae_2", "cylinder_mae_radius"}) {
    const auto it = std::find_if(metrics.begin(), metrics.end(),
                                 [&](const Metric& m) { return m.name == std::string(name) + "_known_pose"; });
    EXPECT_NE(it, metrics.end()) << name;
  }
}

}  // namespace
}  // namespace noctule::eval
