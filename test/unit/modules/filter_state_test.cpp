/// Files of filter states, and pipelines that go on from them or begin on their maps.
#include "modules/filter_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.hpp"
#include "modules/pipeline.hpp"
#include "report/files.hpp"

namespace noctule::modules {
namespace {

namespace fs = std::filesystem;

class FilterStateTest : public ::testing::Test {
 protected:
  FilterStateTest() { fs::create_directories(dir_); }
  ~FilterStateTest() override { fs::remove_all(dir_); }

  [[nodiscard]] fs::path file(const std::string& name) const { return dir_ / name; }

  /// A square among twelve landmarks.
  [[nodiscard]] PipelineParameters square(int loops = 1) const {
    PipelineParameters p;
    sim::LandmarkWorldParameters world;
    world.world.waypoints = {{10, 0}, {10, 10}, {0, 10}, {0, 0}};
    world.world.landmarks = {{5, 3},   {13, 2}, {6, 7},  {12, 13}, {-3, 5},  {2, 14},
                             {-2, -3}, {8, -4}, {15, 8}, {3, 5},   {-4, 12}, {9, 17}};
    world.world.loops = loops;
    world.vehicle.speed = 1.0;
    world.vehicle.wheelbase = 0.5;
    world.vehicle.waypoint_radius = 0.5;
    world.vehicle.speed_sd = 0.05;
    world.sensor.max_range = 12.0;
    p.source = world;
    filters::FastSlam2Parameters filter;
    filter.particles = 30;
    p.slam.emplace();
    p.slam->filter = filter;
    return p;
  }

  /// \return warnings
  static std::vector<std::string> run(const PipelineParameters& p, int steps = -1) {
    bus::Bus bus("memq://");
    Pipeline pipeline(bus, p, Threads{});
    while (steps-- != 0 && pipeline.step()) continue;
    pipeline.stop();
    return pipeline.data().warnings;
  }

  template <class Load>
  void expect_refused(const fs::path& path, const std::string& what, const Load& load) {
    try {
      load();
      ADD_FAILURE() << "not refused: " << what;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    }
  }

  fs::path dir_ = fs::temp_directory_path() /
                  ("noctule_state_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) + "_" +
                   std::to_string(reinterpret_cast<std::uintptr_t>(this)));
};

TEST_F(FilterStateTest, ARunInTwoPartsEndsAsOneRun) {
  auto whole = square(), first = square(), second = square();
  whole.slam->save_state = file("whole");
  first.slam->save_state = file("half");
  second.slam->load_state = file("half");
  second.slam->save_state = file("both");
  run(whole);
  run(first, 777);
  EXPECT_NE(report::read_file(file("half")), report::read_file(file("whole")));
  run(second);
  EXPECT_TRUE(report::read_file(file("both")) == report::read_file(file("whole")));
}

TEST_F(FilterStateTest, RefusesWhatIsNoStateOfThisFilter) {
  auto p = square();
  p.slam->save_state = file("state");
  run(p, 500);
  const std::string content = report::read_file(file("state"));
  const auto load = [&](const filters::SlamFilterParameters& parameters, std::uint64_t seed) {
    const auto filter = filters::make_slam_filter(parameters, seed, {});
    load_filter_state(file("state"), *filter, {parameters, seed});
  };
  const auto& own = p.slam->filter;
  load(own, p.seed);

  expect_refused(file("state"), "seed 2", [&] { load(own, 2); });
  auto other = std::get<filters::FastSlam2Parameters>(own);
  other.particles = 31;
  expect_refused(file("state"), "'particles: 31', got one with 'particles: 30'", [&] { load(other, p.seed); });
  expect_refused(file("state"), "ekf_slam", [&] { load(filters::EkfSlamParameters{}, p.seed); });

  for (std::size_t size = 0; size < content.size(); size += 1 + content.size() / 50) {
    report::write_file(file("state"), content.substr(0, size));
    expect_refused(file("state"), "expected", [&] { load(own, p.seed); });
  }
  for (std::size_t at = 0; at < content.size(); at += 1 + content.size() / 100) {
    std::string damaged = content;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    report::write_file(file("state"), damaged);
    expect_refused(file("state"), "expected", [&] { load(own, p.seed); });
  }
  std::string later = content;
  later[std::string_view("noctule filter state\n").size()] = 9;
  report::write_file(file("state"), later);
  expect_refused(file("state"), "version 9", [&] { load(own, p.seed); });
  expect_refused(file("none"), "expected a file that can be read",
                 [&] { static_cast<void>(load_state_map(file("none"))); });
}

TEST_F(FilterStateTest, ALaterRunFindsTheRobotOnTheMap) {
  auto mapping = square(2);
  mapping.slam->save_state = file("map");
  run(mapping);
  for (const bool known : {true, false}) {
    for (std::uint64_t seed = 11; seed <= 13; ++seed) {
      auto later = square();
      later.seed = seed;
      auto& world = std::get<sim::LandmarkWorldParameters>(later.source);
      world.sensor.known_ids = known;
      world.world.start = {9.0, 6.0, 2.0};  // which the filter is not told
      later.slam->prior.emplace();
      later.slam->prior->map = file("map");
      later.slam->prior->localisation.particles = 5000;
      later.slam->prior->localisation.view_range = 12.0;
      later.slam->save_state = file("later");
      for (const std::string& w : run(later)) EXPECT_EQ(w.find("not found"), std::string::npos) << w;
      const LandmarkMap map = load_state_map(file("later"));
      int near = 0;
      for (const Vector2& truth : world.world.landmarks) {
        near += std::ranges::any_of(
            map.landmarks, [&](const LandmarkEstimate& e) { return (e.parameters.head<2>() - truth).norm() < 0.6; });
      }
      EXPECT_GE(near, 10) << known << ", seed " << seed;
      EXPECT_LE(map.landmarks.size(), 14u);
    }
  }
}

}  // namespace
}  // namespace noctule::modules
