#pragma once
/// Plots of results with intervals, as SVG fit for a paper: axes with titles, the legend inside the drawing. Colours
/// and dashes come from page/figure.css by class names.
#include <string>
#include <vector>

#include "core/chi2.hpp"

namespace noctule::report {

/// All values in print units.
struct PlotPoint {
  double x = 0.0;
  double y = 0.0;       ///< not finite: a gap
  Interval interval{};  ///< of y; not finite: none drawn
  std::string label;    ///< what it is called when pointed at
};

struct PlotSeries {
  std::string name;
  std::string css_class;  ///< "series-0" to "series-7", "paper-0" to "paper-7", "odometry", "limit"
  std::vector<PlotPoint> points;
};

/// A value that holds for every x.
struct PlotLine {
  std::string name;
  std::string css_class;  ///< "odometry", "limit"
  double value = 0.0;
  Interval interval{};
};

struct Plot {
  std::string id;  ///< unique on the page, fit for a file name
  std::string title;
  std::string description;
  std::string note;              ///< under the drawing on a page; may be empty
  std::string x_title, y_title;  ///< with their units
  std::vector<PlotSeries> series;
  std::vector<PlotLine> lines;
  std::vector<double> x_ticks;  ///< where they are few and given; else round ones are found
  bool x_logarithmic = false, y_logarithmic = false;
  bool curves = false;  ///< many points: lines in shaded intervals, no marks
  bool clouds = false;  ///< points of a series belong to no line: marks alone
  bool dodge = false;   ///< series with the same x are drawn side by side
};

/// \param standalone_style style sheet to embed, empty within a page
[[nodiscard]] std::string plot_svg(const Plot& plot, const std::string& standalone_style = {});

/// A figure element: heading and drawing.
[[nodiscard]] std::string plot_html(const Plot& plot);

/// figure.css with its light colours in place of the variables, for programs that are no browser.
[[nodiscard]] std::string printed_figure_style();

}  // namespace noctule::report
