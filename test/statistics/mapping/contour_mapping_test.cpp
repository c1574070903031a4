/// Accuracy, completeness and consistency of contour maps in the heptagon room.
#include "mapping/contour_mapper.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/chi2.hpp"
#include "unit/mapping/heptagon.hpp"

namespace noctule::mapping {
namespace {

using heptagon::Score;
using heptagon::SensorNoise;

/// Sums of scores over runs.
struct Tally {
  int runs = 0, complete = 0, walls_invented = 0, cylinders_invented = 0, walls_found = 0;
  double rho = 0.0, theta = 0.0, cylinder = 0.0;  // means over runs
  void add(const Score& s) {
    ++runs;
    complete += s.complete() ? 1 : 0;
    walls_found += s.walls_found;
    walls_invented += s.walls_invented;
    cylinders_invented += s.cylinders_invented;
    rho += (s.rho - rho) / runs;
    theta += (s.theta - theta) / runs;
    cylinder += (s.cylinder - cylinder) / runs;
  }
};

TEST(KnownPoseMap, IsExactWithoutNoise) {
  for (const bool certain : {false, true}) {
    SensorNoise noise = SensorNoise::none();
    noise.certain_echoes = certain;
    const ContourMap map = map_contours(heptagon::drive(noise, 1), {});
    const Score s = heptagon::score(map);
    EXPECT_TRUE(s.complete());
    EXPECT_LT(s.max_rho, 0.0005);
    EXPECT_LT(s.max_theta, radians(0.05));
    EXPECT_LT(s.max_cylinder, 0.001);
    ASSERT_EQ(map.points.size(), 1U) << "the right-angle corner and nothing else";
    EXPECT_LT((map.points.front().position - heptagon::kCorner).norm(), 0.001);
  }
}

TEST(KnownPoseMap, IsCompleteAndAccurateInThePinnedWorld) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Score s = heptagon::score(map_contours(heptagon::drive({}, seed), {}));
    EXPECT_TRUE(s.complete()) << "seed " << seed << ": walls " << s.walls_found << " + " << s.walls_invented
                              << " invented, cylinders " << s.cylinders_found << " + " << s.cylinders_invented;
    tally.add(s);
  }
  EXPECT_LE(tally.rho, 0.005);
  EXPECT_LE(tally.theta, radians(0.25));
  EXPECT_LE(tally.cylinder, 0.003);
}

TEST(KnownPoseMap, SeesTheEndsOfWallsWhereTheyWereHeard) {
  const ContourMap map = map_contours(heptagon::drive(SensorNoise::gaussian(), 3), {});
  for (const RoomWall& truth : heptagon::room().walls) {
    for (const WallEstimate& w : map.walls) {
      if (std::abs(wrap(w.wall.theta - truth.wall.theta)) > 0.1) continue;
      EXPECT_GT(w.begin, truth.begin - 0.05) << truth.name;
      EXPECT_LT(w.end, truth.end + 0.05) << truth.name;
      EXPECT_GT(w.end - w.begin, 0.6) << truth.name;
    }
  }
}

TEST(KnownPoseMap, CovariancesAreConsistent) {
  // The jackknife knows the covariance as a sample of some 40 stops does: its normalised error is that of Hotelling's
  // T2, d (n - 1) / (n - d - 1) on average instead of d.
  constexpr int runs = 24;
  constexpr double stops = 40.0;
  double walls = 0.0, cylinders = 0.0;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    const ContourMap map = map_contours(heptagon::drive(SensorNoise::gaussian(), seed), {});
    ASSERT_TRUE(heptagon::score(map).complete());
    const Room room = heptagon::room();
    for (const WallEstimate& w : map.walls) {
      double least = 1e9;
      for (const RoomWall& truth : room.walls) {
        const Vector2 e(w.wall.rho - truth.wall.rho, wrap(w.wall.theta - truth.wall.theta));
        if (e.norm() < 0.2) least = std::min(least, e.dot(w.covariance.inverse() * e));
      }
      walls += least / (7.0 * runs);
    }
    for (const CylinderEstimate& c : map.cylinders) {
      double least = 1e9;
      for (const RoomCylinder& truth : room.cylinders) {
        Vector3 e;
        e << c.cylinder.centre - truth.cylinder.centre, c.cylinder.radius - truth.cylinder.radius;
        if (e.norm() < 0.2) least = std::min(least, e.dot(c.covariance.inverse() * e));
      }
      cylinders += least / (2.0 * runs);
    }
  }
  const Interval wall_bounds = nees_bounds(2, 7 * runs), cylinder_bounds = nees_bounds(3, 2 * runs);
  EXPECT_GT(walls, wall_bounds.low);
  EXPECT_LT(walls, wall_bounds.high * (stops - 1.0) / (stops - 3.0));
  EXPECT_GT(cylinders, cylinder_bounds.low);
  EXPECT_LT(cylinders, cylinder_bounds.high * (stops - 1.0) / (stops - 4.0));
}

TEST(EstimatedPoseMap, StaysCompleteWithTheErrorsOfASlamPath) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const auto scans = heptagon::wandering(heptagon::drive({}, seed), 0.02, radians(0.7), seed);
    tally.add(heptagon::score(map_contours(scans, {})));
  }
  EXPECT_GE(tally.complete, 22);
  EXPECT_LE(tally.walls_invented, 1);
  EXPECT_LE(tally.cylinders_invented, 1);
  EXPECT_LT(tally.rho, 0.02);
  EXPECT_LT(tally.theta, radians(1.0));
}

TEST(EstimatedPoseMap, DeadReckoningMovesWallsButHardlyInventsAny) {
  // The second loop sees the room turned by several degrees: walls heard twice must not become two.
  Tally tally;
  int walls = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const auto scans = heptagon::dead_reckoned(heptagon::drive({}, seed), {}, seed);
    const ContourMap map = map_contours(scans, {});
    walls += static_cast<int>(map.walls.size());
    tally.add(heptagon::score(map));
  }
  EXPECT_GT(tally.walls_found, 24 * 5);
  EXPECT_LT(walls, 24 * 8);
  EXPECT_GT(walls, 24 * 6);
}

TEST(IncrementalMap, IsCloseToTheBatchMap) {
  double rho = 0.0, theta = 0.0, centre = 0.0;  // largest differences
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto scans = heptagon::drive({}, seed);
    const ContourMap batch = map_contours(scans, {});
    ContourMapper mapper{MapperParameters{}};
    for (const PosedScan& s : scans) mapper.add(s.scan, s.base_in_map);
    const ContourMap map = mapper.map();
    EXPECT_EQ(map.stamp, scans.back().scan.stamp);
    ASSERT_EQ(map.walls.size(), batch.walls.size()) << "seed " << seed;
    ASSERT_EQ(map.cylinders.size(), batch.cylinders.size()) << "seed " << seed;
    for (const WallEstimate& b : batch.walls) {
      double least = 1e9;
      for (const WallEstimate& w : map.walls) {
        const double d_rho = std::abs(w.wall.rho - b.wall.rho), d_theta = std::abs(wrap(w.wall.theta - b.wall.theta));
        if (d_rho + d_theta >= least) continue;
        least = d_rho + d_theta;
        if (least > 0.05) continue;
        rho = std::max(rho, d_rho);
        theta = std::max(theta, d_theta);
      }
      EXPECT_LT(least, 0.05) << "seed " << seed;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      centre =
          std::max(centre, std::min((map.cylinders[i].cylinder.centre - batch.cylinders[0].cylinder.centre).norm(),
                                    (map.cylinders[i].cylinder.centre - batch.cylinders[1].cylinder.centre).norm()));
    }
  }
  EXPECT_LT(rho, 0.005);
  EXPECT_LT(theta, radians(0.2));
  EXPECT_LT(centre, 0.002);
}

TEST(IncrementalMap, IsAccurateThoughItKeepsFewEchoes) {
  MapperParameters parameters;
  parameters.max_arcs = 1200;  // of about 2200
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    ContourMapper mapper(parameters);
    for (const PosedScan& s : heptagon::drive({}, seed)) mapper.add(s.scan, s.base_in_map);
    tally.add(heptagon::score(mapper.map()));
  }
  EXPECT_EQ(tally.complete, 8);
  EXPECT_LT(tally.rho, 0.0075);
  EXPECT_LT(tally.theta, radians(0.35));
}

}  // namespace
}  // namespace noctule::mapping
