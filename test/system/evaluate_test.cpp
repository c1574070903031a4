/// noctule-evaluate and noctule-calibrate from the command line.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "system/process.hpp"

namespace noctule::system_test {
namespace {

const std::string kSource = NOCTULE_SOURCE_DIR;
const std::string kBin = NOCTULE_BIN_DIR;

double metric(const std::string& json, const std::string& name) {
  const std::string key = "\"name\":\"" + name + "\",\"value\":";
  const std::size_t at = json.find(key);
  return at == std::string::npos ? std::nan("") : std::strtod(json.c_str() + at + key.size(), nullptr);
}

Outcome evaluate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), kBin + "/noctule-evaluate");
  return run(arguments);
}

class Evaluate : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  Folder folder_;
};

TEST_F(Evaluate, AResultsFolderHasTheFiguresThatItsRunReported) {
  const fs::path out = folder_ / "run";
  ASSERT_EQ(run({kBin + "/noctule-pipeline", kSource + "/config/pipelines/heptagon.yaml", "--seed", "7", "--set",
                 "source.world.path.loops=1", "--set", "slam.filter.particles=20", "--out", out.string()})
                .exit_code,
            0);
  const Outcome outcome = evaluate({out.string(), "--align", "se2", "--rpe-length", "1", "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string reported = read_file(out / "metrics.json");
  for (const auto& [ours, theirs] :
       std::vector<std::pair<std::string, std::string>>{{"position_rmse", "position_rmse"},
                                                        {"position_max", "position_max"},
                                                        {"heading_rmse", "heading_rmse"},
                                                        {"ate_rmse", "ate_rmse"},
                                                        {"rpe_1m_translation_rmse", "rpe_translation_rmse"},
                                                        {"rpe_1m_rotation_rmse", "rpe_rotation_rmse"},
                                                        {"wall_mae_rho", "wall_mae_rho"},
                                                        {"wall_mae_theta", "wall_mae_theta"},
                                                        {"walls_found", "walls_found"},
                                                        {"cylinder_mae", "cylinder_mae"}}) {
    EXPECT_NEAR(metric(outcome.output, ours), metric(reported, theirs), 1e-9) << ours;
  }
  const Outcome by_world = evaluate({out.string(), "--world", kSource + "/config/worlds/heptagon.yaml", "--json", "-"});
  ASSERT_EQ(by_world.exit_code, 0) << by_world.output;
  EXPECT_NEAR(metric(by_world.output, "wall_mae_rho"), metric(reported, "wall_mae_rho"), 1e-9);
}

TEST_F(Evaluate, LandmarksAreJudgedByIdOrByDistance) {
  const std::string truth = write("truth.csv", "id,x,y\n1,0,0\n2,10,0\n3,0,10\n");
  const std::string named = write("named.csv", "1,0.3,0\n2,10,0.4\n7,50,50\n");
  const std::string anonymous = write("anonymous.csv", "-2,10,0.4\n-3,0.3,0\n-4,50,50\n");
  for (const std::string& estimate : {named, anonymous}) {
    const Outcome o = evaluate({"--landmarks", estimate, "--known-landmarks", truth, "--json", "-"});
    ASSERT_EQ(o.exit_code, 0) << o.output;
    EXPECT_NEAR(metric(o.output, "landmark_rmse"), std::sqrt(0.125), 1e-12);
    EXPECT_EQ(metric(o.output, "landmarks_missed"), 1.0);
    EXPECT_EQ(metric(o.output, "landmarks_invented"), 1.0);
    EXPECT_NEAR(metric(o.output, "landmark_ospa"), (0.3 + 0.4 + 1.0) / 3.0, 1e-12);
    EXPECT_NEAR(metric(o.output, "landmark_gospa"), 0.3 + 0.4 + 1.0, 1e-12);
  }
}

TEST_F(Evaluate, FixesJudgePositionsAlone) {
  const std::string estimate = write("e.tum", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
  const std::string fixes = write("fixes.csv", "t,x,y\n0.5,0.5,3\n1.5,1.5,3\n");
  const Outcome o = evaluate({"--estimate", estimate, "--fixes", fixes, "--align", "se2", "--json", "-"});
  ASSERT_EQ(o.exit_code, 0) << o.output;
  EXPECT_NEAR(metric(o.output, "position_rmse"), 3.0, 1e-12);
  EXPECT_NEAR(metric(o.output, "ate_rmse"), 0.0, 1e-9);
  EXPECT_TRUE(std::isnan(metric(o.output, "heading_rmse")));
}

TEST_F(Evaluate, SaysInOneLineWhatIsWrong) {
  const std::string good = write("good.tum", "0 0 0 0 0 0 0 1\n"), later = write("later.tum", "9 0 0 0 0 0 0 1\n");
  const std::string bad = write("bad.tum", "0 0 0 0 0 0 0 1\n1 0 0 zero 0 0 0 1\n");
  for (const auto& [arguments, expected] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{}, "expected an estimate and a truth"},
           {{good}, "expected a folder of results"},
           {{good, (folder_ / "absent.tum").string()}, "absent.tum: expected a file that can be read"},
           {{good, later}, "none in common"},
           {{bad, good}, "bad.tum:2"},
           {{good, good, "--rpe-steps", "1.5"}, "--rpe-steps: expected whole numbers"},
           {{good, good, "--rpe-length", "-1"}, "--rpe-length: expected a number > 0"},
           {{good, good, "--align", "se4"}, "se4"},
           {{good, good, "--no-such-option"}, "--no-such-option"},
           {{"--landmarks", good}, "landmarks: expected an estimate and a truth"}}) {
    const Outcome o = evaluate(arguments);
    EXPECT_EQ(o.exit_code, 2) << expected;
    EXPECT_NE(o.output.find(expected), std::string::npos) << o.output;
    EXPECT_EQ(std::count(o.output.begin(), o.output.end(), '\n'), 1) << o.output;
  }
  EXPECT_EQ(evaluate({"--help"}).exit_code, 0);
}

TEST_F(Evaluate, ACalibrationIsAFileThatASourceCanReferTo) {
  const char* shared = std::getenv("NOCTULE_SHARED");
  const fs::path data = fs::path(shared != nullptr ? shared : kSource + "/../shared") / "data/mrclam6";
  const std::string pipeline = kSource + "/config/pipelines/mrclam.yaml";
  const Outcome absent = run({kBin + "/noctule-calibrate", pipeline, "--set", "source.path=/nowhere"});
  EXPECT_EQ(absent.exit_code, 2);
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const std::string out = (folder_ / "calibration.yaml").string();
  const Outcome o = run({kBin + "/noctule-calibrate", pipeline, "--set", "source.path=" + data.string(), "--out", out});
  ASSERT_EQ(o.exit_code, 0) << o.output;
  const std::string user = write(
      "user.yaml", "name: x\nsource: {file: calibration.yaml, type: mrclam, path: " + data.string() + ", robot: 2}\n");
  const Outcome printed = run({kBin + "/noctule-pipeline", user, "--print-config"});
  EXPECT_EQ(printed.exit_code, 0) << printed.output;
  EXPECT_NE(printed.output.find("turn_scale: 0."), std::string::npos) << printed.output;
}

}  // namespace
}  // namespace noctule::system_test
