#include "report/plot.hpp"

#include <algorithm>
#include <cmath>

#include "report/assets.hpp"
#include "report/axis.hpp"
#include "report/text.hpp"

namespace noctule::report {
namespace {

constexpr double kPlotWidth = 560.0, kPlotLeft = 62.0, kPlotRight = 548.0, kPlotHeight = 310.0, kBelowPlot = 46.0;
constexpr double kLegendRow = 20.0, kSample = 30.0, kLetter = 7.2;
constexpr const char* kSpace = " ";

std::string path(const std::string& css_class, const std::string& d) {
  return d.empty() ? "" : "<path class=\"" + css_class + "\" d=\"" + d + "\"/>";
}

/// Series differ in their marks too: the number at the end of the class picks one.
std::string mark(const std::string& css_class, double x, double y, const std::string& title) {
  const char last = css_class.back();
  const int shape = last >= '0' && last <= '9' ? (last - '0') % 4 : 0;
  constexpr double r = 3.6;
  std::string d;
  switch (shape) {
    case 0:
      d = "M" + point_text(x - r, y) + "a3.6 3.6 0 1 0 7.2 0a3.6 3.6 0 1 0 -7.2 0Z";
      break;
    case 1:
      d = "M" + point_text(x - r, y - r) + "h7.2v7.2h-7.2Z";
      break;
    case 2:
      d = "M" + point_text(x, y - 1.3 * r) + "l4.6 8.2h-9.2Z";
      break;
    default:
      d = "M" + point_text(x, y - 1.35 * r) + "l4.9 4.9l-4.9 4.9l-4.9 -4.9Z";
  }
  const bool open = css_class.starts_with("paper");
  const std::string hint = title.empty() ? "" : "<title>" + escape(title) + "</title>";
  return "<path class=\"mark " + css_class + (open ? " open" : "") + "\" d=\"" + d + "\">" + hint + "</path>";
}

/// What a paper says is drawn apart from what we measured.
std::string line_class(const std::string& css_class) {
  return "line " + css_class + (css_class.starts_with("paper") ? " published" : "");
}

bool finite(const Interval& interval) {
  return std::isfinite(interval.low) && std::isfinite(interval.high) && interval.low < interval.high;
}

class Drawing {
 public:
  explicit Drawing(const Plot& plot)
      : plot_(plot),
        columns_(legend_columns(plot)),
        top_(12.0 + kLegendRow * std::ceil(static_cast<double>(entries(plot).size()) / columns_)),
        bottom_(top_ + kPlotHeight - 60.0),
        x_(x_range(plot), plot.x_logarithmic, kPlotLeft, kPlotRight),
        y_(y_range(plot), plot.y_logarithmic, bottom_, top_) {}

  [[nodiscard]] std::string svg(const std::string& style) const {
    std::string out = "<svg class=\"plot\" role=\"img\" viewBox=\"0 0 " + fixed(kPlotWidth, 0) + kSpace +
                      fixed(bottom_ + kBelowPlot, 0) + "\"" +
                      (style.empty() ? "" : " xmlns=\"http://www.w3.org/2000/svg\"") + "><title>" +
                      escape(plot_.title) + "</title><desc>" + escape(plot_.description) + "</desc>\n";
    if (!style.empty()) {
      out += "<style>\n" + style + "</style>\n<rect class=\"sheet\" width=\"100%\" height=\"100%\"/>\n";
    }
    out += grid();
    for (const PlotLine& l : plot_.lines) out += line(l);
    for (std::size_t i = 0; i < plot_.series.size(); ++i) {
      out += plot_.curves ? curve(plot_.series[i]) : points(plot_.series[i], plot_.dodge ? offset(i) : 0.0);
    }
    return out + legend() + "</svg>\n";
  }

 private:
  struct Entry {
    std::string name;
    std::string css_class;
    bool marked;
  };
  static std::vector<Entry> entries(const Plot& plot) {
    std::vector<Entry> all;
    for (const PlotSeries& s : plot.series) all.push_back({s.name, s.css_class, !plot.curves});
    for (const PlotLine& l : plot.lines) all.push_back({l.name, l.css_class, false});
    return all;
  }
  static double legend_columns(const Plot& plot) {
    std::size_t longest = 1;
    for (const Entry& e : entries(plot)) longest = std::max(longest, e.name.size());
    const double width = kSample + 16.0 + kLetter * static_cast<double>(longest);
    return std::clamp(std::floor((kPlotRight - kPlotLeft) / width), 1.0, 4.0);
  }
  static ValueRange x_range(const Plot& plot) {
    ValueRange range(plot.x_logarithmic);
    for (const PlotSeries& s : plot.series) {
      for (const PlotPoint& p : s.points) range.include(p.x);
    }
    return range;
  }
  static ValueRange y_range(const Plot& plot) {
    ValueRange range(plot.y_logarithmic);
    const auto include = [&](double value, const Interval& interval) {
      range.include(value);
      if (!finite(interval)) return;
      range.include(interval.low);
      range.include(interval.high);
    };
    for (const PlotSeries& s : plot.series) {
      for (const PlotPoint& p : s.points) include(p.y, p.interval);
    }
    for (const PlotLine& l : plot.lines) include(l.value, l.interval);
    // An axis that nearly begins at zero begins there.
    if (!plot.y_logarithmic && range.low() > 0.0 && range.low() < 0.5 * range.high()) range.include(0.0);
    return range;
  }

  /// The lower end of an interval may lie outside a logarithmic axis.
  [[nodiscard]] double y_of(double value) const { return y_.drawable(value) ? y_.at(value) : bottom_; }

  [[nodiscard]] std::string grid() const {
    std::string lines, labels;
    for (const auto& [value, label] : y_.ticks(6)) {
      lines += "M" + point_text(kPlotLeft, y_.at(value)) + "H" + fixed(kPlotRight, 1);
      labels += text_at("tick-y", kPlotLeft - 7.0, y_.at(value) + 4.0, label);
    }
    std::vector<Axis::Tick> ticks;
    if (plot_.x_ticks.empty()) {
      ticks = x_.ticks(7);
    } else {
      for (const double x : plot_.x_ticks) ticks.push_back({x, aligned(x, x == std::round(x) ? 0 : 2)});
    }
    double free = kPlotLeft - 20.0;
    for (const auto& [value, label] : ticks) {
      lines += "M" + point_text(x_.at(value), bottom_) + "v4";
      if (x_.at(value) < free) continue;
      labels += text_at("tick-x", x_.at(value), bottom_ + 17.0, label);
      free = x_.at(value) + kLetter * static_cast<double>(label.size()) + 6.0;
    }
    labels += text_at("axis-title", 0.5 * (kPlotLeft + kPlotRight), bottom_ + 38.0, plot_.x_title);
    const double middle = 0.5 * (top_ + bottom_);
    labels +=
        text_at("axis-title", 14.0, middle, plot_.y_title, " transform=\"rotate(-90 14 " + fixed(middle, 1) + ")\"");
    return path("grid", lines) + path("axis", "M" + point_text(kPlotLeft, bottom_) + "H" + fixed(kPlotRight, 1)) +
           labels + "\n";
  }

  [[nodiscard]] std::string line(const PlotLine& l) const {
    if (!y_.drawable(l.value)) return {};
    std::string out;
    if (finite(l.interval)) {
      const double high = y_of(l.interval.high), low = y_of(l.interval.low);
      out += path("interval " + l.css_class, "M" + point_text(kPlotLeft, high) + "H" + fixed(kPlotRight, 1) + "V" +
                                                 fixed(low, 1) + "H" + fixed(kPlotLeft, 1) + "Z");
    }
    return out + path("line " + l.css_class, "M" + point_text(kPlotLeft, y_.at(l.value)) + "H" + fixed(kPlotRight, 1)) +
           "\n";
  }

  /// How far aside a series is drawn.
  [[nodiscard]] double offset(std::size_t series) const {
    constexpr double kSpread = 24.0, kMost = 5.0;
    const auto n = static_cast<double>(plot_.series.size());
    return std::min(kMost, kSpread / n) * (static_cast<double>(series) - 0.5 * (n - 1.0));
  }

  [[nodiscard]] std::string joined(const PlotSeries& s, double aside = 0.0) const {
    std::string d;
    bool draw = false;
    for (const PlotPoint& p : s.points) {
      const bool drawable = x_.drawable(p.x) && y_.drawable(p.y);
      if (drawable) d += (draw ? "L" : "M") + point_text(x_.at(p.x) + aside, y_.at(p.y));
      draw = drawable;
    }
    return path(line_class(s.css_class), d);
  }

  [[nodiscard]] std::string points(const PlotSeries& s, double aside) const {
    std::string marks, whiskers;
    for (const PlotPoint& p : s.points) {
      if (!x_.drawable(p.x) || !y_.drawable(p.y)) continue;
      const double x = x_.at(p.x) + aside;
      if (finite(p.interval)) {
        const double high = y_of(p.interval.high), low = y_of(p.interval.low);
        whiskers += "M" + point_text(x, low) + "V" + fixed(high, 1) + "m-3 0h6M" + point_text(x - 3.0, low) + "h6";
      }
      marks += mark(s.css_class, x, y_.at(p.y), p.label);
    }
    return (plot_.clouds ? "" : joined(s, aside)) + path("whisker " + s.css_class, whiskers) + marks + "\n";
  }

  [[nodiscard]] std::string curve(const PlotSeries& s) const {
    std::string there, back, band;
    const auto close = [&] {
      if (!there.empty()) band += "M" + there.substr(1) + back + "Z";
      there.clear();
      back.clear();
    };
    for (const PlotPoint& p : s.points) {
      if (!finite(p.interval)) {
        close();
        continue;
      }
      there += "L" + point_text(x_.at(p.x), y_of(p.interval.high));
      back = "L" + point_text(x_.at(p.x), y_of(p.interval.low)) + back;
    }
    close();
    return path("interval " + s.css_class, band) + joined(s) + "\n";
  }

  [[nodiscard]] std::string legend() const {
    std::string out;
    const double width = (kPlotRight - kPlotLeft) / columns_;
    const std::vector<Entry> all = entries(plot_);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double x = kPlotLeft + width * std::fmod(static_cast<double>(i), columns_);
      const double y = 10.0 + kLegendRow * std::floor(static_cast<double>(i) / columns_);
      if (!plot_.clouds || !all[i].marked) out += path(line_class(all[i].css_class), "M" + point_text(x, y) + "h24");
      if (all[i].marked) out += mark(all[i].css_class, x + 12.0, y, "");
      out += text_at("legend-name", x + kSample, y + 4.0, all[i].name);
    }
    return out;
  }

  const Plot& plot_;
  double columns_;
  double top_, bottom_;
  Axis x_, y_;
};

}  // namespace

std::string plot_svg(const Plot& plot, const std::string& standalone_style) {
  return Drawing(plot).svg(standalone_style);
}

std::string plot_html(const Plot& plot) {
  return "<figure class=\"result-plot\" id=\"" + plot.id + "\">\n<figcaption><b>" + escape(plot.title) +
         "</b></figcaption>\n" + plot_svg(plot) +
         (plot.note.empty() ? "" : "<p class=\"note\">" + escape(plot.note) + "</p>\n") + "</figure>\n";
}

std::string printed_figure_style() {
  std::string style = kFigureStyle;
  const std::size_t begin = style.find(":root"), end = style.find('}', begin);
  std::string block = style.substr(begin, end - begin);
  const std::size_t dark = style.find("@media (prefers-color-scheme: dark)");
  style.erase(dark, style.find("\n}\n", dark) + 3 - dark);
  for (std::size_t i = block.find("--"); i != std::string::npos; i = block.find("--", i + 1)) {
    const std::size_t colon = block.find(':', i), stop = block.find(';', i);
    const std::string name = "var(" + block.substr(i, colon - i) + ")",
                      value = block.substr(colon + 2, stop - colon - 2);
    for (std::size_t k = style.find(name); k != std::string::npos; k = style.find(name, k)) {
      style.replace(k, name.size(), value);
    }
  }
  return style;
}

}  // namespace noctule::report
