/// A filter that reads the state of another goes on as that one would, bit by bit.
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "filters/slam/make_slam_filter.hpp"
#include "unit/filters/landmark_world.hpp"
#include "unit/filters/recording.hpp"

namespace noctule::filters {
namespace {

using test::drive;
using test::feed;
using test::LandmarkScanStep;
using test::small_web;

std::string state_of(SlamFilter& filter) {
  StateArchive archive;
  filter.transfer(archive);
  return archive.bytes();
}

void expect_same(SlamFilter& a, SlamFilter& b, std::size_t kind) {
  EXPECT_EQ(state_of(a), state_of(b)) << kind;
  EXPECT_EQ(a.estimate().pose, b.estimate().pose) << kind;
  EXPECT_EQ(a.estimate().covariance, b.estimate().covariance) << kind;
  const auto map_a = a.map().landmarks, map_b = b.map().landmarks;
  ASSERT_EQ(map_a.size(), map_b.size()) << kind;
  for (std::size_t k = 0; k < map_a.size(); ++k) {
    EXPECT_EQ(map_a[k].id, map_b[k].id);
    EXPECT_EQ(map_a[k].parameters, map_b[k].parameters);
    EXPECT_EQ(map_a[k].covariance, map_b[k].covariance);
  }
  const auto path_a = a.path().poses, path_b = b.path().poses;
  ASSERT_EQ(path_a.size(), path_b.size());
  for (std::size_t k = 0; k < path_a.size(); ++k) EXPECT_EQ(path_a[k].pose, path_b[k].pose);
}

/// Parameters of every filter, and of every way that they store maps.
std::vector<SlamFilterParameters> all_filters() {
  std::vector<SlamFilterParameters> result{
      ParticleSlamParameters{}, VbParticleSlamParameters{}, EmParticleSlamParameters{},
      FastSlam1Parameters{},    FastSlam2Parameters{},      UFastSlamParameters{},
      PsoUFastSlamParameters{}, WocpfParameters{},          EkfSlamParameters{}};
  FastSlam1Parameters each;
  each.sample = Sampling::odometry;
  each.storage = MapStorage::shared;
  each.life.emplace();
  each.life->merge_gate = 4.0;
  result.emplace_back(each);
  FastSlam1Parameters optimised;
  optimised.sample = Sampling::odometry;
  optimised.optimise = Optimisation::apf;
  optimised.noise = EmNoiseParameters{};
  result.emplace_back(optimised);
  FastSlam2Parameters learning;
  learning.optimise = Optimisation::apf;
  learning.noise = SightingVbNoiseParameters{};
  result.emplace_back(learning);
  for (auto& p : result) {
    std::visit(
        [](auto& q) {
          if constexpr (requires { q.particles; }) q.particles = 25;
        },
        p);
  }
  return result;
}

/// Bearings, ranges and both, with and without names, so that landmarks live, die and are tracked.
std::vector<LandmarkScanStep> varied_run() {
  auto run = drive(small_web(), 10.0, 3);
  Rng rng(3);
  for (std::size_t i = 0; i < run.size(); ++i) {
    for (auto& d : run[i].detections.detections) {
      d.kind = static_cast<DetectionKind>(rng.index(3));
      if (d.id % 3 == 0) d.id = -1;
    }
  }
  return run;
}

TEST(State, ARestartGoesOnBitByBit) {
  const auto run = varied_run();
  const auto filters = all_filters();
  for (std::size_t kind = 0; kind < filters.size(); ++kind) {
    const auto whole = make_slam_filter(filters[kind], 5, {});
    auto halves = make_slam_filter(filters[kind], 5, {});
    for (std::size_t i = 0; i < run.size(); ++i) {
      feed(*whole, run[i]);
      for (std::size_t k = 0; k < run[i].odometry.size(); ++k) {
        halves->predict(run[i].odometry[k]);
        if (i % 9 != 4 || k != 3) continue;
        const std::string bytes = state_of(*halves);
        halves = make_slam_filter(filters[kind], 5, {});
        StateArchive archive(bytes);
        halves->transfer(archive);
        archive.expect_end();
        EXPECT_EQ(state_of(*halves), bytes) << kind;
      }
      halves->update(run[i].detections);
    }
    expect_same(*whole, *halves, kind);
  }
}

TEST(State, OfFiltersThatHear) {
  ParticleSlamParameters fixed;
  VbParticleSlamParameters vb;
  EmParticleSlamParameters em;
  fixed.smooth_path = SmoothPath::all;
  fixed.particles = vb.particles = em.particles = 20;
  std::vector<Pose2> path;
  for (int k = 0; k < 12; ++k) path.push_back({0.08 * k, 0.02 * k, 0.05 * k});
  const auto run = test::record(test::corner_scene(), path, test::noisy_drive(), 4);
  for (const SlamFilterParameters& p :
       {SlamFilterParameters(fixed), SlamFilterParameters(vb), SlamFilterParameters(em)}) {
    const auto whole = make_slam_filter(p, 5, {});
    auto halves = make_slam_filter(p, 5, {});
    for (std::size_t i = 0; i < run.heard.size(); ++i) {
      if (i == run.heard.size() / 2) {
        const std::string bytes = state_of(*halves);
        halves = make_slam_filter(p, 5, {});
        StateArchive archive(bytes);
        halves->transfer(archive);
      }
      for (SlamFilter* filter : {whole.get(), halves.get()}) {
        filter->predict(run.odometry[i]);
        filter->update(run.heard[i].scan, run.features[i]);
      }
    }
    expect_same(*whole, *halves, p.index());
  }
}

TEST(State, BytesThatAreNoStateAreRefused) {
  const auto run = varied_run();
  for (const auto& p : all_filters()) {
    const auto filter = make_slam_filter(p, 5, {});
    for (std::size_t i = 0; i < 20; ++i) feed(*filter, run[i]);
    const std::string bytes = state_of(*filter);
    for (const std::size_t size : {std::size_t{0}, std::size_t{5}, bytes.size() / 2, bytes.size() - 1}) {
      StateArchive archive(std::span(bytes.data(), size));
      EXPECT_THROW(make_slam_filter(p, 5, {})->transfer(archive), InputError) << p.index() << ", " << size;
    }
    StateArchive archive(std::span<const char>(bytes.data(), bytes.size()));
    make_slam_filter(p, 5, {})->transfer(archive);
    archive.expect_end();
    const std::string longer = bytes + "x";
    StateArchive too_long{std::span<const char>(longer)};
    make_slam_filter(p, 5, {})->transfer(too_long);
    EXPECT_THROW(too_long.expect_end(), InputError);
  }
}

}  // namespace
}  // namespace noctule::filters
