#include "experiment/table.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <ostream>
#include <tuple>

#include "core/error.hpp"
#include "eval/number_text.hpp"
#include "eval/statistics.hpp"

namespace noctule::experiment {
namespace {

constexpr const char* kHeader = "scenario,filter,parameters,seed,metric,unit,value,diverged";
constexpr std::size_t kColumns = 8;

std::string number(double value) {
  return std::isfinite(value) ? eval::shortest(value) : std::string();
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

template <class T>
bool parse(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

void write_rows(std::ostream& out, std::span<const Row> rows) {
  out << kHeader << '\n';
  for (const Row& row : rows) {
    out << row.scenario << ',' << row.filter << ',' << row.parameters << ',' << row.seed << ',' << row.metric << ','
        << row.unit << ',' << number(row.value) << ',' << (row.diverged ? 1 : 0) << '\n';
  }
}

std::vector<Row> read_rows(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) throw InputError(file.string() + ": cannot be read");
  if (line != kHeader) throw InputError(file.string() + ":1: expected the header " + kHeader + ", got '" + line + "'");
  std::vector<Row> rows;
  for (int number = 2; std::getline(in, line); ++number) {
    const std::vector<std::string> cells = split(line);
    Row row;
    int diverged = 0;
    const bool sound = cells.size() == kColumns && parse(cells[3], row.seed) && parse(cells[7], diverged) &&
                       (cells[6].empty() || parse(cells[6], row.value));
    if (!sound) {
      throw InputError(file.string() + ":" + std::to_string(number) + ": expected " + kHeader + ", got '" + line + "'");
    }
    if (cells[6].empty()) row.value = std::numeric_limits<double>::quiet_NaN();
    row.scenario = cells[0];
    row.filter = cells[1];
    row.parameters = cells[2];
    row.metric = cells[4];
    row.unit = cells[5];
    row.diverged = diverged != 0;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<SummaryRow> summarise(std::span<const Row> rows) {
  struct Group {
    SummaryRow summary;
    std::vector<double> values;
  };
  std::vector<Group> groups;
  std::map<std::tuple<std::string, std::string, std::string, std::string>, std::size_t> index;
  for (const Row& row : rows) {
    const auto [at, fresh] = index.try_emplace({row.scenario, row.filter, row.parameters, row.metric}, groups.size());
    if (fresh) groups.push_back({{row.scenario, row.filter, row.parameters, row.metric, row.unit}, {}});
    Group& group = groups[at->second];
    group.summary.diverged += row.diverged ? 1 : 0;
    if (std::isfinite(row.value)) group.values.push_back(row.value);
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<SummaryRow> result;
  for (Group& group : groups) {
    SummaryRow& s = group.summary;
    s.n = static_cast<int>(group.values.size());
    s.mean = s.n > 0 ? eval::mean(group.values) : nan;
    s.sd = s.n > 1 ? eval::standard_deviation(group.values) : nan;
    s.ci95 = s.n > 1 ? eval::t_interval(group.values) : Interval{nan, nan};
    result.push_back(std::move(s));
  }
  return result;
}

void write_summary(std::ostream& out, std::span<const SummaryRow> rows) {
  out << "scenario,filter,parameters,metric,unit,n,diverged,mean,sd,ci95_low,ci95_high\n";
  for (const SummaryRow& row : rows) {
    out << row.scenario << ',' << row.filter << ',' << row.parameters << ',' << row.metric << ',' << row.unit << ','
        << row.n << ',' << row.diverged << ',' << number(row.mean) << ',' << number(row.sd) << ','
        << number(row.ci95.low) << ',' << number(row.ci95.high) << '\n';
  }
}

}  // namespace noctule::experiment
