#include "mapping/hough.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/rng.hpp"
#include "mapping/rho_theta.hpp"
#include "unit/mapping/heptagon.hpp"

namespace noctule::mapping {
namespace {

SonarArc arc_at(const Vector2& p, double axis, double range) {
  return {.sensor = p,
          .axis = {std::cos(axis), std::sin(axis)},
          .range = range,
          .sigma = 0.01,
          .half_angle = radians(15.0)};
}

TEST(VoteGrid, FindsThePeakAndPassesOverForbiddenCells) {
  VoteGrid grid(3, 40);
  EXPECT_EQ(grid.best(0.0F).row, -1);
  grid.add(1, 39, 2.0F);
  grid.add(2, 0, 1.0F);
  EXPECT_EQ(grid.best(0.0F).column, 39);
  EXPECT_EQ(grid.best(2.0F).row, -1);
  grid.forbid(1, 37, 60);
  EXPECT_EQ(grid.best(0.0F).row, 2);
  grid.add(1, 20, 1.5F);
  EXPECT_EQ(grid.best(0.0F).column, 20);
  grid.forbid(1, 19, 38);
  EXPECT_EQ(grid.best(0.0F).row, 2);
  grid.allow_all();
  EXPECT_EQ(grid.best(0.0F).column, 39);
  grid.add(1, 39, -2.0F);
  EXPECT_EQ(grid.best(0.0F).column, 20);
}

TEST(LineVotes, ThePeakOfTangentArcsIsTheWall) {
  const Wall wall{1.5, 0.5};
  LineVotes votes({}, {{0.5, 0.0}, 3.0}, LineVotes::Normals::directed);
  for (int i = 0; i < 20; ++i) {
    const Vector2 p(0.05 * i, 0.02 * i);
    votes.vote(arc_at(p, wall.theta + 0.01 * (i - 10), wall.distance(p)), 1.0);
  }
  const auto peak = votes.best(0.0);
  ASSERT_TRUE(peak);
  EXPECT_NEAR(peak->wall.rho, wall.rho, 0.03);
  EXPECT_NEAR(peak->wall.theta, wall.theta, radians(2.0));
}

TEST(LineVotes, VotesTakenBackLeaveNothing) {
  LineVotes lines({}, {{0.0, 0.0}, 3.0}, LineVotes::Normals::directed);
  CircleVotes circles({}, {{0.0, 0.0}, 3.0});
  std::vector<SonarArc> arcs;
  Rng rng(5);
  for (int i = 0; i < 200; ++i) {
    arcs.push_back(arc_at({rng.uniform(-1, 1), rng.uniform(-1, 1)}, rng.uniform(-3, 3), rng.uniform(0.2, 3.0)));
    lines.vote(arcs.back(), 1.0);
    circles.vote(arcs.back(), 1.0);
  }
  for (const SonarArc& arc : arcs) {
    lines.vote(arc, -1.0);
    circles.vote(arc, -1.0);
  }
  EXPECT_FALSE(lines.best(1e-5));
  EXPECT_FALSE(circles.best(1e-5));
}

TEST(CircleVotes, ThePeakOfArcsAllAroundIsTheCylinder) {
  const Cylinder cylinder{{0.6, 0.5}, 0.16};
  CircleVotes votes({}, {{0.6, 0.5}, 2.0});
  for (int i = 0; i < 24; ++i) {
    const double a = kTwoPi * i / 24.0;
    const Vector2 p = cylinder.centre - 1.0 * Vector2(std::cos(a), std::sin(a));
    votes.vote(arc_at(p, a + 0.05, cylinder.distance(p)), 1.0);
  }
  const auto peak = votes.best(0.0);
  ASSERT_TRUE(peak);
  EXPECT_LT((peak->cylinder.centre - cylinder.centre).norm(), 0.06);
  EXPECT_NEAR(peak->cylinder.radius, cylinder.radius, 0.05);
}

TEST(HoughLines, FindsTheWallsOfAnOutlineWithinTheirCovariance) {
  const auto walls = hough_lines(heptagon::outline(0.005, 0.0, 1), {});
  const Room room = heptagon::room();
  for (const RoomWall& truth : room.walls) {
    const auto match = std::find_if(walls.begin(), walls.end(), [&](const WallEstimate& w) {
      return near(w.wall, truth.wall, 0.02, radians(1.0));
    });
    ASSERT_NE(match, walls.end()) << truth.name;
    EXPECT_LT(std::abs(match->wall.rho - truth.wall.rho), 4.0 * std::sqrt(match->covariance(0, 0)));
    EXPECT_LT(std::abs(wrap(match->wall.theta - truth.wall.theta)), 4.0 * std::sqrt(match->covariance(1, 1)));
    // The neighbour that is found first keeps what is within 3 sigma of it: points up to 6 sigma / sin 30 degrees from
    // a corner of 150 degrees, 2 cm apart.
    EXPECT_NEAR(match->begin, truth.begin, 0.08);
    EXPECT_NEAR(match->end, truth.end, 0.08);
  }
  EXPECT_EQ(walls.size(), 7U);
}

TEST(HoughCircles, FindsTheCylindersOfAnOutline) {
  const auto cylinders = hough_circles(heptagon::outline(0.005, 0.0, 2), {});
  ASSERT_EQ(cylinders.size(), 2U);
  for (const RoomCylinder& truth : heptagon::room().cylinders) {
    EXPECT_TRUE(std::any_of(cylinders.begin(), cylinders.end(), [&](const CylinderEstimate& c) {
      return (c.cylinder.centre - truth.cylinder.centre).norm() < 0.005 &&
             std::abs(c.cylinder.radius - truth.cylinder.radius) < 0.005;
    })) << truth.name;
  }
}

TEST(HoughLines, FindsTheWallsAmongEchoesAndHoughCirclesTheCylinders) {
  MapperParameters parameters;
  ArcReader reader(parameters.range_noise, parameters.stop_distance, parameters.max_noise_scale);
  std::vector<SonarArc> arcs;
  for (const PosedScan& s : heptagon::drive(heptagon::SensorNoise::gaussian(), 1)) {
    reader.read(s.scan, s.base_in_map, arcs);
  }
  const auto walls = hough_lines(arcs, parameters);
  const auto cylinders = hough_circles(arcs, parameters);
  for (const RoomWall& truth : heptagon::room().walls) {
    EXPECT_TRUE(std::any_of(walls.begin(), walls.end(), [&](const WallEstimate& w) {
      return near(w.wall, truth.wall, 0.03, radians(1.5));
    })) << truth.name;
  }
  for (const RoomCylinder& truth : heptagon::room().cylinders) {
    EXPECT_TRUE(std::any_of(cylinders.begin(), cylinders.end(), [&](const CylinderEstimate& c) {
      return (c.cylinder.centre - truth.cylinder.centre).norm() < 0.01;
    })) << truth.name;
  }
}

TEST(HoughLines, NothingFromNothing) {
  EXPECT_TRUE(hough_lines(std::vector<SonarArc>{}, {}).empty());
  EXPECT_TRUE(hough_lines(std::vector<PointWithCovariance>{}, {}).empty());
  EXPECT_TRUE(hough_circles(std::vector<SonarArc>{}, {}).empty());
  EXPECT_TRUE(hough_circles(std::vector<PointWithCovariance>{}, {}).empty());
}

}  // namespace
}  // namespace noctule::mapping
