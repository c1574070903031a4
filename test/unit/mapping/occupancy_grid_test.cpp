#include "mapping/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.hpp"
#include "unit/mapping/heptagon.hpp"

namespace noctule::mapping {
namespace {

UltrasonicScan one_echo(double yaw, double range) {
  return {.stamp = {},
          .half_angle = radians(15.0),
          .min_range = 0.02,
          .max_range = 4.0,
          .beams = {{{0.0, 0.0, yaw}, range, Echo::hit}}};
}

TEST(OccupancyGrid, FreesTheInnerConeAndOccupiesTheArc) {
  OccupancyGrid grid{OccupancyParameters{}};
  grid.add(one_echo(0.0, 1.0), {});
  EXPECT_LT(grid.log_odds_at({0.5, 0.0}), 0.0);
  EXPECT_GT(grid.log_odds_at({1.0, 0.0}), 0.0);
  EXPECT_GT(grid.log_odds_at({0.99 * std::cos(0.2), 0.99 * std::sin(0.2)}), 0.0);
  EXPECT_EQ(grid.log_odds_at({1.2, 0.0}), 0.0) << "nothing is known behind the echo";
  EXPECT_EQ(grid.log_odds_at({0.6 * std::cos(0.2), 0.6 * std::sin(0.2)}), 0.0) << "nor outside the inner cone";
  EXPECT_EQ(grid.log_odds_at({-0.3, 0.0}), 0.0);
  EXPECT_EQ(grid.log_odds_at({100.0, 100.0}), 0.0);
}

TEST(OccupancyGrid, TurnsWithThePose) {
  OccupancyGrid grid{OccupancyParameters{}};
  grid.add(one_echo(kPi / 2.0, 1.0), {-2.0, -1.0, kPi / 2.0});
  EXPECT_LT(grid.log_odds_at({-2.5, -1.0}), 0.0);
  EXPECT_GT(grid.log_odds_at({-3.0, -1.0}), 0.0);
}

TEST(OccupancyGrid, CellsAreWhereOriginAndResolutionSay) {
  OccupancyGrid grid{OccupancyParameters{}};
  grid.add(one_echo(0.3, 1.5), {-1.0, 0.5, 0.0});
  grid.add(one_echo(-2.0, 2.5), {1.0, 4.5, 0.0});  // makes it grow
  for (int row = 0; row < grid.height(); ++row) {
    for (int column = 0; column < grid.width(); ++column) {
      const Vector2 middle = grid.origin() + grid.resolution() * Vector2(column + 0.5, row + 0.5);
      ASSERT_EQ(grid.log_odds_at(middle), grid.log_odds(column, row));
    }
  }
  EXPECT_GT(grid.log_odds_at(Vector2(-1.0, 0.5) + 1.5 * Vector2(std::cos(0.3), std::sin(0.3))), 0.0);
}

TEST(OccupancyGrid, AgreesWithAGridOfGivenBounds) {
  OccupancyGrid grows{OccupancyParameters{}}, given({}, {-1.0, -1.0}, {2.0, 2.0});
  const int width = given.width();
  for (const PosedScan& s : heptagon::drive({}, 1, 1)) {
    grows.add(s.scan, s.base_in_map);
    given.add(s.scan, s.base_in_map);
  }
  EXPECT_EQ(given.width(), width);
  for (double x = -0.975; x < 2.0; x += 0.05) {
    for (double y = -0.975; y < 2.0; y += 0.05) ASSERT_EQ(grows.log_odds_at({x, y}), given.log_odds_at({x, y}));
  }
}

TEST(OccupancyGrid, ShowsTheRoom) {
  OccupancyGrid grid{OccupancyParameters{}};
  for (const PosedScan& s : heptagon::drive(heptagon::SensorNoise::gaussian(), 1)) grid.add(s.scan, s.base_in_map);
  for (const Pose2& stop : heptagon::stops(1)) EXPECT_LT(grid.log_odds_at(stop.position()), 0.0);
  int occupied = 0, tried = 0;
  for (double x = 0.0; x < 2.0; x += 0.05) {  // wall 1, within half a cell
    const bool there = grid.log_odds_at({x, -0.59}) > 0.0 || grid.log_odds_at({x, -0.61}) > 0.0;
    occupied += there ? 1 : 0;
    ++tried;
  }
  EXPECT_GT(occupied, 0.9 * tried);
  EXPECT_NEAR(grid.probability(0, 0), 0.5, 1e-12);
}

TEST(OccupancyGrid, RefusesBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  OccupancyGrid grid{OccupancyParameters{}};
  EXPECT_THROW(grid.add(one_echo(0.0, 1.0), {nan, 0.0, 0.0}), InputError);
  EXPECT_THROW(grid.add(one_echo(0.0, -1.0), {}), InputError);
  grid.add(one_echo(0.0, 1.0), {});
  EXPECT_THROW(grid.add(one_echo(0.0, 1.0), {1e6, 0.0, 0.0}), InputError) << "would need too many cells";
  EXPECT_THROW(grid.add(one_echo(0.0, 1.0), {1e300, 0.0, 0.0}), InputError);
  EXPECT_THROW(OccupancyGrid({}, {1.0, 0.0}, {0.0, 1.0}), InputError);
  EXPECT_THROW(OccupancyGrid({}, {nan, 0.0}, {1.0, 1.0}), InputError);
}

}  // namespace
}  // namespace noctule::mapping
