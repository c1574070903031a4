/// noctule-experiment from the command line: interruptions, job arrays, and what it says to bad input.
#include <gtest/gtest.h>

#include <cstdlib>

#include "system/process.hpp"

namespace noctule::system_test {
namespace {

const std::string kProgram = std::string(NOCTULE_BIN_DIR) + "/noctule-experiment";
const std::string kHeptagon = std::string(NOCTULE_SOURCE_DIR) + "/config/experiments/heptagon.yaml";

/// One loop, few particles: a few hundredths of a second a seed.
std::vector<std::string> command(const std::string& verb, const std::vector<std::string>& more,
                                 const std::string& seeds = "1-8") {
  std::vector<std::string> all{kProgram,
                               verb,
                               kHeptagon,
                               "--seeds",
                               seeds,
                               "--set",
                               "scenarios[0].config.world.path.loops=1",
                               "--set",
                               "filters[0].parameters.N=[5, 10]"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

class ExperimentRun : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string tables(const std::string& name) const {
    std::string text;
    for (const char* table : {"runs.csv", "summary.csv", "series.csv"}) text += read_file(folder_ / name / table);
    return text;
  }
  [[nodiscard]] std::size_t parts(const std::string& name) const {
    std::error_code none;
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / name / "parts", none)) {
      count += entry.path().extension() == ".csv" ? 1 : 0;
    }
    return count;
  }

  Folder folder_;
};

TEST_F(ExperimentRun, KilledRunGoesOnToTheSameBytes) {
  ASSERT_EQ(run(command("run", {"--out", path("whole")})).exit_code, 0);
  {
    Process process(command("run", {"--out", path("killed"), "--jobs", "2"}));
    while (parts("killed") < 2) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    process.send(SIGKILL);
    EXPECT_EQ(process.wait().exit_code, -SIGKILL);
  }
  EXPECT_LT(parts("killed"), 8u) << "killed too late to test anything";
  EXPECT_FALSE(fs::exists(folder_ / "killed" / "runs.csv"));
  const Outcome resumed = run(command("run", {"--out", path("killed")}));
  EXPECT_EQ(resumed.exit_code, 0) << resumed.output;
  EXPECT_EQ(resumed.output.find("0 of 8 seeds"), std::string::npos) << "begins where it was: " << resumed.output;
  EXPECT_EQ(tables("killed"), tables("whole"));
}

TEST_F(ExperimentRun, InterruptEndsWith130AndSaysHowToGoOn) {
  Process process(command("run", {"--out", path("cut")}, "1-500"));
  while (parts("cut") < 1) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  process.send(SIGINT);
  const Outcome outcome = process.wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.output;
  EXPECT_NE(outcome.output.find("the same command goes on"), std::string::npos) << outcome.output;
}

TEST_F(ExperimentRun, JobArraysOfSlurmNeedNotBeginAtZero) {
  const auto slurm = [](const char* id, const char* count, const char* min, const char* max) {
    setenv("SLURM_ARRAY_TASK_ID", id, 1);
    setenv("SLURM_ARRAY_TASK_COUNT", count, 1);
    setenv("SLURM_ARRAY_TASK_MIN", min, 1);
    setenv("SLURM_ARRAY_TASK_MAX", max, 1);
  };
  slurm("3", "3", "2", "4");  // the middle one of 2, 3, 4
  EXPECT_EQ(run(command("run", {"--out", path("middle")})).exit_code, 0);
  slurm("7", "2", "3", "7");  // 3,7: a repetition of two tasks
  const Outcome gaps = run(command("run", {"--out", path("gaps")}));
  unsetenv("SLURM_ARRAY_TASK_MIN");
  const Outcome missing = run(command("run", {"--out", path("gaps")}));
  const Outcome given = run(command("run", {"--out", path("given"), "--shard", "1/3"}));
  unsetenv("SLURM_ARRAY_TASK_ID");
  EXPECT_TRUE(fs::exists(folder_ / "middle" / "parts" / "heptagon-2.csv"));
  EXPECT_EQ(parts("middle"), 3u);  // seeds 2, 5, 8
  EXPECT_EQ(gaps.exit_code, 2);
  EXPECT_NE(gaps.output.find("has gaps (2 tasks from 3 to 7): give --shard i/n"), std::string::npos) << gaps.output;
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.output.find("SLURM_ARRAY_TASK_MIN"), std::string::npos) << missing.output;
  EXPECT_EQ(given.exit_code, 0) << given.output;
  EXPECT_EQ(tables("given"), tables("middle"));
}

TEST_F(ExperimentRun, ListSaysWhatWouldRunAndWhatIsDone) {
  const Outcome before = run(command("list", {"--out", path("a")}, "1-2"));
  EXPECT_EQ(before.exit_code, 0);
  for (const char* word : {"heptagon: seeds 1 to 2, 36 runs", "filter pf N=5", "filter known_pose (limit)",
                           "filter dead_reckoning (baseline)", "position_rmse", "nothing done yet"}) {
    EXPECT_NE(before.output.find(word), std::string::npos) << word << "\n" << before.output;
  }
  ASSERT_EQ(run(command("run", {"--out", path("a"), "--shard", "0/2"}, "1-2")).exit_code, 0);
  EXPECT_NE(run(command("list", {"--out", path("a")}, "1-2")).output.find("1 of 2 seeds done"), std::string::npos);
}

TEST_F(ExperimentRun, ReportsAndCompares) {
  ASSERT_EQ(run(command("run", {"--out", path("a")}, "1-4")).exit_code, 0);
  const Outcome report = run({kProgram, "report", path("a")});
  EXPECT_EQ(report.exit_code, 0) << report.output;
  EXPECT_TRUE(fs::exists(folder_ / "a" / "report.html"));
  const Outcome compare = run({kProgram, "compare", "pf:N=5", "pf:N=10", "--in", path("a"), "--csv", path("c.csv")});
  EXPECT_EQ(compare.exit_code, 0) << compare.output;
  EXPECT_NE(compare.output.find("Position RMSE"), std::string::npos) << compare.output;
  EXPECT_TRUE(read_file(path("c.csv")).starts_with("scenario,metric,unit,filter,"));
  ASSERT_EQ(
      run(command("run", {"--out", path("b"), "--set", "scenarios[0].config.robot.odometry.distance=0.08"}, "1-4"))
          .exit_code,
      0);
  const Outcome folders = run({kProgram, "compare", path("a"), path("b")});
  EXPECT_EQ(folders.exit_code, 0) << folders.output;
  EXPECT_NE(folders.output.find("configured differently"), std::string::npos) << folders.output;
}

TEST_F(ExperimentRun, BadInputEndsWithTwoAndOneLine) {
  const std::vector<std::vector<std::string>> cases{
      command("run", {"--out", path("x"), "--shard", "4"}),
      command("run", {"--out", path("x"), "--shard", "4/4"}),
      command("run", {"--out", path("x")}, "10-5"),
      command("run", {"--out", path("x"), "--set", "filters[0].name=god"}),
      command("run", {"--out", path("x"), "--set", "metrics=[eror]"}),
      command("run", {"--out", path("x"), "--set", "scenarios[0].kind=moon"}),
      command("run", {"--out", path("x"), "--set", "scenarios[0].config.word=1"}),
      {kProgram, "report", path("nothing")},
      {kProgram, "compare", "a", "b", "--in", path("nothing")},
      {kProgram, "pages", path("nothing.md")}};
  for (const auto& arguments : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    EXPECT_FALSE(outcome.output.empty());
  }
  EXPECT_FALSE(fs::exists(folder_ / "x")) << "refused before the first run";
}

}  // namespace
}  // namespace noctule::system_test
