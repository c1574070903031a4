/// The same modules on recorded input.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/angles.hpp"
#include "noctule/contour_map.hpp"
#include "system/pipeline_setup.hpp"

namespace noctule::system_test {
namespace {

/// Where the recordings are that cannot be part of this repository.
fs::path shared_data() {
  const char* shared = std::getenv("NOCTULE_SHARED");
  return fs::path(shared != nullptr ? shared : kSource + "/../shared") / "data";
}

class PipelineRecorded : public ::testing::Test {
 protected:
  /// Runs a pipeline file of config/pipelines and returns its folder of results.
  fs::path run_pipeline(const std::string& name, const std::vector<std::string>& more) {
    const fs::path out = folder_ / name;
    const Outcome outcome = run(command("noctule-pipeline", {kSource + "/config/pipelines/" + name + ".yaml"}, more));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return out;
  }
  std::vector<std::string> arguments(const std::string& name, const fs::path& data, const std::string& seed = "1") {
    return {"--set", "source.path=" + data.string(), "--seed", seed, "--out", (folder_ / name).string()};
  }
  static double metric(const fs::path& results, const std::string& name) {
    const std::string text = read_file(results / "metrics.json"), key = "\"name\":\"" + name + "\",\"value\":";
    const std::size_t at = text.find(key);
    return at == std::string::npos ? std::nan("") : std::strtod(text.c_str() + at + key.size(), nullptr);
  }
  Folder folder_;
};

TEST_F(PipelineRecorded, CorridorHasParallelWallsAtTheRightDistance) {
  const fs::path data = shared_data() / "sonar-corridor";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  for (const char* seed : {"1", "2", "3"}) {
    const fs::path out = run_pipeline("sonar_corridor", arguments("sonar_corridor", data, seed));
    const contour_map map = messages_in<contour_map>(out / "run.lcmlog", "CONTOUR_MAP").back();
    // The longest walls to the left and to the right of the first leg.
    const wall_estimate *left = nullptr, *right = nullptr;
    for (const wall_estimate& wall : map.walls) {
      if (std::abs(std::sin(wall.theta_rad)) < 0.9) continue;
      const wall_estimate*& side = wall.theta_rad > 0.0 ? left : right;
      if (side == nullptr || wall.end_m - wall.begin_m > side->end_m - side->begin_m) side = &wall;
    }
    ASSERT_TRUE(left != nullptr && right != nullptr) << "seed " << seed;
    EXPECT_NEAR(degrees(wrap(left->theta_rad - right->theta_rad - kPi)), 0.0, 1.5) << "seed " << seed;
    EXPECT_NEAR(left->rho_m + right->rho_m, 2.11, 0.05) << "seed " << seed;
  }
}

TEST_F(PipelineRecorded, SightingsOfLandmarksMendDeadReckoning) {
  const fs::path data = shared_data() / "mrclam6";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const fs::path out = run_pipeline("mrclam", arguments("mrclam", data));
  EXPECT_LT(metric(out, "position_rmse"), 0.5 * metric(out, "position_rmse_dead_reckoning"));
  EXPECT_TRUE(std::isfinite(metric(out, "landmark_rmse")));
}

TEST_F(PipelineRecorded, ASweepFromOnePlaceRuns) {
  const fs::path data = shared_data() / "ultrasonic-rooms";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  std::vector<std::string> more = arguments("ultrasonic_rooms", data / "csv/Lvl_1_Room_Map_5.csv");
  more.insert(more.end(), {"--set", "source.outline=" + (data / "room_outline_richards325A.csv").string()});
  EXPECT_TRUE(fs::exists(run_pipeline("ultrasonic_rooms", more) / "report.html"));
}

TEST_F(PipelineRecorded, TheRawlogOfEveryFreshMachine) {
  const fs::path data = "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there (Debian's mrpt-common)";
  const fs::path out = run_pipeline("sena", arguments("sena", data));
  EXPECT_TRUE(fs::exists(out / "report.html"));
  EXPECT_TRUE(fs::exists(out / "map.pgm"));
  EXPECT_FALSE(messages_in<contour_map>(out / "run.lcmlog", "CONTOUR_MAP").back().walls.empty());
}

}  // namespace
}  // namespace noctule::system_test
