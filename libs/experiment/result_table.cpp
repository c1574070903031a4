#include "experiment/result_table.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

#include "experiment/csv.hpp"
#include "report/table_html.hpp"
#include "report/text.hpp"

namespace noctule::experiment {
namespace {

constexpr std::size_t kFewSubjects = 6;
constexpr const char* kDash = "\xE2\x80\x94";

/// Rows of one scenario.
std::vector<SummaryRow> rows_of(const Results& results, const std::string& scenario) {
  std::vector<SummaryRow> rows;
  for (const SummaryRow& row : results.summary) {
    if (row.subject.scenario == scenario) rows.push_back(row);
  }
  return rows;
}

/// Distinct values in the order of first appearance.
template <class Range, class Projection>
auto distinct(const Range& range, const Projection& projection) {
  std::vector<std::decay_t<decltype(projection(*std::begin(range)))>> values;
  for (const auto& item : range) {
    const auto value = projection(item);
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
  }
  return values;
}

const SummaryRow* find(const std::vector<SummaryRow>& rows, const Subject& subject, const std::string& metric) {
  const auto at =
      std::ranges::find_if(rows, [&](const SummaryRow& row) { return row.subject == subject && row.metric == metric; });
  return at == rows.end() ? nullptr : &*at;
}

std::string class_of(const Results& results, const std::string& filter) {
  const Role role = role_of(results.experiment, filter);
  return role == Role::baseline ? "odometry" : role == Role::limit ? "limit" : "";
}

double half_width(const SummaryRow& row) {
  return 0.5 * (row.ci95.high - row.ci95.low);
}

/// Not the rounding of a filter that draws no random numbers.
bool says_something(double half_width, double value) {
  constexpr double kRounding = 1e-9;
  return std::isfinite(half_width) && half_width > kRounding * std::abs(value);
}

/// With a true minus sign; very large ones as powers of ten; a dash for what is not finite.
std::string number_text(double value, int decimals) {
  constexpr double kLarge = 1e6;
  return std::abs(value) < kLarge ? report::aligned(value, decimals) : report::printed(value);
}

/// How all values of a metric are printed.
struct Print {
  report::PrintUnit unit;
  int decimals = 2;

  Print(const std::vector<SummaryRow>& rows, const std::string& metric) {
    double largest = 0.0, narrowest = std::numeric_limits<double>::infinity();
    std::string si = "1";
    for (const SummaryRow& row : rows) {
      if (row.metric != metric) continue;
      si = row.unit;
      if (std::isfinite(row.mean)) largest = std::max(largest, std::abs(row.mean));
      if (says_something(half_width(row), row.mean)) narrowest = std::min(narrowest, half_width(row));
    }
    unit = printed_unit(si, largest);
    decimals = decimals_for(narrowest * unit.scale, largest * unit.scale);
  }

  [[nodiscard]] std::string number(double si) const { return number_text(si * unit.scale, decimals); }
  [[nodiscard]] std::string interval(const Interval& si) const {
    return std::isfinite(si.low) ? "[" + number(si.low) + ", " + number(si.high) + "]" : "";
  }
  [[nodiscard]] std::string title(const std::string& metric) const {
    return in_words(metric) + (unit.symbol.empty() ? "" : " [" + unit.symbol + "]");
  }
};

int runs_of(const Results& results) {
  return static_cast<int>(results.experiment.last_seed - results.experiment.first_seed + 1);
}

TableCell cell_of(const Results& results, const SummaryRow* row, const Print& print) {
  if (row == nullptr) return {kDash, "", ""};
  std::string detail = print.interval(row->ci95);
  if (row->n < runs_of(results)) detail += (detail.empty() ? "n = " : "; n = ") + std::to_string(row->n);
  return {print.number(row->mean), detail, class_of(results, row->subject.filter)};
}

/// Of a subject: the same for all its metrics, except that a metric may be missing in some run.
int diverged(const std::vector<SummaryRow>& rows, const Subject& subject) {
  int count = 0;
  for (const SummaryRow& row : rows) count = row.subject == subject ? std::max(count, row.diverged) : count;
  return count;
}

std::vector<Reference> references_of(const Results& results, const std::string& scenario) {
  std::vector<Reference> references;
  for (const Reference& r : results.experiment.references) {
    if (r.scenario == scenario) references.push_back(r);
  }
  return references;
}

std::string source_column(const Reference& r) {
  return r.source + '\n' + r.filter + '\n' + r.parameters;
}

/// A metric a row.
ResultTable metrics_table(const Results& results, const std::string& scenario, const std::vector<SummaryRow>& rows,
                          const std::vector<Subject>& subjects) {
  ResultTable table{scenario, "mean [95 % interval]", {}, {}};
  for (const Subject& s : subjects) table.columns.push_back({s.filter, s.parameters, class_of(results, s.filter)});
  const std::vector<Reference> references = references_of(results, scenario);
  const std::vector<std::string> sources = distinct(references, source_column);
  for (const std::string& source : sources) {
    const std::vector<std::string> lines = split(source, '\n');
    table.columns.push_back({lines[1] + (lines[2].empty() ? "" : ", " + lines[2]), lines[0], "paper"});
  }
  for (const std::string& metric : distinct(rows, [](const SummaryRow& row) { return row.metric; })) {
    const Print print(rows, metric);
    TableRow line{print.title(metric), {}};
    for (const Subject& s : subjects) line.cells.push_back(cell_of(results, find(rows, s, metric), print));
    for (const std::string& source : sources) {
      const auto at = std::ranges::find_if(
          references, [&](const Reference& r) { return r.metric == metric && source_column(r) == source; });
      line.cells.push_back({at == references.end() ? "" : print.number(at->value), "", "paper"});
    }
    table.rows.push_back(std::move(line));
  }
  TableRow counts{"Diverged runs of " + std::to_string(runs_of(results)), {}};
  for (const Subject& s : subjects) counts.cells.push_back({std::to_string(diverged(rows, s)), "", ""});
  counts.cells.resize(table.columns.size());
  table.rows.push_back(std::move(counts));
  return table;
}

/// A parameter set a row, a filter a column; `cell` makes what stands in both.
template <class Cell>
ResultTable parameter_table(const Results& results, const std::vector<Subject>& subjects, const Cell& cell) {
  ResultTable table;
  table.corner = "parameters";
  const auto filters = distinct(subjects, [](const Subject& s) { return s.filter; });
  for (const std::string& filter : filters) table.columns.push_back({filter, "", class_of(results, filter)});
  for (const std::string& parameters : distinct(subjects, [](const Subject& s) { return s.parameters; })) {
    TableRow line{parameters.empty() ? kDash : parameters, {}};
    for (const std::string& filter : filters) {
      const Subject subject{subjects.front().scenario, filter, parameters};
      line.cells.push_back(std::ranges::find(subjects, subject) == subjects.end() ? TableCell{} : cell(subject));
    }
    table.rows.push_back(std::move(line));
  }
  return table;
}

/// Whether parameters say all that a source says of its own: N=20;mode=a says N=20.
bool says(const std::string& parameters, const std::string& published) {
  const auto ours = assignments(parameters), theirs = assignments(published);
  return parameters == published || (!theirs.empty() && std::ranges::all_of(theirs, [&](const auto& assignment) {
           return std::ranges::find(ours, assignment) != ours.end();
         }));
}

void add_references(ResultTable& table, const std::vector<Reference>& references, const Print& print) {
  for (const std::string& source :
       distinct(references, [](const Reference& r) { return r.source + '\n' + r.filter; })) {
    const std::vector<std::string> lines = split(source, '\n');
    table.columns.push_back({lines[1], lines[0], "paper"});
    for (TableRow& row : table.rows) row.cells.resize(table.columns.size());
    for (const Reference& r : references) {
      if (r.source + '\n' + r.filter != source) continue;
      const TableCell cell{print.number(r.value), "", "paper"};
      const std::string title = r.parameters.empty() ? kDash : r.parameters;
      bool placed = false;
      for (TableRow& row : table.rows) {
        if (!says(row.title, title)) continue;
        row.cells.back() = cell;
        placed = true;
      }
      if (placed) continue;
      table.rows.push_back({title, {}});
      table.rows.back().cells.resize(table.columns.size());
      table.rows.back().cells.back() = cell;
    }
  }
}

std::vector<ResultTable> tables_of_parameters(const Results& results, const std::string& scenario,
                                              const std::vector<SummaryRow>& rows,
                                              const std::vector<Subject>& subjects) {
  std::vector<ResultTable> tables;
  const std::vector<Reference> references = references_of(results, scenario);
  for (const std::string& metric : distinct(rows, [](const SummaryRow& row) { return row.metric; })) {
    const Print print(rows, metric);
    tables.push_back(parameter_table(results, subjects,
                                     [&](const Subject& s) { return cell_of(results, find(rows, s, metric), print); }));
    tables.back().caption = scenario + ": " + print.title(metric) + ", mean [95 % interval]";
    std::vector<Reference> of_metric;
    std::ranges::copy_if(references, std::back_inserter(of_metric),
                         [&](const Reference& r) { return r.metric == metric; });
    add_references(tables.back(), of_metric, print);
  }
  tables.push_back(parameter_table(results, subjects, [&](const Subject& s) {
    return TableCell{std::to_string(diverged(rows, s)), "", class_of(results, s.filter)};
  }));
  tables.back().caption = scenario + ": diverged runs of " + std::to_string(runs_of(results));
  return tables;
}

std::string p_text(double p) {
  if (std::isnan(p)) return kDash;
  return p < 0.001 ? "< 0.001" : report::fixed(p, 3);
}

/// Those of a scenario, all of one metric together.
std::vector<Comparison> by_metric(std::span<const Comparison> comparisons, const std::string& scenario) {
  std::vector<Comparison> sorted;
  for (const std::string& metric : distinct(comparisons, [](const Comparison& c) { return c.metric; })) {
    std::ranges::copy_if(comparisons, std::back_inserter(sorted),
                         [&](const Comparison& c) { return c.metric == metric && c.subject.scenario == scenario; });
  }
  return sorted;
}

std::string name_of(const Subject& s) {
  return s.filter + (s.parameters.empty() ? "" : " " + s.parameters);
}

}  // namespace

std::vector<ResultTable> result_tables(const Results& results, const std::string& scenario) {
  const std::vector<SummaryRow> rows = rows_of(results, scenario);
  if (rows.empty()) return {};
  const std::vector<Subject> subjects = distinct(rows, [](const SummaryRow& row) { return row.subject; });
  if (subjects.size() <= kFewSubjects) return {metrics_table(results, scenario, rows, subjects)};
  return tables_of_parameters(results, scenario, rows, subjects);
}

ResultTable comparison_table(std::span<const Comparison> comparisons, const std::string& scenario) {
  ResultTable table{"", "metric", {}, {}};
  for (const char* title : {"filter", "against"}) table.columns.push_back({title, "", "name"});
  for (const char* title :
       {"difference", "95 % interval", "in %", "p (t)", "p (sign flips)", "p (Holm)", "pairs", "dropped", "diverged"}) {
    table.columns.push_back({title, "", ""});
  }
  const std::vector<Comparison> shown = by_metric(comparisons, scenario);
  for (const Comparison& c : shown) {
    const report::PrintUnit unit = printed_unit(c.unit, std::max(std::abs(c.mean), std::abs(c.against_mean)));
    const int decimals = decimals_for(0.5 * (c.ci95.high - c.ci95.low) * unit.scale, c.difference * unit.scale);
    const auto number = [&](double si) { return number_text(si * unit.scale, decimals); };
    const std::string interval =
        std::isfinite(c.ci95.low) ? "[" + number(c.ci95.low) + ", " + number(c.ci95.high) + "]" : "";
    table.rows.push_back({in_words(c.metric) + (unit.symbol.empty() ? "" : " [" + unit.symbol + "]"),
                          {{name_of(c.subject), "", "name"},
                           {name_of(c.against), "", "name"},
                           {number(c.difference), "", ""},
                           {interval, "", ""},
                           {number_text(c.percent, 1), "", ""},
                           {p_text(c.p_value), "", ""},
                           {p_text(c.p_permutation), "", ""},
                           {p_text(c.p_holm), "", c.p_holm < 0.05 ? "estimate" : ""},
                           {std::to_string(c.pairs), "", ""},
                           {std::to_string(c.dropped), "", ""},
                           {std::to_string(c.diverged) + " / " + std::to_string(c.against_diverged), "", ""}}});
  }
  table.caption =
      scenario + ": paired differences by seed; Holm over these " + std::to_string(shown.size()) + "; bold: below 0.05";
  return table;
}

std::string to_html(const ResultTable& table) {
  const auto with_detail = [](const std::string& text, const std::string& detail) {
    return report::escape(text) + (detail.empty() ? "" : "<small>" + report::escape(detail) + "</small>");
  };
  std::string head = report::column_head(report::escape(table.corner)), body;
  for (const TableColumn& c : table.columns) head += report::column_head(with_detail(c.title, c.detail), c.css_class);
  for (const TableRow& r : table.rows) {
    std::string cells = report::row_head(report::escape(r.title));
    for (const TableCell& c : r.cells) cells += report::cell(with_detail(c.value, c.detail), c.css_class);
    body += report::row(cells);
  }
  return report::table(report::escape(table.caption), report::row(head), body, "results");
}

std::string in_words(const std::string& metric) {
  static constexpr std::array kInitials{"rmse",  "mae", "nees", "nis", "ospa", "ospa2",
                                        "gospa", "ess", "ate",  "rpe", "cpu"};
  std::string text;
  for (std::string word : split(metric, '_')) {
    if (std::ranges::find(kInitials, word) != kInitials.end()) {
      std::ranges::transform(word, word.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    }
    text += (text.empty() ? "" : " ") + word;
  }
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

report::PrintUnit printed_unit(const std::string& si, double largest) {
  if (si == "m" && std::abs(largest) >= 1.0) return {"m", 1.0};
  return report::print_unit(si, largest);
}

int decimals_for(double half_width, double value) {
  constexpr int kMost = 5;
  double measure = says_something(half_width, value) ? half_width : 0.1 * std::abs(value);
  if (!(measure > 0.0)) return 0;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(measure))), 0, kMost);
}

}  // namespace noctule::experiment
