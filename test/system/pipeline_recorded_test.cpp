/// The same modules on recorded input.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "convert/convert.hpp"
#include "core/angles.hpp"
#include "eval/corridor.hpp"
#include "noctule/contour_map.hpp"
#include "noctule/path_estimate.hpp"
#include "noctule/ultrasonic_scan.hpp"
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

TEST_F(PipelineRecorded, CorridorHasParallelWallsAtTheRightDistanceAndACorner) {
  const fs::path data = shared_data() / "sonar-corridor";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  for (const char* seed : {"1", "2"}) {
    const fs::path log = run_pipeline("sonar_corridor", arguments("sonar_corridor", data, seed)) / "run.lcmlog";
    const ContourMap map = convert::from_message(messages_in<contour_map>(log, "CONTOUR_MAP").back());
    std::vector<Vector2> way;
    for (const PathPose& pose : convert::from_message(messages_in<path_estimate>(log, "SLAM_PATH").back()).poses) {
      way.push_back(pose.pose.position());
    }
    const eval::CorridorFigures figures = eval::corridor_figures(map, way);
    ASSERT_TRUE(figures.width && figures.corner) << "seed " << seed;
    EXPECT_NEAR(*figures.width, 2.11, 0.05) << "seed " << seed;
    EXPECT_NEAR(degrees(*figures.parallelism), 0.0, 1.5) << "seed " << seed;
    // No wall is heard through the whole turn: there the added noise alone has a standard deviation of 1.3 degrees.
    EXPECT_NEAR(degrees(*figures.corner), 90.0, 6.0) << "seed " << seed;
  }
}

TEST_F(PipelineRecorded, SightingsOfLandmarksMendDeadReckoning) {
  const fs::path data = shared_data() / "mrclam6";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const fs::path out = run_pipeline("mrclam", arguments("mrclam", data));
  EXPECT_LT(metric(out, "position_rmse"), 0.5 * metric(out, "position_rmse_dead_reckoning"));
  EXPECT_LT(metric(out, "ate_rmse"), 0.6);
  EXPECT_TRUE(std::isfinite(metric(out, "landmark_rmse")));
}

TEST_F(PipelineRecorded, TreesMendDeadReckoningInVictoriaPark) {
  const fs::path data = shared_data() / "victoria-park";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  std::vector<std::string> more = arguments("victoria_park", data);
  more.insert(more.end(), {"--set", "slam.filter.particles=10"});
  const fs::path out = run_pipeline("victoria_park", more);
  EXPECT_GT(metric(out, "fix_rmse_dead_reckoning"), 50.0);
  EXPECT_LT(metric(out, "fix_rmse"), 0.5 * metric(out, "fix_rmse_dead_reckoning"));
}

TEST_F(PipelineRecorded, ASweepFromOnePlaceFindsTheWallsThatItHears) {
  const fs::path data = shared_data() / "ultrasonic-rooms";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  std::vector<std::string> more = arguments("ultrasonic_rooms", data / "csv/Lvl_1_Room_Map_5.csv");
  more.insert(more.end(), {"--set", "source.outline=" + (data / "room_outline_richards325A.csv").string()});
  const fs::path out = run_pipeline("ultrasonic_rooms", more);
  EXPECT_TRUE(fs::exists(out / "report.html"));
  EXPECT_EQ(metric(out, "walls_found"), 4.0);
  EXPECT_EQ(metric(out, "walls_missed"), 0.0);
  EXPECT_LE(metric(out, "walls_invented"), 2.0);
  EXPECT_LT(metric(out, "wall_mae_rho"), 0.25);
  EXPECT_LT(degrees(metric(out, "wall_mae_theta")), 6.0);
}

TEST_F(PipelineRecorded, ACompassKeepsTheGardenRobotNearItsWay) {
  const fs::path data = shared_data() / "sonar-bigwheel/Garden_small.txt";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const fs::path out = run_pipeline("sonar_bigwheel", arguments("sonar_bigwheel", data));
  const auto path = messages_in<path_estimate>(out / "run.lcmlog", "SLAM_PATH").back().poses;
  ASSERT_FALSE(path.empty());
  EXPECT_LT(std::hypot(path.back().x_m, path.back().y_m), 1.0);  // the run ends where it began, or nearly
}

TEST_F(PipelineRecorded, ARingWithoutOdometryIsReplayed) {
  const fs::path data = shared_data() / "sonar-scitos24/sensor_readings_24.data";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const fs::path out = run_pipeline("sonar_scitos24", arguments("sonar_scitos24", data));
  EXPECT_EQ(messages_in<ultrasonic_scan>(out / "run.lcmlog", "ULTRASONIC_SCAN").size(), 5456u);
  EXPECT_TRUE(fs::exists(out / "report.html"));
}

TEST_F(PipelineRecorded, TheRawlogOfEveryFreshMachine) {
  const fs::path data = "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there (Debian's mrpt-common)";
  const fs::path out = run_pipeline("sena", arguments("sena", data));
  EXPECT_TRUE(fs::exists(out / "report.html"));
  EXPECT_TRUE(fs::exists(out / "map.pgm"));
  EXPECT_GE(messages_in<contour_map>(out / "run.lcmlog", "CONTOUR_MAP").back().walls.size(), 3u);
  EXPECT_LT(metric(out, "nis_mean"), 2.0);
}

}  // namespace
}  // namespace noctule::system_test
