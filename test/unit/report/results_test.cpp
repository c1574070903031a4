#include "report/results.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/error.hpp"
#include "report/occupancy_image.hpp"
#include "unit/report/sample_run.hpp"

namespace noctule::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A folder of the test's own, gone when it ends.
class Results : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::path(testing::TempDir()) / (std::string("noctule_results_") + info->name());
    fs::remove_all(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }
  fs::path dir_;
};

TEST_F(Results, MetricsHoldTheNamesAndUnitsThatOthersRelyOn) {
  const RunData data = sample_run();
  write_results(data, dir_);
  const json metrics = json::parse(read(dir_ / "metrics.json"));
  ASSERT_TRUE(metrics.is_array());
  std::set<std::string> names;
  const std::set<std::string> si{"m", "rad", "s", "1"};
  for (const json& m : metrics) {
    EXPECT_EQ(m.size(), 3u);
    EXPECT_TRUE(m.at("value").is_number());
    EXPECT_TRUE(si.count(m.at("unit"))) << m;
    EXPECT_TRUE(names.insert(m.at("name")).second) << "twice: " << m;
  }
  for (const std::string suffix : {"", "_known_pose", "_dead_reckoning"}) {
    for (const char* name :
         {"walls_found", "walls_missed", "walls_invented", "cylinders_found", "cylinders_missed", "cylinders_invented",
          "wall_mae_rho", "wall_mae_theta", "cylinder_mae", "cylinder_mae_radius"}) {
      EXPECT_TRUE(names.count(name + suffix)) << name << suffix;
    }
  }
  for (const char* name : {"position_rmse", "heading_rmse", "position_rmse_dead_reckoning", "nees_mean"}) {
    EXPECT_TRUE(names.count(name)) << name;
  }
  EXPECT_FALSE(names.count("realtime_factor"));
  EXPECT_EQ(json::parse(read(dir_ / "timing.json")).at(0).at("name"), "realtime_factor");
}

TEST_F(Results, MetricValuesReadBackExactly) {
  RunData data;
  data.metrics = {{"third", 1.0 / 3, "m"}, {"tiny", 4.9e-324, "1"}, {"count", 7, "1"}};
  write_results(data, dir_);
  const json metrics = json::parse(read(dir_ / "metrics.json"));
  for (std::size_t i = 0; i < data.metrics.size(); ++i) {
    EXPECT_EQ(metrics.at(i).at("value").get<double>(), data.metrics[i].value);
  }
  EXPECT_EQ(read(dir_ / "metrics.csv"), "name,value,unit\nthird,0.3333333333333333,m\ntiny,5e-324,1\ncount,7,1\n");
}

TEST_F(Results, NotANumberIsNullAndSaid) {
  RunData data;
  data.metrics = {{"wall_mae_rho", std::nan(""), "m"}, {"nees_mean", HUGE_VAL, "1"}};
  write_results(data, dir_);
  const json metrics = json::parse(read(dir_ / "metrics.json"));
  EXPECT_TRUE(metrics.at(0).at("value").is_null());
  EXPECT_TRUE(metrics.at(1).at("value").is_null());
  EXPECT_NE(read(dir_ / "metrics.csv").find("wall_mae_rho,,m\n"), std::string::npos);
  EXPECT_NE(read(dir_ / "report.html").find("null in metrics.json: wall_mae_rho, nees_mean."), std::string::npos);
}

TEST_F(Results, EqualDataGiveEqualBytes) {
  write_results(sample_run(), dir_ / "a");
  write_results(sample_run(), dir_ / "b");
  int files = 0;
  for (const auto& entry : fs::directory_iterator(dir_ / "a")) {
    EXPECT_EQ(read(entry.path()), read(dir_ / "b" / entry.path().filename())) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 15);  // of them walls.csv, cylinders.csv and the known ones
}

TEST_F(Results, WallClockStaysOutOfWhatMustRepeat) {
  RunData data = sample_run();
  write_results(data, dir_ / "a");
  data.timing[0].value = 1.0;
  write_results(data, dir_ / "b");
  for (const auto& entry : fs::directory_iterator(dir_ / "a")) {
    const fs::path name = entry.path().filename();
    if (name == "timing.json" || name == "report.html") continue;
    EXPECT_EQ(read(entry.path()), read(dir_ / "b" / name)) << name;
  }
}

TEST_F(Results, LeavesNoUnfinishedAndNoForeignFiles) {
  write_results(sample_run(), dir_);
  EXPECT_TRUE(fs::exists(dir_ / "map.pgm"));
  RunData less = sample_run();
  less.occupancy.reset();
  less.truth.clear();
  write_results(less, dir_);
  EXPECT_FALSE(fs::exists(dir_ / "map.pgm")) << "of the run before";
  EXPECT_FALSE(fs::exists(dir_ / "ground_truth.tum"));
  for (const auto& entry : fs::directory_iterator(dir_)) EXPECT_NE(entry.path().filename().string().front(), '.');
}

TEST_F(Results, TrajectoriesHaveOneLineAPose) {
  const RunData data = sample_run();
  write_results(data, dir_);
  const auto lines = [&](const char* name) {
    const std::string text = read(dir_ / name);
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  };
  EXPECT_EQ(lines("trajectory.tum"), data.estimates.size());
  EXPECT_EQ(lines("ground_truth.tum"), data.truth.size());
  EXPECT_EQ(lines("dead_reckoning.tum"), data.dead_reckoning.size());
  EXPECT_EQ(read(dir_ / "config.yaml"), data.config_yaml);
}

TEST_F(Results, FolderThatCannotBeWrittenIsNamed) {
  fs::create_directories(dir_);
  std::ofstream(dir_ / "file") << "in the way";
  for (const fs::path& bad : {dir_ / "file", dir_ / "file" / "below"}) {
    try {
      prepare_results(bad);
      ADD_FAILURE() << bad;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(bad.string()), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_THROW(write_results({}, dir_ / "file"), InputError);
  EXPECT_EQ(read(dir_ / "file"), "in the way");
}

TEST_F(Results, FileThatCannotBeWrittenIsNamed) {
  fs::create_directories(dir_ / "metrics.json" / "in the way");
  try {
    write_results({}, dir_);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("metrics.json"), std::string::npos) << e.what();
  }
  EXPECT_FALSE(fs::exists(dir_ / ".metrics.json.partial"));
}

TEST(OccupancyImage, MapServerBytes) {
  // Two rows of three: the top row of the picture is the higher y.
  const OccupancyImage image{3, 2, 0.05, {-1.5, 0.25}, {0.0F, 0.9F, 0.5F, -1.0F, std::nanf(""), 1.0F}};
  const std::string expected =
      std::string("P5\n3 2\n255\n") + char(205) + char(205) + char(0) + char(254) + char(0) + char(205);
  EXPECT_EQ(to_pgm(image), expected);
  EXPECT_EQ(to_map_yaml(image, "map.pgm"),
            "image: map.pgm\nmode: trinary\nresolution: 0.05\norigin: [-1.5, 0.25, 0]\nnegate: 0\n"
            "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  EXPECT_THROW((void)to_pgm({2, 2, 0.05, {0, 0}, {0.1F}}), std::invalid_argument);
}

double metric(const std::vector<eval::Metric>& metrics, const std::string& name) {
  for (const eval::Metric& m : metrics) {
    if (m.name == name) return m.value;
  }
  ADD_FAILURE() << "no metric " << name;
  return std::nan("");
}

TEST(RunMetrics, ClosedForms) {
  RunData data;
  for (int i = 0; i <= 20; ++i) {
    const std::int64_t t = i * 100'000;
    data.truth.push_back({t, {0.1 * i, 0, 0}});
    data.dead_reckoning.push_back({t, {0.11 * i, 0, 0}});
    SlamEstimate e;
    e.stamp.utime = t;
    e.pose = {0.1 * i, 0.02, 0.01};
    e.covariance = Vector3(0.02 * 0.02, 0.02 * 0.02, 0.01 * 0.01).asDiagonal();
    e.effective_sample_size = 50;
    e.nis = i == 0 ? 0.0 : 1.5;
    data.estimates.push_back(e);
  }
  data.world.landmarks = {{1, {1, 1}}, {2, {2, 2}}};
  LandmarkEstimate l;
  l.id = 2;
  l.parameters = {2.03, 2.04, 0};
  data.landmarks.landmarks = {l};
  const auto metrics = run_metrics(data);
  EXPECT_NEAR(metric(metrics, "position_rmse"), 0.02, 1e-12);
  EXPECT_NEAR(metric(metrics, "heading_rmse"), 0.01, 1e-12);
  EXPECT_NEAR(metric(metrics, "ate_rmse"), 0.0, 1e-12);
  EXPECT_NEAR(metric(metrics, "rpe_translation_rmse_dead_reckoning"), 0.1, 1e-12);
  EXPECT_NEAR(metric(metrics, "position_max_dead_reckoning"), 0.2, 1e-12);
  EXPECT_NEAR(metric(metrics, "nees_mean"), 2.0, 1e-9);
  EXPECT_NEAR(metric(metrics, "nees_inside"), 1.0, 1e-12);
  EXPECT_NEAR(metric(metrics, "nis_mean"), 1.5, 1e-12);
  EXPECT_NEAR(metric(metrics, "landmark_rmse"), 0.05, 1e-12);
  EXPECT_EQ(metric(metrics, "landmarks_missed"), 1);
  EXPECT_NEAR(metric(metrics, "path_length"), 2.0, 1e-12);
}

TEST(RunMetrics, WithoutTruthNothingIsCompared) {
  RunData data = sample_run();
  data.truth.clear();
  data.world = {};
  for (auto* result : {&data.contours, &data.contours_known_pose, &data.contours_dead_reckoning})
    (*result)->errors.reset();
  for (const eval::Metric& m : run_metrics(data)) {
    EXPECT_EQ(m.name.find("rmse"), std::string::npos) << m.name;
    EXPECT_EQ(m.name.find("nees"), std::string::npos) << m.name;
  }
}

}  // namespace
}  // namespace noctule::report
