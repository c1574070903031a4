#include "report/chart.hpp"

#include <algorithm>
#include <cmath>

#include "core/limits.hpp"
#include "report/axis.hpp"
#include "report/text.hpp"

namespace noctule::report {
namespace {

constexpr double kChartWidth = 560.0, kChartHeight = 190.0;
constexpr PlotArea kChartArea{52.0, kChartWidth - 10.0, 10.0, kChartHeight - 26.0, kChartWidth, kChartHeight};

/// Maps time and value to the drawing.
struct Axes {
  explicit Axes(const Chart& chart)
      : time(chart.time.empty() ? 0.0 : chart.time.front(),
             chart.time.empty() ? 1.0 : std::max(chart.time.back(), chart.time.front() + 1e-6), false, kChartArea.left,
             kChartArea.right),
        value(values_of(chart), chart.logarithmic, kChartArea.bottom, kChartArea.top) {}

  [[nodiscard]] static ValueRange values_of(const Chart& chart) {
    ValueRange range(chart.logarithmic);
    for (const ChartSeries& s : chart.series) {
      for (const double v : s.values) range.include(v);
    }
    for (const double half : chart.band) {
      range.include(half);
      range.include(-half);
    }
    for (const ChartReference& r : chart.references) range.include(r.value);
    if (chart.from_zero) range.include(0.0);
    return range;
  }
  [[nodiscard]] double x(double t) const { return time.at(t); }
  [[nodiscard]] double y(double v) const { return value.at(v); }
  [[nodiscard]] bool drawable(double v) const { return value.drawable(v); }

  Axis time, value;
};

/// A polyline that keeps the extremes of every user unit across, so that long runs stay small and honest.
std::string line_path(const Axes& axes, const std::vector<double>& time, const std::vector<double>& values) {
  std::string path;
  const std::size_t n = std::min(time.size(), values.size());
  bool draw = false;
  for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
    std::size_t low = begin, high = begin;
    bool gap = false;
    for (end = begin; end < n && axes.x(time[end]) - axes.x(time[begin]) < 0.5; ++end) {
      if (!axes.drawable(values[end])) {
        gap = true;
        continue;
      }
      if (!axes.drawable(values[low]) || values[end] < values[low]) low = end;
      if (!axes.drawable(values[high]) || values[end] > values[high]) high = end;
    }
    if (axes.drawable(values[low])) {
      const auto [first, second] = std::minmax(low, high);
      path += (draw ? "L" : "M") + point_text(axes.x(time[first]), axes.y(values[first]));
      if (second != first) path += "L" + point_text(axes.x(time[second]), axes.y(values[second]));
      draw = true;
    }
    if (gap) draw = false;
  }
  return path;
}

/// The band as one closed polygon a stretch without gaps.
std::string band_path(const Axes& axes, const Chart& chart) {
  std::string path, there, back;
  const auto close = [&] {
    if (!there.empty()) path += "M" + there.substr(1) + back + "Z";
    there.clear();
    back.clear();
  };
  double last_x = -kInf;
  for (std::size_t i = 0; i < std::min(chart.time.size(), chart.band.size()); ++i) {
    if (!std::isfinite(chart.band[i])) {
      close();
      continue;
    }
    const double x = axes.x(chart.time[i]);
    if (x - last_x < 0.4 && !there.empty() && i + 1 < chart.time.size()) continue;
    last_x = x;
    there += "L" + point_text(x, axes.y(chart.band[i]));
    back = "L" + point_text(x, axes.y(-chart.band[i])) + back;
  }
  close();
  return path;
}

std::string grid(const Axes& axes) {
  std::string lines = "<path class=\"grid\" d=\"", labels;
  for (const auto& [value, label] : axes.value.ticks(6)) {
    lines += "M" + point_text(kChartArea.left, axes.y(value)) + "H" + fixed(kChartArea.right, 1);
    labels += text_at("tick-y", kChartArea.left - 7.0, axes.y(value) + 4.0, label);
  }
  for (const auto& [t, label] : axes.time.ticks(7)) {
    if (axes.x(t) > kChartArea.right - 25.0) continue;  // there stands the unit
    lines += "M" + point_text(axes.x(t), kChartArea.bottom) + "v4";
    labels += text_at("tick-x", axes.x(t), kChartArea.bottom + 17.0, label);
  }
  labels += text_at("tick-x", kChartArea.right - 2.0, kChartArea.bottom + 17.0, "s");
  return lines + "\"/>" + labels;
}

std::string references(const Axes& axes, const Chart& chart) {
  std::string out;
  for (const ChartReference& r : chart.references) {
    out += "<path class=\"reference\" d=\"M" + point_text(kChartArea.left, axes.y(r.value)) + "H" +
           fixed(kChartArea.right, 1) + "\"/>" +
           text_at("reference-label", kChartArea.right - 4.0, axes.y(r.value) - 4.0, r.label);
  }
  return out;
}

std::string legend(const Chart& chart) {
  std::string out = "<span class=\"legend\">";
  for (const ChartSeries& s : chart.series) {
    out += "<span class=\"key " + s.css_class + "\">" + escape(s.name) + "</span>";
  }
  if (!chart.band.empty()) out += "<span class=\"key band-key\">" + escape(chart.band_name) + "</span>";
  return out + "</span>";
}

}  // namespace

PlotArea plot_area() {
  return kChartArea;
}

std::string chart_html(const Chart& chart) {
  const Axes axes(chart);
  std::string out = "<figure class=\"chart\" id=\"" + chart.id + "\">\n<figcaption><b>" + escape(chart.title) + "</b>";
  if (!chart.unit.empty()) out += " <span class=\"unit\">" + escape(chart.unit) + "</span>";
  out += legend(chart) + "</figcaption>\n<svg class=\"plot\" role=\"img\" viewBox=\"0 0 " + fixed(kChartWidth, 0) +
         " " + fixed(kChartHeight, 0) + "\"><title>" + escape(chart.title) + "</title><desc>" +
         escape(chart.description) + "</desc>\n" + grid(axes);
  if (!chart.band.empty()) out += "<path class=\"band\" d=\"" + band_path(axes, chart) + "\"/>\n";
  for (const ChartSeries& s : chart.series) {
    out += "<path class=\"line " + s.css_class + "\" d=\"" + line_path(axes, chart.time, s.values) + "\"/>\n";
  }
  return out + references(axes, chart) + "<line class=\"cursor\" y1=\"" + fixed(kChartArea.top, 0) + "\" y2=\"" +
         fixed(kChartArea.bottom, 0) + "\"/></svg>\n<output class=\"readout\"></output>\n</figure>\n";
}

}  // namespace noctule::report
