/// The same bytes for any number of jobs, any sharding and any interruption.
#include "experiment/runner.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "experiment/parts.hpp"
#include "experiment/table.hpp"
#include "unit/experiment/fake_scenario.hpp"

namespace noctule::experiment {
namespace {

const auto kGoOn = [](const Progress&) { return true; };
constexpr std::array kTables{"runs.csv", "summary.csv", "timing.csv", "series.csv"};

class Runner : public testing::Test {
 protected:
  void SetUp() override {
    FakeScenario::refused_seed = 0;
    FakeScenario::slow = false;
    FakeScenario::runs = 0;
  }

  [[nodiscard]] std::string tables(const std::string& name) const {
    std::string text;
    for (const char* table : kTables) text += read_file(folder_ / name / table) + "\n";
    return text;
  }
  void run_into(const std::string& name, RunOptions options = {}, const Experiment& experiment = parse_fake()) {
    options.directory = folder_ / name;
    run(make_plan(experiment, make_fake), options, kGoOn);
  }

  Folder folder_;
};

TEST_F(Runner, WritesOneRowARunAndMetric) {
  run_into("a");
  const std::vector<Row> rows = read_rows(folder_ / "a" / "runs.csv");
  ASSERT_EQ(rows.size(), 2u * 12 * 3 * 2);  // scenarios, seeds, filters, figures
  const double common = Rng(1, stream_id("fake")).normal();
  EXPECT_EQ(rows[0].scenario, "near");
  EXPECT_EQ(rows[0].filter, "good");
  EXPECT_EQ(rows[0].parameters, "N=1");
  EXPECT_EQ(rows[0].metric, "error");
  EXPECT_EQ(rows[0].value, common + 1.0);
  EXPECT_EQ(rows[2].parameters, "N=4");
  EXPECT_EQ(rows[2].value, common + 0.25);  // the same random number
}

TEST_F(Runner, ShowsWhatDivergedAndWhatCouldNotBeMeasured) {
  run_into("a");
  const std::string summary = read_file(folder_ / "a" / "summary.csv");
  EXPECT_TRUE(summary.starts_with("scenario,filter,parameters,metric,unit,n,diverged,mean,sd,ci95_low,ci95_high\n"));
  for (const SummaryRow& row : read_summary(folder_ / "a" / "summary.csv")) {
    const bool bad = row.subject.filter == "bad";
    EXPECT_EQ(row.diverged, bad ? 4 : 0);  // seeds 3, 6, 9, 12
    EXPECT_EQ(row.n, bad && row.metric == "error" ? 10 : 12);
  }
}

TEST_F(Runner, WritesMeanCurvesOverTheSeeds) {
  run_into("a");
  const std::vector<SeriesRow> series = read_series(folder_ / "a" / "series.csv");
  ASSERT_EQ(series.size(), 2u * 3 * 2);
  EXPECT_EQ(series[0].time, 0.0);
  EXPECT_EQ(series[0].mean, 0.0);
  EXPECT_EQ(series[1].time, 0.5);
  const SummaryRow error = read_summary(folder_ / "a" / "summary.csv")[0];
  EXPECT_EQ(series[1].mean, error.mean);
  EXPECT_EQ(series[1].ci95.low, error.ci95.low);
}

TEST_F(Runner, TablesDoNotDependOnTheNumberOfJobs) {
  run_into("one");
  FakeScenario::slow = true;  // pieces end in another order than they begin
  run_into("five", {.directory = {}, .jobs = 5});
  EXPECT_EQ(tables("one"), tables("five"));
}

TEST_F(Runner, MergedShardsEqualOneRun) {
  run_into("whole");
  const Experiment experiment = parse_fake();
  const Plan plan = make_plan(experiment, make_fake);
  for (const std::size_t shards : {2u, 3u, 7u}) {
    std::vector<std::filesystem::path> folders;
    for (std::size_t i = shards; i-- > 0;) {  // in any order
      const std::string name = "shard" + std::to_string(i) + "of" + std::to_string(shards);
      run_into(name, {.directory = {}, .jobs = 2, .shard = i, .shards = shards});
      folders.push_back(folder_ / name);
    }
    const std::string name = "merged" + std::to_string(shards);
    merge(plan, folders, folder_ / name);
    EXPECT_EQ(tables(name), tables("whole"));
  }
}

TEST_F(Runner, InterruptedRunGoesOnWhereItWas) {
  run_into("whole");
  FakeScenario::runs = 0;
  const Experiment experiment = parse_fake();
  const Plan plan = make_plan(experiment, make_fake);
  const RunOptions options{.directory = folder_ / "cut"};
  run(plan, options, [](const Progress& p) { return p.done < 5; });
  EXPECT_EQ(FakeScenario::runs, 5);
  std::vector<Progress> seen;
  run(plan, options, [&](const Progress& p) {
    seen.push_back(p);
    return true;
  });
  EXPECT_EQ(FakeScenario::runs, 24);
  EXPECT_EQ(seen.front().done, 5);
  EXPECT_EQ(seen.back().resumed, 5);
  EXPECT_EQ(seen.back().done, 24);
  EXPECT_EQ(seen.back().total, 24);
  EXPECT_EQ(tables("cut"), tables("whole"));
}

TEST_F(Runner, HalfWrittenPieceIsDoneAgain) {
  run_into("whole");
  const Experiment experiment = parse_fake();
  std::filesystem::create_directories(folder_ / "cut" / "parts");
  std::ofstream(folder_ / "cut" / "parts" / ".near-3.csv.123.partial") << "kind,filter";
  run_into("cut");
  EXPECT_EQ(tables("cut"), tables("whole"));
}

TEST_F(Runner, RefusesAFolderOfAnotherExperiment) {
  run_into("a");
  const std::string text = refusal([&] { run_into("a", {}, parse_fake({"scenarios[1].config.offset_m=11"})); });
  EXPECT_NE(text.find("holds the results of another experiment"), std::string::npos) << text;
  const Experiment other = parse_fake({"last_seed=13"});
  const std::vector<std::filesystem::path> shards{folder_ / "a"};
  const std::string merged = refusal([&] { merge(make_plan(other, make_fake), shards, folder_ / "m"); });
  EXPECT_NE(merged.find("holds no results of this experiment"), std::string::npos) << merged;
}

TEST_F(Runner, WhatOnlyReportsLookAtMayChange) {
  run_into("a");
  FakeScenario::runs = 0;
  run_into("a", {}, parse_fake({"filters[1].role=baseline", "plots=[error]"}));
  EXPECT_EQ(FakeScenario::runs, 0);
  EXPECT_EQ(config::load<Experiment>(folder_ / "a" / "experiment.yaml").filters[1].role, Role::baseline);
}

TEST_F(Runner, MergeNamesWhatIsMissing) {
  run_into("half", {.directory = {}, .jobs = 1, .shard = 0, .shards = 2});
  const Experiment experiment = parse_fake();
  const std::vector<std::filesystem::path> shards{folder_ / "half"};
  const auto text = refusal([&] { merge(make_plan(experiment, make_fake), shards, folder_ / "m"); });
  EXPECT_EQ(text,
            "merge: no shard holds scenario 'near': seeds 2, 4, 6, 8, 10, 12; scenario 'far': seeds 2, 4, 6, 8 and 2 "
            "more");
}

TEST_F(Runner, RefusesAShardThatIsNone) {
  EXPECT_EQ(refusal([&] { run_into("a", {.directory = {}, .jobs = 1, .shard = 2, .shards = 2}); }),
            "shard: expected i/n with 0 <= i < n, got 2/2");
  EXPECT_EQ(refusal([&] { run_into("a", {.directory = {}, .jobs = 1, .shard = 0, .shards = 0}); }),
            "shard: expected i/n with 0 <= i < n, got 0/0");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
}

TEST_F(Runner, SaysWhichSeedFailed) {
  FakeScenario::refused_seed = 4;
  EXPECT_EQ(refusal([&] { run_into("a", {.directory = {}, .jobs = 3}); }), "scenario 'near', seed 4: no such world");
}

TEST_F(Runner, DropsTheMetricsThatNobodyAskedFor) {
  run_into("a", {}, parse_fake({"metrics=[steps]"}));
  for (const Row& row : read_rows(folder_ / "a" / "runs.csv")) EXPECT_EQ(row.metric, "steps");
  EXPECT_TRUE(read_series(folder_ / "a" / "series.csv").empty());
}

TEST_F(Runner, BrokenTablesAreRefusedWithTheirPlace) {
  std::ofstream(folder_ / "runs.csv") << "scenario,filter,parameters,seed,metric,unit,value,diverged\na,b,,1,m,1,x,0\n";
  EXPECT_NE(refusal([&] { static_cast<void>(read_rows(folder_ / "runs.csv")); }).find("runs.csv:2: expected a number"),
            std::string::npos);
  EXPECT_NE(
      refusal([&] { static_cast<void>(read_summary(folder_ / "runs.csv")); }).find("runs.csv:1: expected the header"),
      std::string::npos);
}

}  // namespace
}  // namespace noctule::experiment
