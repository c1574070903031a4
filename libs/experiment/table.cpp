#include "experiment/table.hpp"

#include <cmath>
#include <map>
#include <ostream>
#include <tuple>

#include "core/error.hpp"
#include "core/limits.hpp"
#include "eval/statistics.hpp"
#include "experiment/csv.hpp"

namespace noctule::experiment {
namespace {

constexpr const char* kRunsHeader = "scenario,filter,parameters,seed,metric,unit,value,diverged";
constexpr const char* kSummaryHeader = "scenario,filter,parameters,metric,unit,n,diverged,mean,sd,ci95_low,ci95_high";
constexpr const char* kSeriesHeader = "scenario,filter,parameters,metric,unit,time,mean,ci95_low,ci95_high";

struct MeanAndInterval {
  double mean = kNan;
  Interval ci95{kNan, kNan};
};

MeanAndInterval mean_and_interval(std::span<const double> finite_values) {
  if (finite_values.empty()) return {};
  return {eval::mean(finite_values), eval::t_interval(finite_values)};
}

std::ostream& operator<<(std::ostream& out, const Subject& s) {
  return out << s.scenario << ',' << s.filter << ',' << s.parameters;
}

std::ostream& operator<<(std::ostream& out, const Interval& interval) {
  return out << csv_number(interval.low) << ',' << csv_number(interval.high);
}

Subject subject_of(const CsvTable& table, std::size_t line) {
  return {table.text(line, 0), table.text(line, 1), table.text(line, 2)};
}

/// Groups in the order of first appearance.
template <class Group>
class Groups {
 public:
  Group& at(const Subject& subject, const std::string& metric) {
    const auto [place, fresh] = index_.try_emplace({subject, metric}, groups_.size());
    if (fresh) groups_.emplace_back();
    return groups_[place->second];
  }
  std::vector<Group>& all() { return groups_; }

 private:
  std::map<std::pair<Subject, std::string>, std::size_t> index_;
  std::vector<Group> groups_;
};

}  // namespace

void write_rows(std::ostream& out, std::span<const Row> rows) {
  out << kRunsHeader << '\n';
  for (const Row& row : rows) {
    out << row.scenario << ',' << row.filter << ',' << row.parameters << ',' << row.seed << ',' << row.metric << ','
        << row.unit << ',' << csv_number(row.value) << ',' << (row.diverged ? 1 : 0) << '\n';
  }
}

std::vector<Row> read_rows(const std::filesystem::path& file) {
  const CsvTable table(file, kRunsHeader);
  std::vector<Row> rows;
  rows.reserve(table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    rows.push_back({table.text(i, 0), table.text(i, 1), table.text(i, 2), table.count(i, 3), table.text(i, 4),
                    table.text(i, 5), table.number(i, 6), table.count(i, 7) != 0});
  }
  return rows;
}

std::vector<SummaryRow> summarise(std::span<const Row> rows) {
  struct Group {
    SummaryRow summary;
    std::vector<double> values;
  };
  Groups<Group> groups;
  for (const Row& row : rows) {
    const Subject subject{row.scenario, row.filter, row.parameters};
    Group& group = groups.at(subject, row.metric);
    group.summary.subject = subject;
    group.summary.metric = row.metric;
    group.summary.unit = row.unit;
    group.summary.diverged += row.diverged ? 1 : 0;
    if (std::isfinite(row.value)) group.values.push_back(row.value);
  }
  std::vector<SummaryRow> result;
  for (Group& group : groups.all()) {
    SummaryRow& s = group.summary;
    s.n = static_cast<int>(group.values.size());
    s.sd = s.n > 1 ? eval::standard_deviation(group.values) : kNan;
    const MeanAndInterval m = mean_and_interval(group.values);
    s.mean = m.mean;
    s.ci95 = m.ci95;
    result.push_back(std::move(s));
  }
  return result;
}

void write_summary(std::ostream& out, std::span<const SummaryRow> rows) {
  out << kSummaryHeader << '\n';
  for (const SummaryRow& row : rows) {
    out << row.subject << ',' << row.metric << ',' << row.unit << ',' << row.n << ',' << row.diverged << ','
        << csv_number(row.mean) << ',' << csv_number(row.sd) << ',' << row.ci95 << '\n';
  }
}

std::vector<SummaryRow> read_summary(const std::filesystem::path& file) {
  const CsvTable table(file, kSummaryHeader);
  std::vector<SummaryRow> rows;
  for (std::size_t i = 0; i < table.size(); ++i) {
    rows.push_back({subject_of(table, i),
                    table.text(i, 3),
                    table.text(i, 4),
                    static_cast<int>(table.count(i, 5)),
                    static_cast<int>(table.count(i, 6)),
                    table.number(i, 7),
                    table.number(i, 8),
                    {table.number(i, 9), table.number(i, 10)}});
  }
  return rows;
}

std::vector<SeriesRow> summarise(std::span<const SeriesOfRun> curves) {
  struct Group {
    const SeriesOfRun* first = nullptr;
    std::vector<std::vector<double>> values;  ///< of all seeds, by time
  };
  Groups<Group> groups;
  for (const SeriesOfRun& curve : curves) {
    const Series& series = curve.series;
    Group& group = groups.at(curve.subject, series.metric);
    if (group.first == nullptr) {
      group.first = &curve;
      group.values.resize(series.time.size());
    }
    if (group.first->series.time != series.time) {
      throw InputError("scenario '" + curve.subject.scenario + "': series '" + series.metric +
                       "': expected the same times for every seed");
    }
    for (std::size_t i = 0; i < series.values.size(); ++i) {
      if (std::isfinite(series.values[i])) group.values[i].push_back(series.values[i]);
    }
  }
  std::vector<SeriesRow> rows;
  for (const Group& group : groups.all()) {
    const auto& [subject, series] = *group.first;
    for (std::size_t i = 0; i < group.values.size(); ++i) {
      const MeanAndInterval m = mean_and_interval(group.values[i]);
      rows.push_back({subject, series.metric, series.unit, series.time[i], m.mean, m.ci95});
    }
  }
  return rows;
}

void write_series(std::ostream& out, std::span<const SeriesRow> rows) {
  out << kSeriesHeader << '\n';
  for (const SeriesRow& row : rows) {
    out << row.subject << ',' << row.metric << ',' << row.unit << ',' << csv_number(row.time) << ','
        << csv_number(row.mean) << ',' << row.ci95 << '\n';
  }
}

std::vector<SeriesRow> read_series(const std::filesystem::path& file) {
  const CsvTable table(file, kSeriesHeader);
  std::vector<SeriesRow> rows;
  for (std::size_t i = 0; i < table.size(); ++i) {
    rows.push_back({subject_of(table, i),
                    table.text(i, 3),
                    table.text(i, 4),
                    table.number(i, 5),
                    table.number(i, 6),
                    {table.number(i, 7), table.number(i, 8)}});
  }
  return rows;
}

}  // namespace noctule::experiment
