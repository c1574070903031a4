#pragma once
/// Charts over time, as SVG. Colours come from page/figure.css by class names.
#include <optional>
#include <string>
#include <vector>

namespace noctule::report {

struct ChartSeries {
  std::string name;
  std::string css_class;       ///< "estimate", "odometry", "limit", "truth" ...
  std::vector<double> values;  ///< one per time; not finite: a gap
};

struct ChartReference {
  double value = 0.0;
  std::string label;
};

/// All values in print units.
struct Chart {
  std::string id;  ///< unique on the page
  std::string title;
  std::string unit;  ///< of the values; may be empty
  std::string description;
  std::vector<double> time;  ///< [s], increasing
  std::vector<ChartSeries> series;
  std::vector<double> band;  ///< half width around 0, one per time; may be empty
  std::string band_name;
  std::vector<ChartReference> references;
  bool logarithmic = false;
  bool from_zero = false;  ///< the axis begins at 0
  int decimals = 2;        ///< of the values when pointed at
};

/// A figure element: heading with legend, drawing, and a line for the value pointed at.
[[nodiscard]] std::string chart_html(const Chart& chart);

/// Where the plot area lies in the drawing, for the script that follows the pointer.
struct PlotArea {
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0, width = 0.0, height = 0.0;
};
[[nodiscard]] PlotArea plot_area();

}  // namespace noctule::report
