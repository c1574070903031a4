/// What cannot be used is refused in one line, with exit code 2, before anything is written.
#include <gtest/gtest.h>

#include <algorithm>

#include "system/pipeline_setup.hpp"

namespace noctule::system_test {
namespace {

class PipelineRefusals : public ::testing::Test {
 protected:
  /// The line with which the pipeline is refused.
  std::string refusal(const std::vector<std::string>& arguments) {
    const fs::path out = folder_ / "out";
    const Outcome outcome = run(command("noctule-pipeline", arguments, {"--out", out.string()}));
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    EXPECT_EQ(std::ranges::count(outcome.output, '\n'), 1) << outcome.output;
    EXPECT_FALSE(fs::exists(out));
    return outcome.output;
  }
  std::string refusal_of_text(const std::string& text) {
    std::ofstream(folder_ / "p.yaml") << text;
    return refusal({(folder_ / "p.yaml").string()});
  }
  std::string refusal_of_value(const std::string& assignment) { return refusal({kHeptagon, "--set", assignment}); }
  static void expect_says(const std::string& line, const std::string& part) {
    EXPECT_NE(line.find(part), std::string::npos) << line;
  }

  Folder folder_;
};

TEST_F(PipelineRefusals, Configuration) {
  expect_says(refusal({"none.yaml"}), "none.yaml: no such file");
  expect_says(refusal_of_text("nam: x\nsource: {type: log, path: x}"),
              "p.yaml:1: unknown key 'nam', did you mean 'name'?");
  expect_says(refusal_of_text("name: [x"), "not valid YAML");
  expect_says(refusal_of_text("source: {type: radar}"), "source.type: expected one of simulator, log");
  expect_says(refusal_of_text("source: {type: log, path: none.lcmlog}"), "none.lcmlog");
  expect_says(refusal_of_text("ultrasonic: {}"), "expected the section 'slam' too");
}

TEST_F(PipelineRefusals, Values) {
  expect_says(refusal_of_value("slam.filter.particles=-5"), "slam.filter.particles: expected an integer");
  expect_says(refusal_of_value("slam.filter.particles=many"), "got many");
  expect_says(refusal_of_value("slam.filter.echo.range_noise.base_m=1"), "wrong unit: expected 'base_cm' in cm");
  expect_says(refusal_of_value("source.robot.sonar.outliers=.nan"), "expected a finite number, got .nan");
  expect_says(refusal_of_value("source.world.room={walls: [], cylinders: []}"), "source.world");
}

TEST_F(PipelineRefusals, CommandLine) {
  expect_says(refusal({kHeptagon, "--sede", "1"}), "--sede");
  expect_says(refusal({kHeptagon, "--seed", "one"}), "one");
  expect_says(refusal({kHeptagon, "--threads", "0"}), "threads");
  expect_says(refusal({kHeptagon, "--bus", "tcp://x"}), "tcp://x");
  expect_says(refusal({}), "FILE");
}

TEST_F(PipelineRefusals, ALogOfAnotherTypeVersion) {
  {
    bus::LogWriter writer(folder_ / "old.lcmlog");
    const std::vector<std::uint8_t> of_another_type(64, 1);
    writer.write("ODOMETRY", 5, of_another_type);
  }
  expect_says(refusal_of_text("source: {type: log, path: old.lcmlog}"), "old.lcmlog: message 1 on ODOMETRY");
}

TEST_F(PipelineRefusals, AFolderThatCannotBeWritten) {
  std::ofstream(folder_ / "in_the_way") << "a file";
  const Outcome outcome =
      run(command("noctule-pipeline", short_run(), {"--out", (folder_ / "in_the_way/out").string()}));
  EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
  EXPECT_EQ(std::ranges::count(outcome.output, '\n'), 1) << outcome.output;
  expect_says(outcome.output, "in_the_way");
}

}  // namespace
}  // namespace noctule::system_test
