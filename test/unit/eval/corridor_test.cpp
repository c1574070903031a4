#include "eval/corridor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace noctule::eval {
namespace {

/// A wall between two points, as a mapper would give it.
WallEstimate wall(const Vector2& a, const Vector2& b, double theta_sd = 0.001) {
  const Vector2 along = (b - a).normalized();
  Wall w{along.y() * a.x() - along.x() * a.y(), std::atan2(-along.x(), along.y())};
  w = normalised(w);
  WallEstimate estimate{.wall = w};
  estimate.begin = std::min(w.tangent().dot(a), w.tangent().dot(b));
  estimate.end = std::max(w.tangent().dot(a), w.tangent().dot(b));
  estimate.covariance(1, 1) = theta_sd * theta_sd;
  estimate.readings = static_cast<int>(10.0 * (b - a).norm());
  return estimate;
}

/// Ten metres along x, then six metres to the right, at `corner`; the way keeps off the middle.
struct Corridor {
  explicit Corridor(double corner = radians(90.0), double convergence = 0.0) {
    for (int i = 0; i <= 100; ++i) way.emplace_back(0.1 * i, 0.2);
    const Vector2 down(std::cos(-corner), std::sin(-corner));
    for (int i = 1; i <= 60; ++i) way.push_back(Vector2(10.0, 0.2) + 0.1 * i * down);
    const double rise = 5.0 * std::tan(convergence);
    map.walls = {wall({0.0, 1.0 + rise}, {10.0, 1.0 - rise}), wall({0.0, -1.0}, {9.0, -1.0})};
    const Vector2 left(-down.y(), down.x());
    const Vector2 bend(10.0, 0.2);
    map.walls.push_back(wall(bend + left, bend + left + 6.0 * down));
    map.walls.push_back(wall(bend - left + 1.5 * down, bend - left + 6.0 * down, 0.01));
  }
  std::vector<Vector2> way;
  ContourMap map;
};

TEST(CorridorFigures, AreThoseOfTheCorridor) {
  for (const double corner : {80.0, 90.0, 97.0}) {
    const Corridor c(radians(corner));
    const CorridorFigures f = corridor_figures(c.map, c.way);
    EXPECT_EQ(f.left, 0);
    EXPECT_EQ(f.right, 1);
    EXPECT_EQ(f.second, 2);
    ASSERT_TRUE(f.width && f.parallelism && f.corner);
    EXPECT_NEAR(*f.width, 2.0, 1e-9);
    EXPECT_NEAR(*f.parallelism, 0.0, 1e-9);
    EXPECT_NEAR(degrees(*f.corner), corner, 1e-9);
  }
  const Corridor narrowing(radians(90.0), radians(2.0));
  const CorridorFigures f = corridor_figures(narrowing.map, narrowing.way);
  EXPECT_NEAR(degrees(f.parallelism.value()), -2.0, 1e-9);
  EXPECT_NEAR(*f.width, 2.0, 0.02);
  EXPECT_NEAR(degrees(*f.corner), 89.0, 1e-9);  // from the mean of both walls
}

TEST(CorridorFigures, DoNotDependOnTheFrame) {
  const Corridor c;
  for (const Pose2 motion : {Pose2{20.0, -7.0, 2.5}, Pose2{-30.0, 4.0, -1.0}}) {
    ContourMap map = c.map;
    for (WallEstimate& w : map.walls) {
      const Wall moved = transformed(motion, w.wall), kept = normalised(moved);
      const double along = moved.tangent().dot(motion.position());
      const bool turned = moved.rho < 0.0;
      const double begin = w.begin + along, end = w.end + along;
      w.wall = kept;
      w.begin = turned ? -end : begin;
      w.end = turned ? -begin : end;
    }
    std::vector<Vector2> way;
    for (const Vector2& p : c.way) way.push_back(motion * p);
    const CorridorFigures f = corridor_figures(map, way);
    ASSERT_TRUE(f.corner);
    EXPECT_NEAR(*f.width, 2.0, 1e-9);
    EXPECT_NEAR(*f.corner, kPi / 2.0, 1e-9);
  }
}

TEST(CorridorFigures, PassOverNichesSlantsAndStandstill) {
  Corridor c;
  c.map.walls.insert(c.map.walls.begin(),
                     {wall({2.0, 1.4}, {3.0, 1.4}), wall({0.0, 0.8}, {9.0, 4.0}), wall({-15.0, 1.2}, {-4.0, 1.2})});
  c.map.walls.push_back(wall({0.0, -3.0}, {14.0, -0.8}));
  c.map.walls.back().readings = 15;  // long, but few speak for it
  c.way.insert(c.way.begin(), 5000, Vector2(0.0, 0.2));
  const CorridorFigures f = corridor_figures(c.map, c.way);
  EXPECT_EQ(f.left, 3);
  EXPECT_EQ(f.right, 4);
  EXPECT_NEAR(f.width.value(), 2.0, 1e-9);
  EXPECT_NEAR(f.corner.value(), kPi / 2.0, 1e-9);
}

TEST(CorridorFigures, TakeTheSecondLegsBetterKnownSide) {
  Corridor c;
  std::swap(c.map.walls[2].covariance, c.map.walls[3].covariance);
  EXPECT_EQ(corridor_figures(c.map, c.way).second, 3);
}

TEST(CorridorFigures, SayNothingWhereWallsAreMissing) {
  Corridor c;
  c.map.walls.resize(2);
  const CorridorFigures half = corridor_figures(c.map, c.way);
  EXPECT_TRUE(half.width && half.parallelism);
  EXPECT_FALSE(half.corner);
  c.map.walls.resize(1);
  EXPECT_FALSE(corridor_figures(c.map, c.way).width);
  const Corridor whole;
  EXPECT_FALSE(corridor_figures(whole.map, std::vector<Vector2>(100, Vector2::Zero())).width);
}

TEST(CorridorFigures, RefuseWhatMakesNoSense) {
  const Corridor c;
  EXPECT_THROW((void)corridor_figures(c.map, c.way, {.alignment = 0.0}), std::invalid_argument);
  EXPECT_THROW((void)corridor_figures(c.map, c.way, {.reach = -1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::eval
