/// The worlds and robots in config/.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "config/config.hpp"
#include "sim/landmark_map.hpp"
#include "sim/landmark_world.hpp"
#include "sim/simulator.hpp"
#include "unit/sim/heptagon.hpp"

namespace noctule::sim {
namespace {

const std::filesystem::path kConfig = std::filesystem::path(NOCTULE_SOURCE_DIR) / "config";

/// Equal but for rounding and for names that stand for their numbers.
void expect_equal(const RoomParameters& a, const RoomParameters& b) {
  ASSERT_EQ(a.walls.size(), b.walls.size());
  for (std::size_t i = 0; i < a.walls.size(); ++i) {
    EXPECT_EQ(a.walls[i].name, std::to_string(i + 1));
    EXPECT_NEAR(a.walls[i].rho, b.walls[i].rho, 1e-15);
    EXPECT_NEAR(a.walls[i].theta, b.walls[i].theta, 1e-15);
  }
  ASSERT_EQ(a.cylinders.size(), b.cylinders.size());
  for (std::size_t i = 0; i < a.cylinders.size(); ++i) {
    EXPECT_EQ(a.cylinders[i].name, std::to_string(i + 1));
    EXPECT_LT((a.cylinders[i].centre - b.cylinders[i].centre).norm(), 1e-15);
    EXPECT_NEAR(a.cylinders[i].radius, b.cylinders[i].radius, 1e-15);
  }
  EXPECT_TRUE(a.corners.empty());
}

TEST(DataFiles, HeptagonIsTheRoomOfThePaper) {
  const auto world = config::load<WorldParameters>(kConfig / "worlds/heptagon.yaml");
  const WorldParameters expected = test::heptagon();
  EXPECT_EQ(world.name, "heptagon");
  expect_equal(world.room, expected.room);
  EXPECT_EQ(config::dump(world.path), config::dump(expected.path));
}

TEST(DataFiles, Paper002IsTheRobotOfThePaper) {
  const auto robot = config::load<RobotParameters>(kConfig / "robots/paper002.yaml");
  EXPECT_EQ(config::dump(robot), config::dump(test::paper002()));
}

TEST(DataFiles, EasyAndHardDifferInTheOdometryAlone) {
  for (const auto& [name, noise] : {std::pair{"easy", models::OdometryNoise{0.03, radians(1), radians(0.5)}},
                                    std::pair{"hard", models::OdometryNoise{0.05, radians(2), radians(1)}}}) {
    const auto file = kConfig / ("robots/paper002_" + std::string(name) + ".yaml");
    RobotParameters expected = test::paper002();
    expected.name += "_" + std::string(name);
    expected.odometry = noise;
    EXPECT_EQ(config::dump(config::load<RobotParameters>(file)), config::dump(expected));
  }
}

TEST(DataFiles, EveryRobotCanRunInEveryWorld) {
  for (const auto& world : std::filesystem::directory_iterator(kConfig / "worlds")) {
    if (world.is_directory()) continue;  // worlds of landmarks, not rooms
    for (const auto& robot : std::filesystem::directory_iterator(kConfig / "robots")) {
      EXPECT_NO_THROW(
          Simulator(config::load<WorldParameters>(world.path()), config::load<RobotParameters>(robot.path()), 1))
          << world << " " << robot;
    }
  }
}

TEST(DataFiles, LandmarkWorldsHaveTheStatedCountsAndCanBeDriven) {
  struct Stated {
    const char* name;
    std::size_t landmarks;
    double scale;
    SteeredVehicleParameters vehicle;
  };
  const Stated slow{"small_web", 35, 0.35, {.speed = 1.0, .wheelbase = 1.0}};
  for (const Stated& stated : {Stated{"web", 35, 1.0, {}}, Stated{"web135", 135, 1.0, {}}, slow}) {
    const auto file = kConfig / "worlds/landmarks" / (std::string(stated.name) + ".yaml");
    const auto world = config::load<LandmarkMapParameters>(file);
    EXPECT_EQ(world.name, stated.name);
    EXPECT_EQ(world.scale, stated.scale);
    const LandmarkMapPlaces places = places_of(world);
    EXPECT_EQ(places.landmarks.size(), stated.landmarks);
    EXPECT_EQ(places.waypoints.size(), 17u);
    const auto steps = plan_steps(places.start, places.waypoints, 2, stated.vehicle);
    std::size_t seen = 0;
    for (const KnownLandmark& l : places.landmarks) {
      seen += std::ranges::any_of(steps, [&](const ControlStep& s) { return sees(s.pose, l.position, 30.0); });
    }
    EXPECT_GT(seen, 0.75 * static_cast<double>(stated.landmarks)) << stated.name;
  }
}

}  // namespace
}  // namespace noctule::sim
