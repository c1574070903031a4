#include "experiment/result_plots.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "experiment/csv.hpp"
#include "experiment/result_table.hpp"
#include "report/text.hpp"

namespace noctule::experiment {
namespace {

using report::Plot;
using report::PlotPoint;
using report::PlotSeries;

constexpr int kStyles = 8;

std::optional<double> number_of(const std::string& parameters, const std::string& key) {
  for (const auto& [k, text] : assignments(parameters)) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (k == key && error == std::errc() && end == text.data() + text.size()) return value;
  }
  return std::nullopt;
}

/// The parameters with (or without) the keys.
std::string filtered(const std::string& parameters, const std::set<std::string>& keys, bool with) {
  std::string text;
  for (const auto& [key, value] : assignments(parameters)) {
    if (keys.contains(key) == with) text += (text.empty() ? "" : ", ") + key + '=' + value;
  }
  return text;
}

std::string joined(const std::string& filter, const std::string& rest) {
  return rest.empty() ? filter : filter + ", " + rest;
}

/// What a scenario's plots share: what is swept over, and which filter looks how.
class Style {
 public:
  Style(const Results& results, const std::string& scenario) : results_(results) {
    std::map<std::string, std::set<double>> values;
    for (const SummaryRow& row : results.summary) {
      if (row.subject.scenario != scenario) continue;
      for (const auto& [key, text] : assignments(row.subject.parameters)) {
        if (const auto value = number_of(row.subject.parameters, key)) values[key].insert(*value);
      }
    }
    for (const auto& [key, of_key] : values) {
      if (of_key.size() > 1) swept_.insert(key);
    }
    for (const SummaryRow& row : results.summary) {
      if (row.subject.scenario == scenario && role(row.subject) == Role::compared) index_of(base_name(row.subject));
    }
  }

  [[nodiscard]] const std::set<std::string>& swept() const { return swept_; }
  [[nodiscard]] Role role(const Subject& s) const { return role_of(results_.experiment, s.filter); }
  /// Without what is swept over.
  [[nodiscard]] std::string base_name(const Subject& s) const {
    return joined(s.filter, filtered(s.parameters, swept_, false));
  }
  [[nodiscard]] std::string css_class(const Subject& s) {
    switch (role(s)) {
      case Role::baseline:
        return "odometry";
      case Role::limit:
        return "limit";
      case Role::compared:
        break;
    }
    return "series-" + std::to_string(index_of(base_name(s)));
  }

 private:
  int index_of(const std::string& name) {
    const auto [at, fresh] = indices_.try_emplace(name, static_cast<int>(indices_.size()) % kStyles);
    return at->second;
  }

  const Results& results_;
  std::set<std::string> swept_;
  std::map<std::string, int> indices_;
};

/// Metrics that get plots, in the order of their tables.
std::vector<std::string> plotted(const Results& results, const std::string& scenario) {
  std::vector<std::string> metrics;
  for (const SummaryRow& row : results.summary) {
    const bool wanted = results.experiment.plots.empty() ||
                        std::ranges::find(results.experiment.plots, row.metric) != results.experiment.plots.end();
    const bool fresh = std::ranges::find(metrics, row.metric) == metrics.end();
    if (row.subject.scenario == scenario && wanted && fresh) metrics.push_back(row.metric);
  }
  return metrics;
}

PlotSeries& series_named(std::vector<PlotSeries>& all, const std::string& name, const std::string& css_class) {
  const auto at = std::ranges::find(all, name, &PlotSeries::name);
  return at != all.end() ? *at : all.emplace_back(PlotSeries{name, css_class, {}});
}

std::string words(const std::string& name, double value, const Interval& interval, const report::PrintUnit& unit) {
  const int decimals = decimals_for(0.5 * (interval.high - interval.low) * unit.scale, value * unit.scale);
  std::string text = name + ": " + report::aligned(value * unit.scale, decimals) + ' ' + unit.symbol;
  if (std::isfinite(interval.low)) {
    text += " [" + report::aligned(interval.low * unit.scale, decimals) + ", " +
            report::aligned(interval.high * unit.scale, decimals) + "]";
  }
  return text;
}

Interval scaled(const Interval& interval, double scale) {
  return {interval.low * scale, interval.high * scale};
}

std::string with_unit(const std::string& title, const std::string& unit) {
  return unit.empty() ? title : title + " [" + unit + "]";
}

/// A curve's metric in words; that it is over time is said by its axis.
std::string curve_in_words(const std::string& metric) {
  constexpr std::string_view kSuffix = "_over_time";
  return in_words(metric.ends_with(kSuffix) ? metric.substr(0, metric.size() - kSuffix.size()) : metric);
}

/// An axis over more than this ratio is logarithmic.
bool wide(const std::vector<double>& values, double ratio) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  return low > 0.0 && high > ratio * low;
}

/// Sorts the points, and decides which axes are logarithmic.
void finish(Plot& plot) {
  constexpr double kWideX = 4.0, kWideY = 10.0, kWideCurves = 1e4;
  std::vector<double> x, y;
  for (PlotSeries& s : plot.series) {
    std::ranges::stable_sort(s.points, {}, &PlotPoint::x);
    for (const PlotPoint& p : s.points) {
      x.push_back(p.x);
      y.push_back(p.y);
    }
  }
  for (const report::PlotLine& l : plot.lines) y.push_back(l.value);
  plot.x_logarithmic = !plot.curves && wide(x, kWideX);
  plot.y_logarithmic = wide(y, plot.curves ? kWideCurves : kWideY);
}

/// Says which lines to see filters by have no such figure (dead reckoning has no particles), and finishes the plot.
void finish(Plot& plot, const Results& results) {
  std::string absent;
  for (const FilterSpec& spec : results.experiment.filters) {
    const auto is_its = [&](const auto& drawn) {
      return drawn.name == spec.name || drawn.name.starts_with(spec.name + ", ");
    };
    if (spec.role == Role::compared || std::ranges::any_of(plot.lines, is_its) ||
        std::ranges::any_of(plot.series, is_its)) {
      continue;
    }
    absent += (absent.empty() ? "" : ", ") + spec.name;
  }
  if (!absent.empty()) plot.note = "Without a line, having no such figure: " + absent + ".";
  finish(plot);
}

/// The rows of one metric, and how its values are printed.
struct MetricRows {
  std::vector<SummaryRow> rows;
  report::PrintUnit unit;

  MetricRows(const Results& results, const std::string& scenario, const std::string& metric) {
    double largest = 0.0;
    for (const SummaryRow& row : results.summary) {
      if (row.subject.scenario != scenario || row.metric != metric) continue;
      rows.push_back(row);
      if (std::isfinite(row.mean)) largest = std::max(largest, std::abs(row.mean));
    }
    if (!rows.empty()) unit = printed_unit(rows.front().unit, largest);
  }
};

void add_line(Plot& plot, const std::string& name, const std::string& css_class, const SummaryRow& row,
              const report::PrintUnit& unit) {
  plot.lines.push_back({name, css_class, row.mean * unit.scale, scaled(row.ci95, unit.scale)});
}

/// Published points, in the colour of the filter whose place they take in the list.
void add_references(Plot& plot, const Results& results, const std::string& scenario, const std::string& metric,
                    const std::string& key, const report::PrintUnit& unit) {
  std::map<std::string, int> indices;
  for (const Reference& r : results.experiment.references) {
    const auto x = number_of(r.parameters, key);
    if (r.scenario != scenario || r.metric != metric || !x) continue;
    const std::string name = joined(r.filter, filtered(r.parameters, {key}, false)) + " (" + r.source + ")";
    const int index = indices.try_emplace(name, static_cast<int>(indices.size()) % kStyles).first->second;
    series_named(plot.series, name, "paper-" + std::to_string(index))
        .points.push_back({*x, r.value * unit.scale, {0.0, 0.0}, name});
  }
}

Plot parameter_plot(const Results& results, const std::string& scenario, const std::string& metric,
                    const std::string& key, Style& style) {
  const MetricRows of_metric(results, scenario, metric);
  const report::PrintUnit& unit = of_metric.unit;
  Plot plot;
  plot.id = scenario + "-" + metric + "-against-" + key;
  plot.title = in_words(metric) + " against " + key;
  plot.description = "Mean with 95 % interval over the seeds.";
  plot.x_title = key == "N" ? "particles N" : key;
  plot.y_title = with_unit(in_words(metric), unit.symbol);
  plot.dodge = true;
  std::set<double> ticks;
  for (const SummaryRow& row : of_metric.rows) {
    const std::string name = joined(row.subject.filter, filtered(row.subject.parameters, {key}, false));
    const std::string css_class = style.css_class(row.subject);
    const auto x = number_of(row.subject.parameters, key);
    if (!x) {
      if (style.role(row.subject) != Role::compared) add_line(plot, name, css_class, row, unit);
      continue;
    }
    ticks.insert(*x);
    series_named(plot.series, name, css_class)
        .points.push_back({*x, row.mean * unit.scale, scaled(row.ci95, unit.scale),
                           words(joined(row.subject.filter, row.subject.parameters), row.mean, row.ci95, unit)});
  }
  add_references(plot, results, scenario, metric, key, unit);
  constexpr std::size_t kFewTicks = 8;
  if (ticks.size() <= kFewTicks) plot.x_ticks.assign(ticks.begin(), ticks.end());
  finish(plot, results);
  return plot;
}

}  // namespace

std::vector<Plot> parameter_plots(const Results& results, const std::string& scenario) {
  Style style(results, scenario);
  std::vector<Plot> plots;
  for (const std::string& key : style.swept()) {
    for (const std::string& metric : plotted(results, scenario)) {
      plots.push_back(parameter_plot(results, scenario, metric, key, style));
    }
  }
  return plots;
}

std::vector<Plot> time_plots(const Results& results, const std::string& scenario) {
  Style style(results, scenario);
  std::vector<Plot> plots;
  struct Group {
    std::string metric, swept;
    double largest = 0.0;
    std::vector<const SeriesRow*> rows;
  };
  std::vector<Group> groups;
  std::vector<const SeriesRow*> lines;  // of roles without the swept parameters: in every plot
  for (const SeriesRow& row : results.series) {
    if (row.subject.scenario != scenario) continue;
    const std::string swept = filtered(row.subject.parameters, style.swept(), true);
    if (style.role(row.subject) != Role::compared && swept.empty() && !style.swept().empty()) {
      lines.push_back(&row);
      continue;
    }
    auto at = std::ranges::find_if(groups, [&](const Group& g) { return g.metric == row.metric && g.swept == swept; });
    if (at == groups.end()) at = groups.insert(at, {row.metric, swept, 0.0, {}});
    at->rows.push_back(&row);
  }
  for (Group& group : groups) {
    for (const SeriesRow* row : lines) {
      if (row->metric == group.metric) group.rows.push_back(row);
    }
    for (const SeriesRow* row : group.rows) {
      if (std::isfinite(row->mean)) group.largest = std::max(group.largest, std::abs(row->mean));
    }
    const report::PrintUnit unit = printed_unit(group.rows.front()->unit, group.largest);
    Plot plot;
    plot.id = scenario + "-" + group.metric + "-against-time" + (group.swept.empty() ? "" : "-" + group.swept);
    std::ranges::replace_if(
        plot.id, [](char c) { return c == '=' || c == ',' || c == ' '; }, '-');
    plot.title = joined(curve_in_words(group.metric) + " against time", group.swept);
    plot.description = "Mean over the seeds at each time with its 95 % interval.";
    plot.x_title = "time [s]";
    plot.y_title = with_unit(curve_in_words(group.metric), unit.symbol);
    plot.curves = true;
    for (const SeriesRow* row : group.rows) {
      series_named(plot.series, style.base_name(row->subject), style.css_class(row->subject))
          .points.push_back({row->time, row->mean * unit.scale, scaled(row->ci95, unit.scale), ""});
    }
    finish(plot, results);
    plots.push_back(std::move(plot));
  }
  return plots;
}

std::vector<Plot> cost_plots(const Results& results, const std::string& scenario) {
  Style style(results, scenario);
  const auto is_cost = [&](const SummaryRow& row) {
    return row.subject.scenario == scenario && row.metric.starts_with("cpu_") && row.mean > 0.0;
  };
  const auto first = std::ranges::find_if(results.timing, is_cost);
  if (first == results.timing.end()) return {};
  std::map<Subject, double> cost;
  double largest = 0.0;
  for (const SummaryRow& row : results.timing) {
    if (!is_cost(row) || row.metric != first->metric) continue;
    cost[row.subject] = row.mean;
    if (style.role(row.subject) == Role::compared) largest = std::max(largest, row.mean);
  }
  const report::PrintUnit time = printed_unit(first->unit, largest);
  std::vector<Plot> plots;
  for (const std::string& metric : plotted(results, scenario)) {
    const MetricRows of_metric(results, scenario, metric);
    Plot plot;
    plot.id = scenario + "-" + metric + "-against-cost";
    plot.title = in_words(metric) + " against time of computing";
    plot.description = "Mean with 95 % interval over the seeds; one point a filter and parameter set.";
    plot.x_title = with_unit(in_words(first->metric), time.symbol);
    plot.y_title = with_unit(in_words(metric), of_metric.unit.symbol);
    for (const SummaryRow& row : of_metric.rows) {
      const std::string name = style.base_name(row.subject), css_class = style.css_class(row.subject);
      if (style.role(row.subject) != Role::compared) {
        add_line(plot, joined(row.subject.filter, row.subject.parameters), css_class, row, of_metric.unit);
      } else if (cost.contains(row.subject)) {
        series_named(plot.series, name, css_class)
            .points.push_back(
                {cost.at(row.subject) * time.scale, row.mean * of_metric.unit.scale,
                 scaled(row.ci95, of_metric.unit.scale),
                 words(joined(row.subject.filter, row.subject.parameters), row.mean, row.ci95, of_metric.unit)});
      }
    }
    finish(plot, results);
    if (!plot.series.empty()) plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace noctule::experiment
