/// noctule-pipeline: repeatable to the byte, interruptible, and a log that brings a run back.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "noctule/camera_image.hpp"
#include "noctule/landmark_detections.hpp"
#include "noctule/module_status.hpp"
#include "noctule/slam_estimate.hpp"
#include "noctule/ultrasonic_scan.hpp"
#include "system/pipeline_setup.hpp"

namespace noctule::system_test {
namespace {

/// All files of a results folder but those that hold wall-clock figures.
std::vector<std::string> repeatable(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name != "timing.json" && name != "report.html") names.push_back(name);
  }
  return names;
}

class PipelineRun : public ::testing::Test {
 protected:
  fs::path run_into(const std::string& name, const std::vector<std::string>& arguments = short_run()) {
    const fs::path out = folder_ / name;
    const Outcome outcome = run(command("noctule-pipeline", arguments, {"--out", out.string()}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return out;
  }
  Folder folder_;
};

TEST_F(PipelineRun, SameSeedSameBytesWhateverTheThreads) {
  std::vector<std::string> two_threads = short_run();
  two_threads.insert(two_threads.end(), {"--threads", "2"});
  const fs::path first = run_into("first"), again = run_into("again"), two = run_into("two", two_threads);
  for (const char* file :
       {"metrics.json", "trajectory.tum", "config.yaml", "run.lcmlog", "report.html", "timing.json"}) {
    EXPECT_TRUE(fs::exists(first / file)) << file;
  }
  for (const std::string& file : repeatable(first)) {
    const std::string bytes = read_file(first / file);
    EXPECT_FALSE(bytes.empty()) << file;
    EXPECT_TRUE(bytes == read_file(again / file)) << file << " differs in a second run";
    EXPECT_TRUE(bytes == read_file(two / file)) << file << " differs with two threads";
  }
}

/// Pictures and echoes in one run, the whole way from pixels to the map.
TEST_F(PipelineRun, SeesAndHearsInOneFilterRepeatably) {
  const std::vector<std::string> arguments = {kSource + "/config/pipelines/heptagon_camera.yaml",
                                              "--seed",
                                              "7",
                                              "--set",
                                              "source.world.path.loops=1",
                                              "--set",
                                              "slam.filter.particles=30"};
  std::vector<std::string> two_threads = arguments;
  two_threads.insert(two_threads.end(), {"--threads", "2"});
  const fs::path first = run_into("first", arguments), two = run_into("two", two_threads);
  for (const std::string& file : repeatable(first)) {
    EXPECT_TRUE(read_file(first / file) == read_file(two / file)) << file << " differs with two threads";
  }
  const auto seen = messages_in<landmark_detections>(first / "run.lcmlog", "LANDMARK_DETECTIONS");
  const auto heard = messages_in<ultrasonic_scan>(first / "run.lcmlog", "ULTRASONIC_SCAN");
  EXPECT_EQ(seen.size(), heard.size()) << "a picture at each stop";
  std::set<std::int64_t> landmarks;
  for (const auto& message : seen) {
    for (const auto& d : message.detections) landmarks.insert(d.id);
  }
  EXPECT_GE(landmarks.size(), 8u) << "of eight signs and two posts";
  std::map<std::string, module_status> last;
  for (const auto& status : messages_in<module_status>(first / "run.lcmlog", "MODULE_STATUS")) {
    last[status.module] = status;
  }
  EXPECT_EQ(last["camera"].state, module_status::STATE_FINISHED);
  for (const auto& [module, status] : last) {
    EXPECT_EQ(status.missed + status.duplicates + status.late + status.dropped + status.errors, 0) << module;
  }
  EXPECT_TRUE(messages_in<camera_image>(first / "run.lcmlog", "CAMERA_IMAGE").empty()) << "not asked for";
  EXPECT_NE(read_file(first / "report.html").find("What the camera saw"), std::string::npos);
}

TEST_F(PipelineRun, AnotherSeedIsAnotherRun) {
  EXPECT_TRUE(read_file(run_into("first") / "trajectory.tum") !=
              read_file(run_into("other", short_run("8")) / "trajectory.tum"));
}

TEST_F(PipelineRun, TheEffectiveConfigurationRepeatsTheRun) {
  const fs::path first = run_into("first");
  const fs::path out = folder_ / "again";
  const Outcome outcome = run(command("noctule-pipeline", {(first / "config.yaml").string(), "--out", out.string()}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  for (const std::string& file : repeatable(first))
    EXPECT_TRUE(read_file(first / file) == read_file(out / file)) << file;
}

TEST_F(PipelineRun, ALogOfARunBringsItBack) {
  const fs::path first = run_into("first");
  const fs::path file = folder_ / "replay.yaml";
  std::ofstream(file) << "source:\n  type: log\n  path: first/run.lcmlog\n  world: {file: " << kSource
                      << "/config/worlds/heptagon.yaml}\nseed: 7\nultrasonic: {}\n"
                      << "slam: {filter: {file: " << kSource
                      << "/config/filters/pf.yaml, particles: 20}}\nmapping: {}\n";
  const fs::path out = folder_ / "replay";
  const Outcome outcome = run(command("noctule-pipeline", {file.string(), "--out", out.string()}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(read_file(first / "trajectory.tum") == read_file(out / "trajectory.tum"));
  EXPECT_TRUE(read_file(first / "metrics.json") == read_file(out / "metrics.json"));
}

TEST_F(PipelineRun, TheLogThatIsPlayedIsNotOverwritten) {
  const fs::path out = run_into("out");
  const std::string log = (out / "run.lcmlog").string(), bytes = read_file(log);
  const Outcome outcome = run(command(
      "noctule-pipeline", {kHeptagon, "--set", "source={type: log, path: " + log + "}", "--out", out.string()}));
  EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
  EXPECT_TRUE(read_file(log) == bytes);
  EXPECT_TRUE(fs::exists(out / "metrics.json"));
}

TEST_F(PipelineRun, NothingIsMissedAndAllModulesFinish) {
  const fs::path log = run_into("first") / "run.lcmlog";
  std::map<std::string, module_status> last;
  for (const auto& status : messages_in<module_status>(log, "MODULE_STATUS")) last[status.module] = status;
  for (const char* module : {"source", "ultrasonic", "slam", "mapper", "mapper_known_pose", "mapper_dead_reckoning"}) {
    ASSERT_TRUE(last.contains(module)) << module;
    const module_status& status = last[module];
    EXPECT_EQ(status.state, module_status::STATE_FINISHED) << module << ": " << status.last_error;
    EXPECT_EQ(status.missed + status.duplicates + status.late + status.dropped + status.errors, 0) << module;
  }
  EXPECT_TRUE(messages_in<module_status>(log, "TIMING").empty()) << "wall-clock figures are not recorded";
}

/// Until the run is under way.
void wait_for_log(const fs::path& log) {
  while (!fs::exists(log) || fs::file_size(log) < 300'000) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST_F(PipelineRun, CtrlCStillWritesTheReport) {
  const fs::path out = folder_ / "out";
  Process process(
      command("noctule-pipeline", short_run(), {"--set", "source.world.path.loops=2000", "--out", out.string()}));
  wait_for_log(out / "run.lcmlog");
  process.send(SIGINT);
  const Outcome outcome = process.wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.output;
  for (const char* file : {"report.html", "metrics.json", "trajectory.tum", "config.yaml"}) {
    EXPECT_TRUE(fs::exists(out / file)) << file;
  }
  EXPECT_NE(outcome.output.find("stopped before the end"), std::string::npos) << outcome.output;
}

TEST_F(PipelineRun, AKilledRunLeavesAReadableLogAndNoOldFigures) {
  const fs::path out = run_into("out");
  fs::remove(out / "run.lcmlog");  // the next one that is seen is the killed run's
  Process process(
      command("noctule-pipeline", short_run(), {"--set", "source.world.path.loops=2000", "--out", out.string()}));
  wait_for_log(out / "run.lcmlog");
  process.send(SIGKILL);
  EXPECT_EQ(process.wait().exit_code, -SIGKILL);
  const auto estimates = messages_in<slam_estimate>(out / "run.lcmlog", "SLAM_ESTIMATE");
  ASSERT_FALSE(estimates.empty());
  EXPECT_EQ(estimates.back().seq + 1, static_cast<std::int64_t>(estimates.size()));
  EXPECT_FALSE(fs::exists(out / "metrics.json"));
  EXPECT_FALSE(fs::exists(out / "report.html"));
}

TEST_F(PipelineRun, EveryPipelineFileIsSoundAndItsEffectiveFormIsToo) {
  for (const auto& entry : fs::directory_iterator(kSource + "/config/pipelines")) {
    const Outcome first = run(command("noctule-pipeline", {entry.path().string(), "--print-config"}));
    EXPECT_EQ(first.exit_code, 0) << entry.path() << ": " << first.output;
    const fs::path effective = folder_ / "effective.yaml";
    std::ofstream(effective) << first.output;
    EXPECT_EQ(run(command("noctule-pipeline", {effective.string(), "--print-config"})).output, first.output);
  }
}

TEST_F(PipelineRun, TheTableOfKeysNamesThem) {
  const Outcome outcome = run(command("noctule-pipeline", {"--keys"}));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.output.find("| `slam.filter<pf>.particles` |  | `100` |"), std::string::npos);
  EXPECT_NE(outcome.output.find("| `source<simulator>.world.path.stop_spacing_cm` | cm |"), std::string::npos);
}

TEST_F(PipelineRun, TheRobotIsDrawn) {
  const Outcome outcome = run(command("noctule-sim", {kHeptagon, "--show-robot", "-"}));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.output.find("<svg"), std::string::npos);
}

TEST_F(PipelineRun, LandmarksStandOverTheTrueOnesInTheReport) {
  const std::string file = kSource + "/config/pipelines/webmap.yaml";
  const fs::path out = run_into("web", {file, "--set", "source.world.loops=1"});
  const std::string report = read_file(out / "report.html"), metrics = read_file(out / "metrics.json");
  const std::string mark = "class=\"known-landmark\"";
  std::size_t known = 0;
  for (std::size_t at = report.find(mark); at != std::string::npos; at = report.find(mark, at + 1)) ++known;
  EXPECT_EQ(known, 35u);
  EXPECT_NE(report.find("class=\"landmark\""), std::string::npos);
  EXPECT_NE(metrics.find("\"landmarks_invented\",\"value\":0.0"), std::string::npos) << metrics;
  EXPECT_EQ(run(command("noctule-sim", {file, "--print-config"})).exit_code, 0);
  const Outcome drawn = run(command("noctule-sim", {file, "--show-robot", "-"}));
  EXPECT_EQ(drawn.exit_code, 2);
  EXPECT_NE(drawn.output.find("--show-robot"), std::string::npos);
}

TEST_F(PipelineRun, HelpIsQuick) {
  double least = 1.0;
  for (int i = 0; i < 5; ++i) {
    const Outcome outcome = run({kBin + "/noctule-pipeline", "--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.output.find("--set"), std::string::npos);
    least = std::min(least, outcome.cpu_seconds);
  }
  EXPECT_LT(least, 0.1);
}

}  // namespace
}  // namespace noctule::system_test
