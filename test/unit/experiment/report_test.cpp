/// What a report says about results whose figures are known.
#include "experiment/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "experiment/result_plots.hpp"
#include "experiment/result_table.hpp"
#include "experiment/runner.hpp"
#include "unit/experiment/fake_scenario.hpp"

namespace noctule::experiment {
namespace {

constexpr const char* kDash = "\xE2\x80\x94";

class Report : public testing::Test {
 protected:
  /// Runs the experiment and reads it back.
  Results results_of(const std::vector<std::string>& assignments = {}) {
    FakeScenario::refused_seed = 0;
    FakeScenario::slow = false;
    const Experiment experiment = parse_fake(assignments);
    const std::filesystem::path directory = folder_ / std::to_string(++runs_);
    run(make_plan(experiment, make_fake), {.directory = directory}, [](const Progress&) { return true; });
    last_ = directory;
    return load_results(directory);
  }

  Folder folder_;
  std::filesystem::path last_;
  int runs_ = 0;
};

const std::vector<std::string> kReferences{
    "references=[{source: table 1, filter: PF, parameters: \"N=4\", scenario: near, metric: error, value: 0.5, unit: "
    "m}, "
    "{source: table 1, filter: PF, parameters: \"N=9\", scenario: near, metric: error, value: 0.25, unit: m}]"};

const TableRow* row(const ResultTable& table, const std::string& title) {
  const auto at = std::ranges::find(table.rows, title, &TableRow::title);
  return at == table.rows.end() ? nullptr : &*at;
}

TEST_F(Report, FewFiltersStandSideBySideWithWhatDiverged) {
  const Results results = results_of({"filters[1].role=limit", "metrics=[error, steps, error_over_time]"});
  const std::vector<ResultTable> tables = result_tables(results, "near");
  ASSERT_EQ(tables.size(), 1u);
  ASSERT_EQ(tables[0].columns.size(), 3u);
  EXPECT_EQ(tables[0].columns[0].title, "good");
  EXPECT_EQ(tables[0].columns[0].detail, "N=1");
  EXPECT_EQ(tables[0].columns[2].css_class, "limit");
  const TableRow* diverged = row(tables[0], "Diverged runs of 12");
  ASSERT_NE(diverged, nullptr);
  EXPECT_EQ(diverged->cells[0].value, "0");
  EXPECT_EQ(diverged->cells[2].value, "4");
  const TableRow* error = row(tables[0], "Error [m]");
  ASSERT_NE(error, nullptr);
  EXPECT_NE(error->cells[2].detail.find("n = 10"), std::string::npos) << "what could not be measured is shown";
  EXPECT_EQ(error->cells[0].detail.find("n ="), std::string::npos);
}

TEST_F(Report, PublishedFiguresStandBesideOurs) {
  const ResultTable table = result_tables(results_of(kReferences), "near").at(0);
  ASSERT_EQ(table.columns.size(), 5u);
  EXPECT_EQ(table.columns[3].title, "PF, N=4");
  EXPECT_EQ(table.columns[3].detail, "table 1");
  EXPECT_EQ(row(table, "Error [m]")->cells[3].value, "0.50");
  EXPECT_TRUE(row(table, "Steps")->cells[3].value.empty());
}

TEST_F(Report, ManyFiltersGetATableAMetric) {
  std::vector<std::string> assignments = kReferences;
  assignments.push_back(
      "filters=[{name: good, parameters: {N: [1, 2, 4, 8]}}, {name: bad, parameters: {N: [1, 2, 4]}}]");
  const std::vector<ResultTable> tables = result_tables(results_of(assignments), "near");
  ASSERT_EQ(tables.size(), 3u);  // error, steps, diverged
  EXPECT_EQ(tables[0].columns.size(), 3u);
  const TableRow* four = row(tables[0], "N=4");
  ASSERT_NE(four, nullptr);
  EXPECT_EQ(four->cells[2].value, "0.50");
  EXPECT_TRUE(row(tables[0], "N=8")->cells[1].value.empty()) << "bad did not run with 8";
  ASSERT_NE(row(tables[0], "N=9"), nullptr) << "only the paper has it";
  EXPECT_EQ(row(tables[0], "N=9")->cells[2].value, "0.25");
  EXPECT_EQ(row(tables[2], "N=4")->cells[1].value, "4");
  EXPECT_EQ(row(tables[2], "N=4")->cells[0].value, "0");
}

TEST_F(Report, PublishedFiguresStandInEveryRowThatSaysWhatTheySay) {
  std::vector<std::string> assignments = kReferences;
  assignments.push_back("filters=[{name: good, parameters: {particles: [1, 2, 3], N: [4, 8]}}, {name: bad}]");
  const ResultTable table = result_tables(results_of(assignments), "near").at(0);
  for (const char* parameters : {"particles=1;N=4", "particles=3;N=4"}) {
    ASSERT_NE(row(table, parameters), nullptr);
    EXPECT_EQ(row(table, parameters)->cells.back().value, "0.50");
  }
  EXPECT_TRUE(row(table, "particles=1;N=8")->cells.back().value.empty());
  EXPECT_EQ(row(table, "N=9")->cells.back().value, "0.25");
}

TEST_F(Report, ComparesWithTheFirstFilterAtEqualParameters) {
  const Results results = results_of(
      {"filters=[{name: good, parameters: {N: [1, 4]}}, {name: bad, parameters: {N: [1, 4]}}]", "metrics=[error]"});
  const std::vector<Comparison> all = standard_comparisons(results);
  ASSERT_EQ(all.size(), 4u);  // two scenarios, two parameters
  for (const Comparison& c : all) {
    EXPECT_EQ(c.subject.filter, "bad");
    EXPECT_EQ(c.against.filter, "good");
    EXPECT_EQ(c.against.parameters, c.subject.parameters);
    EXPECT_NEAR(c.difference, 1.0, 1e-12);
    EXPECT_EQ(c.pairs, 10);
    EXPECT_EQ(c.dropped, 2);
    EXPECT_EQ(c.diverged, 4);
  }
}

TEST(StandardComparisons, FurtherParametersOfAFilterDoNotChangeWhomItMeets) {
  Results results;
  results.experiment.scenarios = {{"near", "fake", {}}};
  results.experiment.filters = {{"pf", Role::compared, {}, {}, {}}, {"apf", Role::compared, {}, {}, {}}};
  for (const auto& [filter, parameters] :
       {std::pair("pf", "N=20;q=1"), std::pair("pf", "N=50;q=1"), std::pair("apf", "N=50;q=1;split=half"),
        std::pair("apf", "N=50;q=1"), std::pair("apf", "N=99;q=1")}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      results.runs.push_back({"near", filter, parameters, seed, "error", "m", static_cast<double>(seed), false});
    }
  }
  const std::vector<Comparison> all = standard_comparisons(results);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].against.parameters, "N=50;q=1");
  EXPECT_EQ(all[1].against.parameters, "N=50;q=1");
  EXPECT_EQ(all[2].against.parameters, "N=20;q=1");  // none matches: the first
}

TEST(StandardComparisons, ValuesOfAParameterMeetTheFirstOneAllElseBeingEqual) {
  Results results;
  results.experiment.scenarios = {{"near", "fake", {}}};
  results.experiment.filters = {{"pf", Role::compared, {}, {}, {}}};
  results.experiment.compare = {"move"};
  for (const char* parameters : {"draw=a;move=no", "draw=a;move=yes", "draw=b;move=no", "draw=b;move=yes", "draw=c"}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      results.runs.push_back({"near", "pf", parameters, seed, "error", "m", static_cast<double>(seed), false});
    }
  }
  const std::vector<Comparison> all = standard_comparisons(results);
  ASSERT_EQ(all.size(), 6u);  // four against the first filter, then two
  EXPECT_EQ(all[4].subject.parameters, "draw=a;move=yes");
  EXPECT_EQ(all[4].against.parameters, "draw=a;move=no");
  EXPECT_EQ(all[5].subject.parameters, "draw=b;move=yes");
  EXPECT_EQ(all[5].against.parameters, "draw=b;move=no");
}

TEST_F(Report, ASingleFilterIsComparedWithItsFirstParameters) {
  const std::vector<Comparison> all = standard_comparisons(results_of({"filters[1].role=baseline", "metrics=[error]"}));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].subject.parameters, "N=4");
  EXPECT_EQ(all[0].against.parameters, "N=1");
  EXPECT_NEAR(all[0].difference, -0.75, 1e-12);
}

TEST_F(Report, CompareTakesNamesParametersAndFolders) {
  const Results results = results_of({"metrics=[error]"});
  EXPECT_EQ(compare(results.runs, {"bad", {}}, results.runs, {"good", "N=4"}).size(), 2u);
  EXPECT_EQ(compare(results.runs, {}, results.runs, {}).size(), 6u) << "every filter with itself";
  EXPECT_EQ(compare(results.runs, {"good", {}}, results.runs, {}).size(), 4u);
  EXPECT_EQ(refusal([&] {
              static_cast<void>(compare(results.runs, {"god", {}}, results.runs, {"bad", {}}));
            }),
            "compare: no run of 'god' on the left; there are: good:N=1, good:N=4, bad");
  EXPECT_NE(refusal([&] {
              static_cast<void>(compare(results.runs, {"good", {}}, results.runs, {"bad", {}}));
            }).find("no scenario, metric and parameters in common"),
            std::string::npos);
}

TEST_F(Report, PlotsHaveTheLinesToSeeThemBy) {
  const Results results = results_of({"filters[1].role=baseline", "plots=[error]", kReferences[0]});
  const std::vector<report::Plot> against_n = parameter_plots(results, "near");
  ASSERT_EQ(against_n.size(), 1u);
  ASSERT_EQ(against_n[0].series.size(), 2u);  // good, and the paper's
  EXPECT_EQ(against_n[0].series[0].points.size(), 2u);
  EXPECT_EQ(against_n[0].series[1].css_class, "paper-0");
  ASSERT_EQ(against_n[0].lines.size(), 1u);
  EXPECT_EQ(against_n[0].lines[0].css_class, "odometry");
  const std::vector<report::Plot> cost = cost_plots(results, "near");
  ASSERT_EQ(cost.size(), 1u);
  EXPECT_DOUBLE_EQ(cost[0].series[0].points[1].x, 4.0) << "milliseconds";
  EXPECT_EQ(cost[0].lines.size(), 1u);
  const std::vector<report::Plot> over_time = time_plots(results, "near");
  ASSERT_EQ(over_time.size(), 2u);  // N = 1 and N = 4
  for (const report::Plot& plot : over_time) {
    EXPECT_EQ(plot.series.size(), 2u) << "the line is in both";
    EXPECT_FALSE(plot.y_logarithmic);
  }
  Results wide = results;
  for (SeriesRow& row : wide.series) row.mean = row.time > 0.0 ? 1e5 : 1.0;
  EXPECT_TRUE(time_plots(wide, "near")[0].y_logarithmic);
}

TEST_F(Report, WritesAPageTablesAndFigures) {
  static_cast<void>(results_of(kReferences));
  write_report(last_);
  const std::string page = read_file(last_ / "report.html");
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_EQ(page.find("http"), std::string::npos) << "self-contained";
  EXPECT_NE(page.find("8 of 72 runs"), std::string::npos) << "diverged";
  const std::string tex = read_file(last_ / "tables.tex");
  EXPECT_NE(tex.find("\\toprule"), std::string::npos);
  EXPECT_EQ(tex.find(kDash), std::string::npos) << "only what LaTeX can set";
  EXPECT_FALSE(read_comparisons(last_ / "comparisons.csv").empty());
  EXPECT_TRUE(std::filesystem::exists(last_ / "figures" / "near-error-against-N.svg"));
  const std::string once = page;
  write_report(last_);
  EXPECT_EQ(read_file(last_ / "report.html"), once);
}

TEST_F(Report, RefusesAFolderWithoutResults) {
  EXPECT_NE(refusal([&] { write_report(folder_ / "nothing"); }).find("expected a folder of results"),
            std::string::npos);
}

TEST(Latex, EscapesWhatItWouldReadAsMarkup) {
  const ResultTable table{"a_b & 5 %",
                          "x",
                          {{"p < 0.1", "1\xC2\xB0", ""}},
                          {{"\xE2\x88\x92"
                            "1",
                            {{"2", "[1, 3]", ""}}}}};
  EXPECT_EQ(to_latex(table, "tab:a"),
            "\\begin{table}\n\\centering\n\\caption{a\\_b \\& 5 \\%}\n\\label{tab:a}\n\\begin{tabular}{lr}\n\\toprule\n"
            "x & p $<$ 0.1 {\\scriptsize 1$^\\circ$} \\\\\n\\midrule\n$-$1 & 2 {\\scriptsize [1, 3]} \\\\\n"
            "\\bottomrule\n\\end{tabular}\n\\end{table}\n");
}

TEST(Decimals, ShowTwoDigitsOfTheUncertainty) {
  EXPECT_EQ(decimals_for(0.11, 1.21), 2);
  EXPECT_EQ(decimals_for(1.05, 12.9), 1);
  EXPECT_EQ(decimals_for(0.0087, 0.1), 4);
  EXPECT_EQ(decimals_for(37.0, 500.0), 0);
  EXPECT_EQ(decimals_for(0.0, 0.0), 0);
  EXPECT_EQ(decimals_for(1e-17, 0.15), 3);  // equal runs, but for rounding
}

TEST(InWords, KnowsInitials) {
  EXPECT_EQ(in_words("position_rmse"), "Position RMSE");
  EXPECT_EQ(in_words("nees_mean"), "NEES mean");
}

}  // namespace
}  // namespace noctule::experiment
