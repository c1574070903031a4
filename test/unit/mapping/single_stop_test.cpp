#include "mapping/single_stop.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.hpp"
#include "mapping/contour_mapper.hpp"
#include "unit/mapping/heptagon.hpp"

namespace noctule::mapping {
namespace {

constexpr double kHalfAngle = radians(20.0);

/// 4.4 by 3.2 m; its walls and corners as seen from inside.
const std::vector<Wall> kWalls{{2.4, 0.0}, {1.7, kPi / 2.0}, {2.0, -kPi}, {1.5, -kPi / 2.0}};
const std::vector<Vector2> kCorners{{2.4, 1.7}, {-2.0, 1.7}, {-2.0, -1.5}, {2.4, -1.5}};

/// A ranger turned once round at `place`, a ping every two degrees.
UltrasonicScan sweep(const Vector2& place, const heptagon::SensorNoise& noise, std::uint64_t seed) {
  UltrasonicScan scan{{}, kHalfAngle, 0.02, 4.0, {}};
  Rng rng(seed, stream_id("test.sweep"));
  for (int i = 0; i < 180; ++i) {
    const double axis = wrap(radians(2.0 * i));
    std::vector<heptagon::Heard> heard;
    const auto add = [&](double range, double direction) {
      const double angle = std::abs(wrap(direction - axis));
      if (angle <= kHalfAngle) heard.push_back({range, angle});
    };
    for (const Wall& w : kWalls) add(w.distance(place), w.theta);
    for (const Vector2& c : kCorners) add((c - place).norm(), std::atan2(c.y() - place.y(), c.x() - place.x()));
    std::sort(heard.begin(), heard.end(), [](const auto& a, const auto& b) { return a.range < b.range; });
    const auto range = heptagon::ping(heard, kHalfAngle, noise, 1.0, rng);
    scan.beams.push_back({{0.0, 0.0, axis}, range.value_or(0.0), range ? Echo::hit : Echo::none});
  }
  return scan;
}

MapperParameters single_stop() {
  MapperParameters p;
  p.single_stop.enabled = true;
  return p;
}

ContourMap map_of(const UltrasonicScan& scan, const Pose2& base = {}) {
  const PosedScan posed{scan, base};
  return map_contours({&posed, 1}, single_stop());
}

/// Error (distance from the place [m], direction [rad]) of the map's wall nearest to a true one, and its covariance
/// there.
struct Found {
  Vector2 error;
  Matrix2 covariance;
};
std::optional<Found> find(const ContourMap& map, const Wall& truth, const Vector2& place) {
  for (const WallEstimate& w : map.walls) {
    const bool turned = w.wall.distance(place) < 0.0;  // the origin of the map is behind it
    const Wall seen{std::abs(w.wall.distance(place)), turned ? w.wall.theta + kPi : w.wall.theta};
    const Vector2 error(seen.rho - truth.distance(place), wrap(seen.theta - truth.theta));
    if (std::abs(error[0]) > 0.1 || std::abs(error[1]) > radians(15.0)) continue;
    Matrix2 to_place = Matrix2::Identity();
    to_place(0, 1) = -w.wall.tangent().dot(place);
    if (turned) to_place.row(0) = -to_place.row(0);
    return Found{error, to_place * w.covariance * to_place.transpose()};
  }
  return {};
}

TEST(SingleStop, FindsTheWallsOfARoomWithinTheirCovarianceAndTheCornersAsPoints) {
  constexpr int kRuns = 50;
  int corners = 0, invented = 0;
  double nees_range = 0.0, nees_direction = 0.0;
  for (int run = 1; run <= kRuns; ++run) {
    Rng rng(static_cast<std::uint64_t>(run), stream_id("test.place"));
    const Vector2 place{rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)};
    const ContourMap map = map_of(sweep(place, {}, static_cast<std::uint64_t>(run)), {place.x(), place.y(), 0.0});
    for (const Wall& truth : kWalls) {
      const auto found = find(map, truth, place);
      ASSERT_TRUE(found) << "run " << run << ", wall at " << degrees(truth.theta);
      nees_range += found->error[0] * found->error[0] / found->covariance(0, 0);
      nees_direction += found->error[1] * found->error[1] / found->covariance(1, 1);
    }
    invented += static_cast<int>(map.walls.size()) - 4;
    for (const PointEstimate& p : map.points) {
      for (const Vector2& c : kCorners) corners += (c - p.position).norm() < 0.5 ? 1 : 0;
    }
    EXPECT_LE(map.points.size(), 4U);
  }
  // Not too sure of itself; nor has it reason to be sure: where in its cone a wall lies is not Gaussian.
  EXPECT_LT(nees_range / (4 * kRuns), 1.5);
  EXPECT_LT(nees_direction / (4 * kRuns), 1.5);
  EXPECT_LE(invented, 5);
  EXPECT_GE(corners, 150);
}

TEST(SingleStop, MovesWithThePlace) {
  const UltrasonicScan scan = sweep({0.2, -0.1}, {}, 7);
  const ContourMap at_origin = map_of(scan);
  const Pose2 motion{3.0, -2.0, 0.8};
  const ContourMap moved = map_of(scan, motion);
  ASSERT_EQ(moved.walls.size(), at_origin.walls.size());
  ASSERT_EQ(moved.points.size(), at_origin.points.size());
  for (std::size_t i = 0; i < moved.walls.size(); ++i) {
    const Wall expected = normalised(transformed(motion, at_origin.walls[i].wall));
    EXPECT_NEAR(moved.walls[i].wall.rho, expected.rho, 1e-9);
    EXPECT_NEAR(wrap(moved.walls[i].wall.theta - expected.theta), 0.0, 1e-9);
    EXPECT_NEAR(moved.walls[i].end - moved.walls[i].begin, at_origin.walls[i].end - at_origin.walls[i].begin, 1e-9);
    EXPECT_NEAR(moved.walls[i].covariance(1, 1), at_origin.walls[i].covariance(1, 1), 1e-12);
    const double foot = moved.walls[i].wall.tangent().dot(motion.position());
    EXPECT_NEAR(0.5 * (moved.walls[i].begin + moved.walls[i].end), foot, 1e-9);
  }
  for (std::size_t i = 0; i < moved.points.size(); ++i) {
    EXPECT_LT((motion * at_origin.points[i].position - moved.points[i].position).norm(), 1e-9);
  }
}

/// Echoes every degree from `from` to `to` [deg], `times` over.
void hear(UltrasonicScan& scan, int from, int to, double range, int times = 1) {
  for (int i = 0; i < times; ++i) {
    for (int a = from; a <= to; ++a) scan.beams.push_back({{0.0, 0.0, wrap(radians(a + 0.5))}, range, Echo::hit});
  }
}

TEST(SingleStop, AWallIsInTheMiddleOfWhereItIsHeard) {
  UltrasonicScan scan{{}, kHalfAngle, 0.02, 4.0, {}};
  hear(scan, 20, 29, 2.0, 5);  // the hand lingers
  hear(scan, 30, 49, 2.0);
  const ContourMap map = map_of(scan);
  ASSERT_EQ(map.walls.size(), 1U);
  EXPECT_NEAR(degrees(map.walls[0].wall.theta), 35.0, 1e-9);
  EXPECT_NEAR(map.walls[0].wall.rho, 2.0, 1e-12);
  EXPECT_EQ(map.walls[0].stops, 1);
}

TEST(SingleStop, APauseDoesNotOutvoteATurn) {
  UltrasonicScan scan{{}, kHalfAngle, 0.02, 4.0, {}};
  hear(scan, -15, 14, 2.0);
  hear(scan, -2, 2, 2.2, 100);
  const ContourMap map = map_of(scan);
  ASSERT_FALSE(map.walls.empty());
  EXPECT_DOUBLE_EQ(map.walls.back().wall.rho, 2.0);
}

TEST(SingleStop, WhatIsHeardThroughIsNoWall) {
  UltrasonicScan scan{{}, kHalfAngle, 0.02, 4.0, {}};
  hear(scan, -15, 14, 2.0);
  hear(scan, -6, 5, 1.2);  // an echo of something else: the wall behind is heard there too
  const ContourMap map = map_of(scan);
  ASSERT_EQ(map.walls.size(), 1U);
  EXPECT_DOUBLE_EQ(map.walls[0].wall.rho, 2.0);
}

TEST(SingleStop, ACornerIsWhereNearerWallsMeetAndNoOther) {
  const auto with_third = [](int direction, double range) {
    UltrasonicScan scan{{}, kHalfAngle, 0.02, 4.0, {}};
    hear(scan, -15, 14, 2.0);
    hear(scan, 75, 104, 1.5);
    hear(scan, direction - 15, direction + 14, range);
    return map_of(scan);
  };
  const ContourMap corner = with_third(37, 2.5);  // 3-4-5
  EXPECT_EQ(corner.walls.size(), 2U);
  ASSERT_EQ(corner.points.size(), 1U);
  EXPECT_LT((corner.points[0].position - Vector2(2.0, 1.5)).norm(), 0.02);
  EXPECT_GT(corner.points[0].covariance.determinant(), 0.0);
  EXPECT_EQ(with_third(37, 2.9).walls.size(), 3U);
  EXPECT_EQ(with_third(-90, 2.5).walls.size(), 3U);
}

TEST(SingleStop, JudgesEachStopByItself) {
  const UltrasonicScan scan = sweep({0.0, 0.0}, {}, 3);
  const std::vector<PosedScan> twice{{scan, {}}, {scan, {1.0, 0.0, 0.0}}};
  const ContourMap one = map_of(scan), two = map_contours(twice, single_stop());
  EXPECT_EQ(two.walls.size(), 2 * one.walls.size());
  EXPECT_EQ(two.points.size(), 2 * one.points.size());
}

TEST(SingleStop, IsSilentOnTooLittleAndOffUnlessAsked) {
  EXPECT_TRUE(map_contours({}, single_stop()).walls.empty());
  UltrasonicScan scan{{}, kHalfAngle, 0.02, 4.0, {}};
  hear(scan, 0, 3, 2.0);
  EXPECT_TRUE(map_of(scan).walls.empty());  // too few
  hear(scan, 0, 3, 2.0, 5);
  EXPECT_TRUE(map_of(scan).walls.empty());  // too narrow
  const PosedScan posed{sweep({0.0, 0.0}, {}, 3), {}};
  EXPECT_FALSE(MapperParameters{}.single_stop.enabled);
  EXPECT_TRUE(map_contours({&posed, 1}, {}).walls.empty());  // a wall takes several stops
  EXPECT_FALSE(map_contours({&posed, 1}, single_stop()).walls.empty());
}

TEST(SingleStop, RefusesWhatIsNotFinite) {
  UltrasonicScan scan{{}, kHalfAngle, 0.02, 4.0, {}};
  hear(scan, 0, 20, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW((void)map_of(scan), InputError);
}

}  // namespace
}  // namespace noctule::mapping
