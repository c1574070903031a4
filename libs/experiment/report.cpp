#include "experiment/report.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "core/error.hpp"
#include "experiment/result_plots.hpp"
#include "experiment/result_table.hpp"
#include "report/document.hpp"
#include "report/files.hpp"
#include "report/text.hpp"

namespace noctule::experiment {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMethods =
    "Every filter meets the same random numbers at the same seed. Intervals of means: Student\xE2\x80\x99s t. A run "
    "has "
    "diverged when its estimate is not a number or is off by more than 3 m and more than 10 % of the path at its end; "
    "such "
    "runs are counted, and are in the mean wherever they have a number. Paired differences are by seed; a seed at "
    "which "
    "either filter has no number is dropped from the pairs and counted. p (t): paired t test; p (sign flips): "
    "permutation "
    "test; Holm: corrected for all comparisons of the table, those of one parameter's values for themselves. Muted "
    "columns, open marks and dotted lines: published "
    "figures.";

std::vector<report::Plot> plots_of(const Results& results, const std::string& scenario) {
  std::vector<report::Plot> all = parameter_plots(results, scenario);
  for (const auto& more : {time_plots(results, scenario), cost_plots(results, scenario)}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

std::string plot_grid(const std::vector<report::Plot>& plots) {
  std::string content;
  for (const report::Plot& plot : plots) content += report::plot_html(plot);
  return content.empty() ? "" : "<div class=\"pair\">\n" + content + "</div>\n";
}

std::string scenario_section(const Results& results, const std::vector<Comparison>& comparisons,
                             const std::string& scenario) {
  std::string content;
  for (const ResultTable& table : result_tables(results, scenario)) content += to_html(table);
  content += plot_grid(plots_of(results, scenario));
  const ResultTable compared = comparison_table(comparisons, scenario);
  if (!compared.rows.empty()) content += to_html(compared);
  return report::section(report::escape(scenario), "", content);
}

std::string diverged_text(const Results& results) {
  std::map<std::pair<Subject, std::uint64_t>, bool> runs;
  for (const Row& row : results.runs) runs[{{row.scenario, row.filter, row.parameters}, row.seed}] = row.diverged;
  const auto diverged = std::ranges::count_if(runs, [](const auto& run) { return run.second; });
  return std::to_string(diverged) + " of " + std::to_string(runs.size()) + " runs";
}

}  // namespace

std::string report_page(const Results& results, const std::string& configuration) {
  const Experiment& e = results.experiment;
  const std::vector<Comparison> comparisons = standard_comparisons(results);
  std::string content;
  for (const ScenarioSpec& scenario : e.scenarios) content += scenario_section(results, comparisons, scenario.name);
  return report::document(
      e.name,
      report::page_header("Noctule experiment", e.name,
                          {{"Seeds", std::to_string(e.first_seed) + " to " + std::to_string(e.last_seed)},
                           {"Scenarios", std::to_string(e.scenarios.size())},
                           {"Filters", std::to_string(expand(e.filters).size())},
                           {"Diverged", diverged_text(results)}}),
      (content.empty() ? "<p class=\"lead\">No run is done yet.</p>\n" : content) +
          report::section("How to read this", kMethods, report::folded("Effective configuration", configuration)));
}

std::string latex_tables(const Results& results) {
  const std::vector<Comparison> comparisons = standard_comparisons(results);
  std::string text = "% \\usepackage{booktabs}\n";
  for (const ScenarioSpec& scenario : results.experiment.scenarios) {
    int number = 0;
    const auto add = [&](const ResultTable& table) {
      text += "\n" + to_latex(table, "tab:" + scenario.name + "-" + std::to_string(++number));
    };
    for (const ResultTable& table : result_tables(results, scenario.name)) add(table);
    const ResultTable compared = comparison_table(comparisons, scenario.name);
    if (!compared.rows.empty()) add(compared);
  }
  return text;
}

void write_report(const fs::path& directory) {
  const Results results = load_results(directory);
  std::error_code error;
  fs::create_directories(directory / "figures", error);
  if (error) throw InputError((directory / "figures").string() + ": cannot be created (" + error.message() + ")");
  std::ostringstream comparisons;
  write_comparisons(comparisons, standard_comparisons(results));
  report::write_file(directory / "comparisons.csv", comparisons.str());
  report::write_file(directory / "tables.tex", latex_tables(results));
  const std::string style = report::printed_figure_style();
  for (const ScenarioSpec& scenario : results.experiment.scenarios) {
    for (const report::Plot& plot : plots_of(results, scenario.name)) {
      report::write_file(directory / "figures" / (plot.id + ".svg"), report::plot_svg(plot, style));
    }
  }
  report::write_file(directory / "report.html", report_page(results, report::read_file(directory / "experiment.yaml")));
}

}  // namespace noctule::experiment
