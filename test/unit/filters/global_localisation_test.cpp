/// A robot that is set down somewhere on a map of an earlier run finds itself, and goes on.
#include "filters/localisation/global_localisation.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "filters/slam/make_slam_filter.hpp"
#include "unit/filters/landmark_world.hpp"

namespace noctule::filters {
namespace {

using test::drive;
using test::feed;
using test::small_web;

/// How many of so many robots, set down at different places of a map, are where they think once they think so; and what
/// the filter makes of it, which then goes on.
struct Count {
  int settled = 0, right = 0, kept = 0;
};
Count set_down(const SlamFilterParameters& p, bool known, DetectionKind kind, int runs) {
  const auto world = small_web();
  SlamFilterParameters mapper = FastSlam2Parameters{};
  const auto first = make_slam_filter(mapper, 1, {});
  auto mapping = drive(world, 60.0, 1);
  for (const auto& step : mapping) feed(*first, step);
  LandmarkMap map = first->map();
  if (!known) {
    for (std::size_t k = 0; k < map.landmarks.size(); ++k) map.landmarks[k].id = -2 - static_cast<std::int64_t>(k);
  }
  Count count;
  for (int seed = 1; seed <= runs; ++seed) {
    auto run = drive(world, 60.0, static_cast<std::uint64_t>(seed + 100), 1.0, known);
    GlobalLocalisationParameters parameters;
    parameters.particles = 10000;
    GlobalLocalisation where(map, parameters, {}, static_cast<std::uint64_t>(seed));
    const auto filter = make_slam_filter(p, static_cast<std::uint64_t>(seed), {});
    const auto from = static_cast<std::size_t>(20 * (seed % 10));
    bool settled = false;
    std::size_t last = run.size() - 1;
    for (std::size_t i = from; i < run.size() && i < from + 100; ++i) {
      auto& step = run[i];
      last = i;
      for (auto& d : step.detections.detections) {
        if (kind == DetectionKind::range_bearing) continue;
        d.kind = kind;
        d.range = 0.0;
        d.covariance(0, 0) = 0.0;
      }
      if (settled) {
        feed(*filter, step);
        continue;
      }
      feed(where, step);
      if (!where.settled()) continue;
      settled = true;
      ++count.settled;
      count.right += difference(where.estimate().pose, step.truth).head<2>().norm() < 1.5;
      filter->begin_on(map, where.cloud(1000));
    }
    if (settled) count.kept += difference(filter->estimate().pose, run[last].truth).head<2>().norm() < 1.5;
  }
  return count;
}

TEST(GlobalLocalisation, FindsTheRobotOnAMapOfAnEarlierRun) {
  constexpr int runs = 10;
  FastSlam2Parameters fast;
  ParticleSlamParameters pf;
  fast.particles = pf.particles = 50;
  for (const SlamFilterParameters& p :
       {SlamFilterParameters(fast), SlamFilterParameters(pf), SlamFilterParameters(EkfSlamParameters{})}) {
    for (const bool known : {true, false}) {
      const Count count = set_down(p, known, DetectionKind::range_bearing, runs);
      EXPECT_GE(count.settled, runs - 1) << p.index() << known;
      EXPECT_GE(count.right, runs - 1) << p.index() << known;
      EXPECT_GE(count.kept, runs - 1) << p.index() << known;
    }
  }
  const Count bearings = set_down(fast, true, DetectionKind::bearing_only, runs);
  EXPECT_GE(bearings.right, runs - 2);
}

TEST(GlobalLocalisation, RefusesAMapOfNothing) {
  EXPECT_THROW(GlobalLocalisation({}, {}, {}, 1), InputError);
  LandmarkMap walls;
  walls.landmarks.push_back({.kind = LandmarkKind::wall});
  EXPECT_THROW(GlobalLocalisation(walls, {}, {}, 1), InputError);
}

}  // namespace
}  // namespace noctule::filters
