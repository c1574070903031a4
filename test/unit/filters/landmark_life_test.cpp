#include "filters/slam/landmark_life.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "filters/slam/make_slam_filter.hpp"

namespace noctule::filters {
namespace {

/// A robot that stands still and sees these points, unnamed and without noise.
LandmarkDetections see(std::int64_t seq, const std::vector<Vector2>& points) {
  LandmarkDetections d;
  d.stamp = {seq * 100000, seq};
  for (const Vector2& p : points) {
    d.detections.push_back({.range = p.norm(),
                            .bearing = std::atan2(p.y(), p.x()),
                            .covariance = Vector2(1e-3, 1e-3).asDiagonal().toDenseMatrix()});
  }
  return d;
}

std::vector<SlamFilterParameters> filters_with(const LandmarkLifeParameters& life) {
  std::vector<SlamFilterParameters> result{FastSlam1Parameters{}, FastSlam2Parameters{}, UFastSlamParameters{},
                                           PsoUFastSlamParameters{}, EkfSlamParameters{}};
  for (auto& p : result) {
    std::visit(
        [&](auto& q) {
          if constexpr (requires { q.life; }) q.life = life;
          if constexpr (requires { q.storage; }) {
            q.particles = 5;
            q.storage = MapStorage::shared;
          }
        },
        p);
  }
  return result;
}

TEST(LandmarkLife, GhostsAreForgottenAndWhatIsSeenAgainIsConfirmed) {
  for (const auto& p : filters_with({.view_range = 10.0, .view_half_angle = radians(90.0)})) {
    const auto filter = make_slam_filter(p, 1, {});
    const Vector2 real(3.0, 1.0), ghost(4.0, -2.0), behind(-3.0, 0.0), far(20.0, 0.0);
    filter->update(see(0, {real, ghost, behind, far}));
    EXPECT_EQ(filter->map().landmarks.size(), 0u);  // none is sure yet
    for (int k = 1; k < 6; ++k) filter->update(see(k, {real}));
    EXPECT_EQ(filter->map().landmarks.size(), 1u);
    // Those out of view are still remembered: seen once more, they are confirmed, while the ghost starts anew.
    filter->update(see(6, {real, ghost, behind, far}));
    const auto map = filter->map().landmarks;
    ASSERT_EQ(map.size(), 3u);
    for (const Vector2& point : {real, behind, far}) {
      EXPECT_TRUE(std::ranges::any_of(
          map, [&](const auto& m) { return (m.parameters.template head<2>() - point).norm() < 0.01; }));
    }
  }
}

TEST(LandmarkLife, DuplicatesBecomeOneWithTheInformationOfBoth) {
  LandmarkMaps maps(1, MapStorage::shared);
  maps.reserve(0, 3);
  PointLandmark a;
  a.set({2.0, 0.0}, 0.04 * Matrix2::Identity());
  a.id = -2;
  a.observations = 3;
  PointLandmark other = a, b = a;
  other.set({5.0, 0.0}, 0.04 * Matrix2::Identity());
  other.id = -3;
  b.set({2.1, 0.0}, 0.01 * Matrix2::Identity());
  b.id = -4;
  for (const auto& m : {a, other, b}) maps.append(0, m);
  LandmarkScan scan;
  scan.sightings.resize(1);
  const std::int32_t slots[] = {0};
  const LandmarkLifeParameters life{.merge_gate = 4.0};
  LifeEvents events;
  find_events(scan, {}, maps, 0, life, slots, events);
  EXPECT_EQ(events.survivor, 0);
  EXPECT_EQ(events.duplicate, 2);
  apply_events(maps, 0, life, slots, events);
  ASSERT_EQ(maps.size(0), 2u);
  EXPECT_NEAR(maps.at(0, 0).x, 2.08, 1e-12);  // weighted by information: (25 * 2 + 100 * 2.1) / 125
  EXPECT_NEAR(maps.at(0, 0).xx, 1.0 / 125.0, 1e-12);
  EXPECT_EQ(maps.at(0, 0).observations, 6);
  EXPECT_EQ(maps.at(0, 1).id, -3);
}

}  // namespace
}  // namespace noctule::filters
