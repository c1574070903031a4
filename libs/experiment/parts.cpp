#include "experiment/parts.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "config/config.hpp"
#include "core/error.hpp"
#include "experiment/csv.hpp"
#include "report/files.hpp"

namespace noctule::experiment {
namespace {

namespace fs = std::filesystem;

/// `time` is of series alone; time and value of a series are lists with spaces in between.
constexpr const char* kPartHeader = "kind,filter,parameters,metric,unit,diverged,time,value";
enum Column { kKind, kFilter, kParameters, kMetric, kUnit, kDiverged, kTime, kValue };

std::string list_of(std::span<const double> values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) text += (i == 0 ? "" : " ") + csv_number(values[i]);
  return text;
}

struct Part {
  std::vector<Row> figures;
  std::vector<Row> timings;
  std::vector<SeriesOfRun> series;
};

/// Adds what one file says.
void read_part(const fs::path& file, const std::string& scenario, std::uint64_t seed, Part& part) {
  const CsvTable table(file, kPartHeader);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.text(i, kKind) == "series") {
      part.series.push_back(
          {{scenario, table.text(i, kFilter), table.text(i, kParameters)},
           {table.text(i, kMetric), table.text(i, kUnit), table.numbers(i, kTime), table.numbers(i, kValue)}});
      continue;
    }
    std::vector<Row>& rows = table.text(i, kKind) == "figure" ? part.figures : part.timings;
    rows.push_back({scenario, table.text(i, kFilter), table.text(i, kParameters), seed, table.text(i, kMetric),
                    table.text(i, kUnit), table.number(i, kValue), table.count(i, kDiverged) != 0});
  }
}

/// What makes the figures: the text of the experiment without what only reports look at.
std::string identity(Experiment experiment) {
  experiment.name.clear();
  experiment.references.clear();
  experiment.plots.clear();
  experiment.compare.clear();
  for (FilterSpec& filter : experiment.filters) filter.role = Role::compared;
  return config::dump(experiment);
}

bool holds(const fs::path& directory, const Experiment& experiment) {
  try {
    return identity(config::load<Experiment>(directory / "experiment.yaml")) == identity(experiment);
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

ResultsFolder ResultsFolder::claim(const fs::path& directory, const Experiment& experiment) {
  std::error_code error;
  fs::create_directories(directory / "parts", error);
  if (error) throw InputError(directory.string() + ": cannot be created (" + error.message() + ")");
  const fs::path file = directory / "experiment.yaml";
  if (fs::exists(file) && !holds(directory, experiment)) {
    throw InputError(directory.string() + ": holds the results of another experiment (see experiment.yaml there); " +
                     "choose another folder or delete it");
  }
  report::write_file(file, config::dump(experiment));
  return ResultsFolder(directory);
}

ResultsFolder ResultsFolder::open(const fs::path& directory, const Experiment& experiment) {
  if (!holds(directory, experiment)) {
    throw InputError(directory.string() + ": holds no results of this experiment (see experiment.yaml there)");
  }
  return ResultsFolder(directory);
}

fs::path ResultsFolder::part(const Plan& plan, const Piece& piece) const {
  return directory_ / "parts" / (plan.scenarios[piece.scenario].name + '-' + std::to_string(piece.seed) + ".csv");
}

bool ResultsFolder::has(const Plan& plan, const Piece& piece) const {
  return fs::exists(part(plan, piece));
}

void ResultsFolder::write(const Plan& plan, const Piece& piece, std::span<const FilterRun> runs) const {
  const PlannedScenario& scenario = plan.scenarios[piece.scenario];
  if (runs.size() != scenario.filters.size()) {
    throw std::logic_error("scenario '" + scenario.name + "' ran another number of filters than it was given");
  }
  std::ostringstream out;
  out << kPartHeader << '\n';
  for (std::size_t f = 0; f < runs.size(); ++f) {
    const auto line = [&](const char* kind, const std::string& metric, const std::string& unit, const std::string& time,
                          const std::string& value) {
      out << kind << ',' << scenario.filters[f].name << ',' << scenario.filters[f].parameters << ',' << metric << ','
          << unit << ',' << (runs[f].diverged ? 1 : 0) << ',' << time << ',' << value << '\n';
    };
    const auto kept = [&](const std::string& metric) {
      if (std::ranges::find(scenario.metrics, metric) != scenario.metrics.end()) return true;
      if (std::ranges::find(scenario.dropped, metric) != scenario.dropped.end()) return false;
      throw std::logic_error("scenario '" + scenario.name + "' does not list its metric '" + metric + "'");
    };
    for (const eval::Metric& m : runs[f].figures) {
      if (kept(m.name)) line("figure", m.name, m.unit, "", csv_number(m.value));
    }
    for (const eval::Metric& m : runs[f].timings) line("timing", m.name, m.unit, "", csv_number(m.value));
    for (const Series& s : runs[f].series) {
      if (kept(s.metric)) line("series", s.metric, s.unit, list_of(s.time), list_of(s.values));
    }
  }
  report::write_file(part(plan, piece), out.str());
}

void ResultsFolder::copy_from(const ResultsFolder& other, const Plan& plan, const Piece& piece) const {
  report::write_file(part(plan, piece), report::read_file(other.part(plan, piece)));
}

void ResultsFolder::write_tables(const Plan& plan) const {
  Part all;
  for (const Piece& piece : plan.pieces) {
    if (has(plan, piece)) read_part(part(plan, piece), plan.scenarios[piece.scenario].name, piece.seed, all);
  }
  const auto write = [&](const char* name, const auto& print) {
    std::ostringstream out;
    print(out);
    report::write_file(directory_ / name, out.str());
  };
  write("runs.csv", [&](std::ostream& out) { write_rows(out, all.figures); });
  write("summary.csv", [&](std::ostream& out) { write_summary(out, summarise(all.figures)); });
  write("timing.csv", [&](std::ostream& out) { write_summary(out, summarise(all.timings)); });
  write("series.csv", [&](std::ostream& out) { write_series(out, summarise(all.series)); });
}

}  // namespace noctule::experiment
