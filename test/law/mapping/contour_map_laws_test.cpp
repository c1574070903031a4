/// What must hold for every map.
#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/contour_mapper.hpp"
#include "mapping/rho_theta.hpp"
#include "unit/mapping/heptagon.hpp"

namespace noctule::mapping {
namespace {

std::vector<PosedScan> moved(std::vector<PosedScan> scans, const Pose2& motion) {
  for (PosedScan& s : scans) s.base_in_map = motion * s.base_in_map;
  return scans;
}

TEST(ContourMap, MovesWithTheRobotsFrame) {
  const auto scans = heptagon::drive({}, 1);
  const ContourMap map = map_contours(scans, {});
  for (const Pose2& motion : {Pose2{3.0, -2.0, 0.0}, Pose2{0.0, 0.0, 1.0}, Pose2{-1.5, 0.7, -2.3}}) {
    const ContourMap other = map_contours(moved(scans, motion), {});
    ASSERT_EQ(other.walls.size(), map.walls.size());
    for (const WallEstimate& w : map.walls) {
      const Wall expected = normalised(transformed(motion, w.wall));
      const auto match = std::find_if(other.walls.begin(), other.walls.end(),
                                      [&](const WallEstimate& o) { return near(o.wall, expected, 0.01, 0.01); });
      ASSERT_NE(match, other.walls.end());
      // Fits are iterated to 1e-8; the accumulators' bins lie elsewhere, so a doubtful echo may change hands.
      EXPECT_NEAR(match->wall.rho, expected.rho, 1e-3);
      EXPECT_NEAR(wrap(match->wall.theta - expected.theta), 0.0, 1e-3);
      EXPECT_NEAR(std::sqrt(match->covariance(1, 1) / w.covariance(1, 1)), 1.0, 0.1);
      EXPECT_NEAR(match->end - match->begin, w.end - w.begin, 0.05);
    }
    ASSERT_EQ(other.cylinders.size(), map.cylinders.size());
    for (const CylinderEstimate& c : map.cylinders) {
      EXPECT_TRUE(std::any_of(other.cylinders.begin(), other.cylinders.end(), [&](const CylinderEstimate& o) {
        return (o.cylinder.centre - motion * c.cylinder.centre).norm() < 1e-3 &&
               std::abs(o.cylinder.radius - c.cylinder.radius) < 1e-3;
      }));
    }
  }
}

TEST(ContourMap, AWallSeenFromBothSidesOfTheOriginIsNormalised) {
  // The map's origin lies behind wall 7: its normal must be turned, and its ends with it.
  const Pose2 motion{1.5, 0.0, 0.0};
  const ContourMap map = map_contours(moved(heptagon::drive(heptagon::SensorNoise::gaussian(), 2), motion), {});
  const auto match = std::find_if(map.walls.begin(), map.walls.end(), [](const WallEstimate& w) {
    return near(w.wall, {0.9, 0.0}, 0.02, 0.02);
  });
  ASSERT_NE(match, map.walls.end());
  EXPECT_GE(match->wall.rho, 0.0);
  EXPECT_NEAR(match->wall.theta, 0.0, 0.02);
  // Truth: y from -0.60 to 1.64, heard from -0.05 on; the tangent is +y.
  EXPECT_NEAR(match->begin, -0.05, 0.1);
  EXPECT_NEAR(match->end, 1.63, 0.1);
}

TEST(ContourMap, IsTheSameEveryTime) {
  const auto scans = heptagon::drive({}, 5);
  const ContourMap a = map_contours(scans, {}), b = map_contours(scans, {});
  ASSERT_EQ(a.walls.size(), b.walls.size());
  for (std::size_t i = 0; i < a.walls.size(); ++i) {
    EXPECT_EQ(a.walls[i].wall.rho, b.walls[i].wall.rho);
    EXPECT_EQ(a.walls[i].wall.theta, b.walls[i].wall.theta);
    EXPECT_EQ(a.walls[i].covariance, b.walls[i].covariance);
  }
}

TEST(ContourMap, LooksTheSameBeforeAndAfterAskingForIt) {
  const auto scans = heptagon::drive({}, 6);
  ContourMapper asked{MapperParameters{}}, silent{MapperParameters{}};
  for (const PosedScan& s : scans) {
    asked.add(s.scan, s.base_in_map);
    silent.add(s.scan, s.base_in_map);
    (void)asked.map();
  }
  ASSERT_EQ(asked.map().walls.size(), silent.map().walls.size());
  for (std::size_t i = 0; i < silent.map().walls.size(); ++i) {
    EXPECT_EQ(asked.map().walls[i].wall.rho, silent.map().walls[i].wall.rho);
  }
}

}  // namespace
}  // namespace noctule::mapping
