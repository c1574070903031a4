#include "mapping/sonar_arc.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "core/error.hpp"
#include "core/limits.hpp"
#include "core/rng.hpp"
#include "mapping/arc_store.hpp"
#include "mapping/contour_mapper.hpp"

namespace noctule::mapping {
namespace {

UltrasonicScan scan_of(std::vector<UltrasonicBeam> beams) {
  return {.stamp = {.utime = 5, .seq = 7},
          .half_angle = radians(15.0),
          .min_range = 0.02,
          .max_range = 4.0,
          .beams = std::move(beams)};
}

UltrasonicBeam hit(double yaw, double range) {
  return {{0.1, 0.0, yaw}, range, Echo::hit};
}

/// The text of the InputError that `call` throws.
template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(ArcReader, PutsHitsIntoTheMapAndLeavesTheRest) {
  ArcReader reader({}, 0.05, 10.0);
  std::vector<SonarArc> arcs;
  reader.read(scan_of({hit(0.0, 1.0), {{0, 0, 1}, 0.0, Echo::none}, {{0, 0, 1}, 0.0, Echo::saturated}}),
              {1.0, 2.0, kPi / 2.0}, arcs);
  ASSERT_EQ(arcs.size(), 1U);
  EXPECT_NEAR((arcs[0].sensor - Vector2(1.0, 2.1)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((arcs[0].axis - Vector2(0.0, 1.0)).norm(), 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(arcs[0].sigma, 0.008);
}

TEST(ArcReader, CountsNearbyScansAsOneStop) {
  ArcReader reader({}, 0.05, 10.0);
  std::vector<SonarArc> arcs;
  for (const double x : {0.0, 0.0, 0.03, 0.12, 0.14, 0.24}) reader.read(scan_of({hit(0.0, 1.0)}), {x, 0.0, 0.0}, arcs);
  const std::vector<int> expected{0, 0, 0, 1, 1, 2};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(arcs[i].stop, expected[i]);
}

TEST(ArcReader, RefusesWhatIsNotANumber) {
  std::vector<SonarArc> arcs;
  ArcReader reader({}, 0.05, 10.0);
  const auto read = [&](const UltrasonicScan& scan, const Pose2& pose) {
    return refusal([&] { reader.read(scan, pose, arcs); });
  };
  EXPECT_EQ(read(scan_of({hit(0.0, 1.0)}), {kNan, 0.0, 0.0}),
            "mapping: scan 7: base_in_map: expected finite numbers, got (nan, 0, 0)");
  EXPECT_EQ(read(scan_of({hit(0.0, 1.0), hit(0.1, -1.0)}), {}),
            "mapping: scan 7: beam 1: range: expected a positive number of metres, got -1");
  EXPECT_NE(read(scan_of({hit(kNan, 1.0)}), {}), "");
  EXPECT_NE(read(scan_of({hit(0.0, kNan)}), {}), "");
  auto scan = scan_of({hit(0.0, 1.0)});
  scan.half_angle = 0.0;
  EXPECT_NE(read(scan, {}), "");
  EXPECT_TRUE(arcs.empty());
}

TEST(NoiseScale, FollowsTheNoiseWhateverOtherSurfacesTheConesSee) {
  Rng rng(1);
  NoiseScale scale(10.0);
  EXPECT_EQ(scale.value(), 1.0);
  for (const double truth : {1.0, 4.0, 2.0}) {
    for (int i = 0; i < 64; ++i) {
      const double range = rng.uniform() < 0.15 ? 2.0 : 1.0;  // an edge in the scene
      scale.observe(range + truth * 0.01 * rng.normal(), 1.0 + truth * 0.01 * rng.normal(), 0.01);
    }
    EXPECT_GT(scale.value(), 0.7 * truth);
    EXPECT_LT(scale.value(), 1.7 * truth);
  }
  for (int i = 0; i < 64; ++i) scale.observe(1.0, 3.0, 0.01);
  EXPECT_EQ(scale.value(), 10.0);
}

TEST(DirectPoints, LieOnTheAxes) {
  const std::vector<PosedScan> scans{{scan_of({hit(0.0, 1.0), {{0, 0, 0}, 0.0, Echo::none}}), {1.0, 0.0, kPi}}};
  const auto points = direct_points(scans);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR((points[0] - Vector2(-0.1, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_TRUE(direct_points({}).empty());
}

TEST(ContourMapper, GivesAnEmptyMapWhereNothingWasHeard) {
  const ContourMap batch = map_contours({}, {});
  EXPECT_TRUE(batch.walls.empty() && batch.cylinders.empty() && batch.points.empty());
  ContourMapper mapper{MapperParameters{}};
  EXPECT_TRUE(mapper.map().walls.empty());
  mapper.add(scan_of({{{0, 0, 0}, 0.0, Echo::none}}), {});
  EXPECT_TRUE(mapper.map().walls.empty());
  EXPECT_EQ(mapper.map().stamp.seq, 7);
  EXPECT_TRUE(map_contours(std::vector<PosedScan>{{scan_of({}), {}}}, {}).walls.empty());
}

TEST(ContourMapper, RefusesBadPosesAndGoesOn) {
  ContourMapper mapper{MapperParameters{}};
  EXPECT_THROW(mapper.add(scan_of({hit(0.0, 1.0)}), {0.0, kNan, 0.0}), InputError);
  EXPECT_THROW((void)map_contours(std::vector<PosedScan>{{scan_of({hit(0.0, 1.0)}), {kNan, 0.0, 0.0}}}, {}),
               InputError);
  mapper.add(scan_of({hit(0.0, 1.0)}), {});
  EXPECT_EQ(mapper.map().stamp.seq, 7);
}

TEST(ArcStore, NeverGivesOutMoreThanItsSlotsAndThinsTheCrowd) {
  constexpr int capacity = 200;
  ArcStore store(capacity);
  std::vector<int> kept(capacity, -1);
  Rng rng(3);
  for (int i = 0; i < 5000; ++i) {
    const bool rare = i < 60;  // seen early, from elsewhere, never again
    const double x = rare ? 3.0 + 0.01 * i : rng.uniform(0.0, 0.2);
    const int slot = store.place({.sensor = {x, 0.0}, .axis = {0.0, 1.0}, .range = 1.0});
    ASSERT_GE(slot, 0);
    ASSERT_LT(slot, capacity);
    kept[static_cast<std::size_t>(slot)] = i;
  }
  int rare = 0, late = 0;
  for (const int i : kept) {
    rare += i < 60 ? 1 : 0;
    late += i > 2500 ? 1 : 0;
  }
  EXPECT_EQ(rare, 60);
  EXPECT_GT(late, 40);
}

}  // namespace
}  // namespace noctule::mapping
