#include "filters/slam/landmark_maps.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/rng.hpp"
#include "particle/resampling.hpp"

namespace noctule::filters {
namespace {

using DeepMaps = std::vector<std::vector<PointLandmark>>;

bool same(const LandmarkMaps& maps, const DeepMaps& deep) {
  for (std::size_t i = 0; i < deep.size(); ++i) {
    if (maps.size(i) != deep[i].size()) return false;
    for (std::size_t k = 0; k < deep[i].size(); ++k) {
      const PointLandmark &a = maps.at(i, k), &b = deep[i][k];
      if (a.x != b.x || a.xx != b.xx || a.id != b.id || a.observations != b.observations) return false;
    }
  }
  return true;
}

/// Random histories of writes, births, deaths and resamplings, beside maps that are copied whole.
void live(LandmarkMaps& maps, DeepMaps& deep, Rng& rng, int steps, std::size_t births, int threads) {
  const std::size_t n = deep.size();
  std::int64_t id = 0;
  for (int step = 0; step < steps; ++step) {
    std::vector<std::vector<std::int32_t>> touched(n);
    std::vector<std::size_t> born(n);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t t = rng.index(4); t > 0 && !deep[i].empty(); --t) {
        touched[i].push_back(static_cast<std::int32_t>(rng.index(deep[i].size())));
      }
      touched[i].push_back(-1);
      born[i] = rng.index(births + 1);
      maps.own(i, touched[i]);
      maps.reserve(i, born[i]);
    }
    maps.copy_pages(threads);
    for (std::size_t i = 0; i < n; ++i) {
      for (const std::int32_t slot : touched[i]) {
        if (slot < 0) continue;
        const auto k = static_cast<std::size_t>(slot);
        deep[i][k].x = rng.uniform();
        ++deep[i][k].observations;
        maps.writable(i, k).x = deep[i][k].x;
        ++maps.writable(i, k).observations;
      }
      for (std::size_t b = 0; b < born[i]; ++b) {
        PointLandmark m;
        m.id = id++;
        m.x = rng.uniform();
        m.xx = rng.uniform();
        deep[i].push_back(m);
        maps.append(i, m);
      }
      if (!touched[i].empty() && touched[i][0] >= 0 && rng.index(8) == 0) {
        const auto k = static_cast<std::size_t>(touched[i][0]);
        deep[i][k] = deep[i].back();
        deep[i].pop_back();
        maps.remove(i, k);
      }
    }
    ASSERT_TRUE(same(maps, deep)) << step;
    if (rng.index(3) == 0) continue;
    std::vector<double> weights(n);
    for (double& w : weights) w = std::pow(rng.uniform(), 4.0);
    std::vector<std::uint32_t> counts(n), ancestors(n);
    particle::make_resampler(particle::Resampling::systematic)
        ->offspring(weights, static_cast<std::uint32_t>(n), rng, counts);
    particle::place_in_slots(counts, ancestors);
    const DeepMaps before = deep;
    for (std::size_t i = 0; i < n; ++i) deep[i] = before[ancestors[i]];
    maps.resample(ancestors);
    ASSERT_TRUE(same(maps, deep)) << step;
  }
}

TEST(LandmarkMaps, EqualDeepCopiesOverRandomHistories) {
  for (const MapStorage storage : {MapStorage::flat, MapStorage::shared, MapStorage::automatic}) {
    for (const int threads : {1, 2}) {
      Rng rng(1, 2, static_cast<std::uint64_t>(threads));
      LandmarkMaps maps(17, storage);
      DeepMaps deep(17);
      live(maps, deep, rng, 120, 12, threads);
      EXPECT_EQ(maps.shares(), storage != MapStorage::flat);
      EXPECT_GT(maps.largest(), 600u);  // more than one table of pages
    }
  }
}

/// Memory of shared maps grows with what differs between particles, that of flat ones with particles x landmarks.
TEST(LandmarkMaps, SharedMemoryIsThatOfOneMapAndOfWhatDiffers) {
  constexpr std::size_t n = 200, m = 2000;
  LandmarkMaps maps(n, MapStorage::shared);
  maps.reserve(0, m);
  for (std::size_t k = 0; k < m; ++k) maps.append(0, {});
  const std::size_t one = maps.bytes();
  const std::vector<std::uint32_t> all_from_first(n, 0);
  maps.resample(all_from_first);
  EXPECT_LT(maps.bytes(), one + n * 64);
  const std::int32_t slot[] = {1000};
  for (std::size_t i = 0; i < n; ++i) maps.own(i, slot);
  maps.copy_pages(1);
  EXPECT_LT(maps.bytes(), one + n * 1200);
  EXPECT_GT(n * m * sizeof(PointLandmark), 20 * maps.bytes());
  // All of it comes back.
  maps.resample(all_from_first);
  EXPECT_LT(maps.bytes(), one + n * 64);
}

}  // namespace
}  // namespace noctule::filters
