#include "sensors/ultrasonic/depth_regions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/limits.hpp"
#include "core/rng.hpp"
#include "statistics/sensors/scene.hpp"

namespace noctule::sensors {
namespace {

/// A stepper's scan from ranges [m], 6 degrees apart from `first` [deg]; 0 is no echo.
UltrasonicScan stepper(const std::vector<double>& ranges, double first = 0.0) {
  UltrasonicScan scan{{}, radians(15.0), 0.02, 4.0, {}};
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double axis = radians(first + 6.0 * static_cast<double>(i));
    scan.beams.push_back({{0.0, 0.0, wrap(axis)}, ranges[i], ranges[i] != 0.0 ? Echo::hit : Echo::none});
  }
  return scan;
}

TEST(DepthRegions, GroupsNeighboursOverASilentPing) {
  DepthRegionFinder finder({});
  const auto& regions = finder.find(stepper({1.001, 1.003, 0.0, 1.002, 0.0, 0.0, 0.0, 2.00, 2.01}));
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].beams, (std::vector<std::int32_t>{0, 1, 3}));
  EXPECT_NEAR(regions[0].heard.range, 1.002, 1e-9);
  EXPECT_NEAR(degrees(regions[0].heard.direction), 8.0, 1e-9);
  EXPECT_NEAR(degrees(regions[0].extent), 18.0, 1e-9);
  EXPECT_EQ(regions[1].beams, (std::vector<std::int32_t>{7, 8}));
}

TEST(DepthRegions, AStrayRangeInsideDoesNotBreakARegion) {
  DepthRegionFinder finder({});
  const auto& regions = finder.find(stepper({1.0, 1.0, 0.4, 1.0}));
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].beams, (std::vector<std::int32_t>{0, 1, 3}));
}

TEST(DepthRegions, NoRegionIsWiderThanTheConeFromBothSides) {
  DepthRegionFinder finder({});
  for (const DepthRegion& r : finder.find(stepper(std::vector<double>(60, 1.0))))
    EXPECT_LE(r.extent, radians(30.0) + 1e-6);
}

TEST(DepthRegions, ConsistOfAllHitsOnce) {
  Rng rng(1);
  DepthRegionFinder finder({});
  std::vector<double> ranges(60);
  for (double& r : ranges) r = rng.uniform() < 0.4 ? 0.0 : rng.uniform(0.5, 1.0);
  std::vector<int> count(60, 0);
  for (const DepthRegion& r : finder.find(stepper(ranges)))
    for (const auto beam : r.beams) ++count[static_cast<std::size_t>(beam)];
  for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(count[i], ranges[i] != 0.0 ? 1 : 0);
}

TEST(DepthRegions, VarianceFallsWithTheNumberOfPings) {
  DepthRegionFinder finder({});
  const auto& regions = finder.find(stepper({1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0}));
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_NEAR(regions[1].heard.range_variance / regions[0].heard.range_variance, 4.0, 1e-9);
  EXPECT_LT(regions[0].heard.direction_variance, regions[1].heard.direction_variance);
}

TEST(DepthRegions, TheOrderOfTheBeamsAndTheHeadingOfTheScanDoNotMatter) {
  Rng rng(2);
  const scene::Object wall = scene::place(scene::Kind::wall, 1.0, radians(30.0), rng);
  const UltrasonicScan scan = scene::scan(wall, {}, {}, 0, rng);
  DepthRegionFinder reference({});
  const auto expected = reference.find(scan);
  ASSERT_FALSE(expected.empty());
  for (int turn = 0; turn < 60; ++turn) {
    UltrasonicScan turned = scan;
    const double angle = radians(6.1 * turn);
    for (auto& beam : turned.beams) beam.sensor_in_base = Pose2{0.0, 0.0, angle} * beam.sensor_in_base;
    std::reverse(turned.beams.begin(), turned.beams.end());
    DepthRegionFinder finder({});
    const auto& regions = finder.find(turned);
    ASSERT_EQ(regions.size(), expected.size());
    for (std::size_t i = 0; i < regions.size(); ++i) {
      EXPECT_NEAR(regions[i].heard.range, expected[i].heard.range, 1e-12);
      EXPECT_NEAR(wrap(regions[i].heard.direction - expected[i].heard.direction - angle), 0.0, 1e-9);
    }
  }
}

TEST(DepthRegions, ARingOfFixedRangersHearsAWallOnce) {
  const Wall wall{1.0, 0.1};
  UltrasonicScan ring{{}, radians(15.0), 0.02, 4.0, {}};
  for (int i = 0; i < 24; ++i) {
    const double axis = radians(15.0 * i);
    const Pose2 sensor = Pose2{0.0, 0.0, axis} * Pose2{0.15, 0.0, 0.0};
    const bool hears = std::abs(wrap(axis - wall.theta)) < radians(15.0);
    ring.beams.push_back({sensor, hears ? wall.distance(sensor.position()) : 0.0, hears ? Echo::hit : Echo::none});
  }
  DepthRegionFinder finder({});
  const auto& regions = finder.find(ring);
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_NEAR(regions[0].heard.range, wall.distance(regions[0].heard.position), 0.005);
}

TEST(NoiseScale, FollowsTheNoiseUpAndDown) {
  Rng rng(3);
  const scene::Object wall = scene::place(scene::Kind::wall, 1.0, radians(10.0), rng);
  DepthRegionFinder finder({});
  scene::Ranger ranger;
  int seq = 0;
  for (const double scale : {1.0, 4.0, 2.0}) {
    ranger.scale = scale;
    for (int i = 0; i < 60; ++i) (void)finder.find(scene::scan(wall, {}, ranger, seq++, rng));
    EXPECT_NEAR(finder.noise_scale() / scale, 1.0, 0.4) << "true scale " << scale;
  }
}

TEST(NoiseScale, KeepsRegionsTogetherAtFourTimesTheNoise) {
  Rng rng(4);
  const scene::Object wall = scene::place(scene::Kind::wall, 1.0, radians(10.0), rng);
  const auto grouped = [&](double scale) {
    DepthRegionFinder finder({});
    scene::Ranger ranger;
    ranger.scale = scale;
    double in_regions = 0.0, hits = 0.0;
    for (int i = 0; i < 200; ++i) {
      for (const DepthRegion& r : finder.find(scene::scan(wall, {}, ranger, i, rng))) {
        hits += static_cast<double>(r.beams.size());
        if (r.beams.size() >= 2) in_regions += static_cast<double>(r.beams.size());
      }
    }
    return in_regions / hits;
  };
  EXPECT_GT(grouped(4.0), 0.95 * grouped(1.0));
}

TEST(DepthRegions, HitsThatCannotBeAreIgnoredAndCounted) {
  UltrasonicScan scan = stepper({1.0, kNan, -1.0, 1.0, 9.0, 0.001, std::numeric_limits<double>::infinity(), 1.0});
  scan.beams[7].sensor_in_base.x = kNan;
  scan.beams.push_back({{kNan, 0.0, 0.0}, kNan, Echo::invalid});  // says itself that it is nothing
  DepthRegionFinder finder({});
  const auto& regions = finder.find(scan);
  EXPECT_EQ(finder.ignored_beams(), 6);
  ASSERT_EQ(regions.size(), 2u);  // beams 0 and 3 are 18 degrees apart
  for (const DepthRegion& r : regions) EXPECT_TRUE(std::isfinite(r.heard.range));
  EXPECT_TRUE(finder.find(stepper({})).empty());
}

TEST(DepthRegions, RefusesAConeOrLimitsThatMakeNoSense) {
  const auto broken = [](auto change) {
    UltrasonicScan scan = stepper({1.0});
    change(scan);
    return scan;
  };
  DepthRegionFinder finder({});
  for (const double bad : {0.0, -1.0, 4.0, kNan})
    EXPECT_THROW((void)finder.find(broken([&](auto& s) { s.half_angle = bad; })), InputError);
  for (const double bad : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW((void)finder.find(broken([&](auto& s) { s.max_range = bad; })), InputError);
  EXPECT_THROW((void)finder.find(broken([&](auto& s) { s.min_range = kNan; })), InputError);
}

}  // namespace
}  // namespace noctule::sensors
