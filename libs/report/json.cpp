#include "report/json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace noctule::report {
namespace {

using Json = nlohmann::ordered_json;

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json to_json(const eval::Metric& m) {
  // JSON has no word for infinity or not-a-number.
  return {{"name", m.name}, {"value", std::isfinite(m.value) ? Json(m.value) : Json(nullptr)}, {"unit", m.unit}};
}

Json to_json(const std::vector<eval::Metric>& metrics) {
  Json list = Json::array();
  for (const eval::Metric& m : metrics) list.push_back(to_json(m));
  return list;
}

/// Every `step`-th value with the decimals that the page shows.
Json thinned(const std::vector<double>& values, std::size_t step, int decimals) {
  const double scale = std::pow(10.0, decimals);
  Json list = Json::array();
  for (std::size_t i = 0; i < values.size(); i += step) {
    list.push_back(std::isfinite(values[i]) ? Json(std::round(values[i] * scale) / scale) : Json(nullptr));
  }
  return list;
}

Json to_json(const Chart& chart) {
  constexpr std::size_t kMost = 1500;  // more than there are pixels across
  const std::size_t step = chart.time.size() / kMost + 1;
  Json series = Json::array();
  for (const ChartSeries& s : chart.series) {
    series.push_back({{"name", s.name}, {"values", thinned(s.values, step, chart.decimals)}});
  }
  if (!chart.band.empty()) {
    series.push_back({{"name", chart.band_name}, {"values", thinned(chart.band, step, chart.decimals)}});
  }
  return {{"id", chart.id},
          {"unit", chart.unit},
          {"decimals", chart.decimals},
          {"time", thinned(chart.time, step, 3)},
          {"series", series}};
}

}  // namespace

std::string metrics_json(const std::vector<eval::Metric>& metrics) {
  std::string text = "[";
  for (std::size_t i = 0; i < metrics.size(); ++i) text += (i == 0 ? "\n  " : ",\n  ") + dump(to_json(metrics[i]));
  return text + "\n]\n";
}

std::string page_json(const RunData& data, const std::vector<Chart>& charts) {
  const PlotArea plot = plot_area();
  Json list = Json::array();
  for (const Chart& c : charts) list.push_back(to_json(c));
  const std::string text = dump(Json{{"metrics", to_json(data.metrics)},
                                     {"timing", to_json(data.timing)},
                                     {"plot", {{"left", plot.left}, {"right", plot.right}, {"width", plot.width}}},
                                     {"charts", list}});
  std::string safe;  // "</script>" in a name must not end the element
  for (const char c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

}  // namespace noctule::report
