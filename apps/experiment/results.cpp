#include <algorithm>
#include <iostream>
#include <sstream>

#include "apps/experiment/commands.hpp"
#include "config/config.hpp"
#include "core/error.hpp"
#include "experiment/csv.hpp"
#include "experiment/pages.hpp"
#include "experiment/report.hpp"
#include "experiment/result_table.hpp"
#include "report/files.hpp"

namespace noctule::apps {
namespace {

namespace fs = std::filesystem;

struct Side {
  fs::path folder;
  experiment::Selection selection;
};

Side parse_side(const std::string& text, const fs::path& default_folder) {
  std::vector<std::string> parts = experiment::split(text, ':');
  Side side{default_folder, {}};
  if (fs::exists(fs::path(parts.front()) / "runs.csv")) {
    side.folder = parts.front();
    parts.erase(parts.begin());
  }
  if (parts.size() > 2) {
    throw InputError("compare: expected FOLDER, FILTER, FILTER:PARAMETERS or FOLDER:FILTER:PARAMETERS, got '" + text +
                     "'");
  }
  if (!parts.empty()) side.selection.filter = parts[0];
  if (parts.size() > 1) {
    std::ranges::replace(parts[1], ',', ';');  // which shells leave alone
    side.selection.parameters = parts[1];
  }
  return side;
}

/// Where two folders ran different worlds under one name, equal seeds share nothing.
void warn_of_different_worlds(const experiment::Experiment& a, const experiment::Experiment& b) {
  for (const experiment::ScenarioSpec& s : a.scenarios) {
    const auto other = std::ranges::find(b.scenarios, s.name, &experiment::ScenarioSpec::name);
    if (other != b.scenarios.end() && config::dump(s) != config::dump(*other)) {
      std::cerr << "warning: scenario '" << s.name
                << "' is configured differently in the two folders: the differences below are between two worlds\n";
    }
  }
}

/// Characters on a terminal.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

void print(const experiment::ResultTable& table) {
  std::vector<std::vector<std::string>> lines(1);
  lines[0].push_back(table.corner);
  for (const auto& column : table.columns) lines[0].push_back(column.title);
  for (const auto& row : table.rows) {
    lines.push_back({row.title});
    for (const auto& cell : row.cells) {
      lines.back().push_back(cell.value + (cell.detail.empty() ? "" : " " + cell.detail));
    }
  }
  std::vector<std::size_t> widths(lines[0].size(), 0);
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], width(line[i]));
  }
  std::cout << table.caption << "\n";
  for (const auto& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) text += line[i] + std::string(widths[i] - width(line[i]) + 2, ' ');
    std::cout << text.substr(0, text.find_last_not_of(' ') + 1) << "\n";
  }
}

}  // namespace

void report_experiment(const fs::path& directory) {
  experiment::write_report(directory);
  std::cout << (directory / "report.html").string() << "\n";
}

void compare_results(const std::string& a, const std::string& b, const fs::path& folder, const fs::path& csv) {
  const Side left = parse_side(a, folder), right = parse_side(b, folder);
  const experiment::Results of_left = experiment::load_results(left.folder);
  const experiment::Results of_right = experiment::load_results(right.folder);
  warn_of_different_worlds(of_left.experiment, of_right.experiment);
  const std::vector<experiment::Comparison> all =
      experiment::compare(of_left.runs, left.selection, of_right.runs, right.selection);
  for (const experiment::ScenarioSpec& scenario : of_left.experiment.scenarios) {
    const experiment::ResultTable table = experiment::comparison_table(all, scenario.name);
    if (!table.rows.empty()) print(table);
  }
  if (csv.empty()) return;
  std::ostringstream text;
  experiment::write_comparisons(text, all);
  report::write_file(csv, text.str());
}

int refresh_pages(const std::vector<fs::path>& pages, bool check) {
  int exit_code = 0;
  for (const fs::path& page : pages) {
    const std::string text = report::read_file(page);
    const std::string fresh = experiment::refreshed_page(text, page);
    for (const std::string& line : experiment::unsupported_figures(fresh)) {
      std::cerr << page.string() << ":" << line << " is in no table or figure of the page\n";
      exit_code = 1;
    }
    if (fresh == text) continue;
    if (check) {
      std::cerr << page.string() << ": does not say what its results say (scripts/results --pages)\n";
      exit_code = 1;
    } else {
      report::write_file(page, fresh);
      std::cout << page.string() << "\n";
    }
  }
  return exit_code;
}

}  // namespace noctule::apps
