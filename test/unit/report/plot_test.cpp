/// Plots with intervals: what is drawn where.
#include "report/plot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "core/limits.hpp"
#include "report/axis.hpp"
#include "unit/report/find_text.hpp"

namespace noctule::report {
namespace {

/// The numbers of the first path with this class.
std::vector<double> path_numbers(const std::string& svg, const std::string& css_class) {
  std::smatch match;
  std::vector<double> numbers;
  if (!std::regex_search(svg, match, std::regex("class=\"" + css_class + "\" d=\"([^\"]*)\""))) return numbers;
  const std::string d = match[1];
  const std::regex number("-?[0-9]+(\\.[0-9]+)?");
  for (std::sregex_iterator it(d.begin(), d.end(), number), end; it != end; ++it)
    numbers.push_back(std::stod(it->str()));
  return numbers;
}

Plot sample() {
  Plot plot;
  plot.id = "sample";
  plot.title = "Error <of> N";
  plot.x_title = "particles N";
  plot.y_title = "error [cm]";
  plot.series = {{"pf", "series-0", {{10, 4.0, {3.0, 5.0}, "pf: 4 & more"}, {20, 2.0, {1.0, 3.0}, ""}}},
                 {"published", "paper-1", {{10, 6.0, {}, ""}}}};
  plot.lines = {{"dead reckoning", "odometry", 8.0, {7.0, 9.0}}};
  return plot;
}

TEST(Axis, MapsLinearAndLogarithmic) {
  const Axis linear(0.0, 10.0, false, 100.0, 0.0);
  EXPECT_DOUBLE_EQ(linear.at(0.0), 100.0);
  EXPECT_DOUBLE_EQ(linear.at(2.5), 75.0);
  const Axis logarithmic(1.0, 100.0, true, 0.0, 200.0);
  EXPECT_DOUBLE_EQ(logarithmic.at(10.0), 100.0);
  EXPECT_FALSE(logarithmic.drawable(0.0));
  EXPECT_TRUE(linear.drawable(0.0));
  EXPECT_FALSE(linear.drawable(kNan));
}

TEST(Axis, BeginsAtZeroWhereTheValuesDo) {
  ValueRange range;
  range.include(0.0);
  range.include(5.0);
  range.include(kNan);
  EXPECT_DOUBLE_EQ(Axis(range, false, 0.0, 1.0).at(0.0), 0.0);
  ValueRange positive(true);
  positive.include(-1.0);
  EXPECT_TRUE(positive.empty());
}

TEST(PlotSvg, WhiskersSpanTheIntervalAboutTheMark) {
  const std::string svg = plot_svg(sample());
  const std::vector<double> line = path_numbers(svg, "line series-0");  // x y x y
  ASSERT_EQ(line.size(), 4u);
  EXPECT_LT(line[0], line[2]);
  EXPECT_LT(line[1], line[3]) << "4 is above 2, and y points down";
  const std::vector<double> whisker = path_numbers(svg, "whisker series-0");  // x low high ...
  ASSERT_GE(whisker.size(), 3u);
  EXPECT_DOUBLE_EQ(whisker[0], line[0]);
  EXPECT_NEAR(whisker[1] - line[1], line[1] - whisker[2], 0.11);
  EXPECT_NEAR((whisker[1] - whisker[2]) / (line[3] - line[1]), 1.0, 0.01) << "2 units of interval, 2 of difference";
}

TEST(PlotSvg, LinesGoAllTheWayWithTheirInterval) {
  const std::string svg = plot_svg(sample());
  const std::vector<double> line = path_numbers(svg, "line odometry"), band = path_numbers(svg, "interval odometry");
  ASSERT_EQ(line.size(), 3u);  // x y H
  ASSERT_EQ(band.size(), 5u);  // x high H V H
  EXPECT_LT(band[1], line[1]);
  EXPECT_GT(band[3], line[1]);
  EXPECT_DOUBLE_EQ(band[2], line[2]);
}

TEST(PlotSvg, PublishedPointsAreDrawnApart) {
  const std::string svg = plot_svg(sample());
  EXPECT_EQ(count(svg, "mark paper-1 open"), 2u);  // in the plot and in the legend
  EXPECT_NE(svg.find("line paper-1 published"), std::string::npos);
}

TEST(PlotSvg, EscapesAndNamesEverything) {
  const std::string svg = plot_svg(sample());
  for (const char* word : {"Error &lt;of&gt; N", "pf: 4 &amp; more", "particles N", "error [cm]", "dead reckoning"}) {
    EXPECT_NE(svg.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(count(svg, "legend-name"), 3u);
}

TEST(PlotSvg, GapsStayGaps) {
  Plot plot = sample();
  plot.series = {{"pf", "series-0", {{1, 1, {}, ""}, {2, kNan, {}, ""}, {3, 1, {}, ""}, {4, 1, {}, ""}}}};
  const std::string svg = plot_svg(plot);
  std::smatch match;
  ASSERT_TRUE(std::regex_search(svg, match, std::regex("line series-0\" d=\"([^\"]*)\"")));
  EXPECT_EQ(count(match[1], "M"), 2u);
  EXPECT_EQ(count(svg, "nan"), 0u);
}

TEST(PlotSvg, SurvivesNothingAndOnlyZeros) {
  for (const bool logarithmic : {false, true}) {
    Plot plot = sample();
    plot.y_logarithmic = plot.x_logarithmic = logarithmic;
    plot.series = {{"pf", "series-0", {{0, 0, {0, 0}, ""}}}};
    plot.lines.clear();
    EXPECT_EQ(count(plot_svg(plot), "nan"), 0u);
    plot.series.clear();
    EXPECT_EQ(count(plot_svg(plot), "nan"), 0u);
  }
}

TEST(PlotSvg, SeriesWithTheSameXStandSideBySide) {
  Plot plot = sample();
  plot.series = {{"a", "series-0", {{1, 1, {}, ""}, {2, 1, {}, ""}}},
                 {"b", "series-1", {{1, 1, {}, ""}, {2, 1, {}, ""}}}};
  plot.dodge = true;
  const std::string svg = plot_svg(plot);
  EXPECT_DOUBLE_EQ(path_numbers(svg, "line series-1")[0] - path_numbers(svg, "line series-0")[0], 5.0);
}

TEST(PrintedFigureStyle, HasNoVariablesAndNoDarkSide) {
  const std::string style = printed_figure_style();
  EXPECT_EQ(count(style, "var("), 0u);
  EXPECT_EQ(count(style, "prefers-color-scheme"), 0u);
  EXPECT_EQ(count(style, "{"), count(style, "}"));
  EXPECT_NE(style.find("svg .line.estimate { stroke: #0b63b0; }"), std::string::npos);
}

}  // namespace
}  // namespace noctule::report
