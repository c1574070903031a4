#include "report/chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/text.hpp"
#include "report/ticks.hpp"

namespace noctule::report {
namespace {

constexpr double kWidth = 560.0, kHeight = 190.0;
constexpr PlotArea kPlot{52.0, kWidth - 10.0, 10.0, kHeight - 26.0, kWidth, kHeight};
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Maps time and value to the drawing.
class Axes {
 public:
  explicit Axes(const Chart& chart) : logarithmic_(chart.logarithmic) {
    if (!chart.time.empty()) {
      t_low_ = chart.time.front();
      t_high_ = std::max(chart.time.back(), t_low_ + 1e-6);
    }
    double low = kInf, high = -kInf;
    const auto include = [&](double v) {
      if (!std::isfinite(v) || (logarithmic_ && v <= 0.0)) return;
      low = std::min(low, v);
      high = std::max(high, v);
    };
    for (const ChartSeries& s : chart.series) std::for_each(s.values.begin(), s.values.end(), include);
    for (const double half : chart.band) {
      include(half);
      include(-half);
    }
    for (const ChartReference& r : chart.references) include(r.value);
    if (chart.from_zero) include(0.0);
    if (low > high) low = logarithmic_ ? 0.1 : -1.0, high = 1.0;
    if (logarithmic_) {
      low_ = std::log10(low) - 0.05;
      high_ = std::log10(high) + 0.05;
    } else {
      const double pad = high > low ? 0.06 * (high - low) : 0.5;
      low_ = chart.from_zero ? low : low - pad;
      high_ = high + pad;
    }
  }

  [[nodiscard]] double x(double t) const {
    return kPlot.left + (t - t_low_) / (t_high_ - t_low_) * (kPlot.right - kPlot.left);
  }
  [[nodiscard]] double y(double value) const {
    const double v = logarithmic_ ? std::log10(value) : value;
    return kPlot.bottom - (v - low_) / (high_ - low_) * (kPlot.bottom - kPlot.top);
  }
  [[nodiscard]] bool drawable(double value) const { return std::isfinite(value) && (!logarithmic_ || value > 0.0); }
  struct ValueTick {
    double value;
    std::string label;
  };
  [[nodiscard]] std::vector<ValueTick> value_ticks() const {
    constexpr int kMost = 6;
    std::vector<ValueTick> ticks;
    if (logarithmic_) {
      for (const int k : log_ticks(std::pow(10.0, low_), std::pow(10.0, high_), kMost)) {
        const double value = std::pow(10.0, k);
        ticks.push_back({value, std::abs(k) > 3 ? power_of_ten(k) : fixed(value, std::max(0, -k))});
      }
      return ticks;
    }
    const Ticks linear = linear_ticks(low_, high_, kMost);
    for (const double v : linear.values) ticks.push_back({v, aligned(v, linear.decimals)});
    return ticks;
  }
  /// None at the end of the axis: there stands the unit.
  [[nodiscard]] Ticks time_ticks() const {
    Ticks ticks = linear_ticks(t_low_, t_high_, 7);
    if (!ticks.values.empty() && x(ticks.values.back()) > kPlot.right - 25.0) ticks.values.pop_back();
    return ticks;
  }

 private:
  bool logarithmic_;
  double t_low_ = 0.0, t_high_ = 1.0, low_ = 0.0, high_ = 1.0;
};

std::string point_text(double x, double y) {
  return fixed(x, 1) + " " + fixed(y, 1);
}

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

std::string text_at(const char* css_class, double x, double y, const std::string& text) {
  return std::string("<text class=\"") + css_class + "\" x=\"" + fixed(x, 1) + "\" y=\"" + fixed(y, 1) + "\">" +
         escape(text) + "</text>";
}

std::string grid(const Axes& axes) {
  std::string lines = "<path class=\"grid\" d=\"", labels;
  for (const auto& [value, label] : axes.value_ticks()) {
    lines += "M" + point_text(kPlot.left, axes.y(value)) + "H" + fixed(kPlot.right, 1);
    labels += text_at("tick-y", kPlot.left - 7.0, axes.y(value) + 4.0, label);
  }
  const Ticks times = axes.time_ticks();
  for (const double t : times.values) {
    lines += "M" + point_text(axes.x(t), kPlot.bottom) + "v4";
    labels += text_at("tick-x", axes.x(t), kPlot.bottom + 17.0, fixed(t, times.decimals));
  }
  labels += text_at("tick-x", kPlot.right - 2.0, kPlot.bottom + 17.0, "s");
  return lines + "\"/>" + labels;
}

std::string references(const Axes& axes, const Chart& chart) {
  std::string out;
  for (const ChartReference& r : chart.references) {
    out += "<path class=\"reference\" d=\"M" + point_text(kPlot.left, axes.y(r.value)) + "H" + fixed(kPlot.right, 1) +
           "\"/>" + text_at("reference-label", kPlot.right - 4.0, axes.y(r.value) - 4.0, r.label);
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
  return kPlot;
}

std::string chart_html(const Chart& chart) {
  const Axes axes(chart);
  std::string out = "<figure class=\"chart\" id=\"" + chart.id + "\">\n<figcaption><b>" + escape(chart.title) + "</b>";
  if (!chart.unit.empty()) out += " <span class=\"unit\">" + escape(chart.unit) + "</span>";
  out += legend(chart) + "</figcaption>\n<svg class=\"plot\" role=\"img\" viewBox=\"0 0 " + fixed(kWidth, 0) + " " +
         fixed(kHeight, 0) + "\"><title>" + escape(chart.title) + "</title><desc>" + escape(chart.description) +
         "</desc>\n" + grid(axes);
  if (!chart.band.empty()) out += "<path class=\"band\" d=\"" + band_path(axes, chart) + "\"/>\n";
  for (const ChartSeries& s : chart.series) {
    out += "<path class=\"line " + s.css_class + "\" d=\"" + line_path(axes, chart.time, s.values) + "\"/>\n";
  }
  return out + references(axes, chart) + "<line class=\"cursor\" y1=\"" + fixed(kPlot.top, 0) + "\" y2=\"" +
         fixed(kPlot.bottom, 0) + "\"/></svg>\n<output class=\"readout\"></output>\n</figure>\n";
}

}  // namespace noctule::report
