/// Plans, charts, ticks and printed numbers.
#include <gtest/gtest.h>

#include <cmath>

#include "core/limits.hpp"
#include "report/chart.hpp"
#include "report/map_figure.hpp"
#include "report/text.hpp"
#include "report/ticks.hpp"
#include "unit/report/find_text.hpp"

namespace noctule::report {
namespace {

double attribute(const std::string& svg, const std::string& css_class, const std::string& name) {
  const std::string element = text_between(svg, "class=\"" + css_class + "\"", ">");
  return number(text_between(element, " " + name + "=\"", "\""));
}

TEST(Text, Numbers) {
  EXPECT_EQ(fixed(-0.004, 2), "0.00");
  EXPECT_EQ(fixed(-0.006, 2), "-0.01");
  EXPECT_EQ(printed(-1.236),
            "\xE2\x88\x92"
            "1.24");
  EXPECT_EQ(printed(12.36), "12.4");
  EXPECT_EQ(printed(123.6), "124");
  EXPECT_EQ(printed(-1.16e17),
            "\xE2\x88\x92"
            "1.2\xC3\x97"
            "10\xC2\xB9\xE2\x81\xB7");
  EXPECT_EQ(printed(kNan), "\xE2\x80\x94");
  EXPECT_EQ(printed_signed(0.5), "+0.50");
  EXPECT_EQ(printed_signed(0.0), "0.00");
  EXPECT_EQ(aligned(-91.342),
            "\xE2\x88\x92"
            "91.34");
}

TEST(Text, UnitsInPrint) {
  EXPECT_EQ(quantity(0.0123, "m"), "1.23 cm");
  EXPECT_EQ(quantity(15.94, "m"), "15.9 m");
  EXPECT_EQ(quantity(kPi / 2, "rad"), "90.0\xC2\xB0");
  EXPECT_EQ(quantity(7, "1"), "7");
  EXPECT_EQ(quantity(2.5, "1"), "2.50");
  EXPECT_EQ(quantity(0.00041, "s"), "410 \xC2\xB5s");
  EXPECT_EQ(quantity(0.0631, "s"), "63.1 ms");
  EXPECT_EQ(quantity(2.0, "Hz"), "2.00 Hz");
  EXPECT_EQ(quantity(kNan, "m"), "\xE2\x80\x94");
  EXPECT_EQ(printed_duration(65.25), "65.2 s");
  EXPECT_EQ(printed_duration(200.0), "3 min 20 s");
  EXPECT_EQ(printed_duration(3900.0), "1 h 5 min");
}

TEST(Text, EscapesMarkupAndBytesThatAreNoText) {
  EXPECT_EQ(escape("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  EXPECT_EQ(escape("\xC3\xA4 \xE2\x82\xAC"), "\xC3\xA4 \xE2\x82\xAC");
  EXPECT_EQ(escape("a\x01"
                   "b\xFF"
                   "c\xC3"),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD"
            "c\xEF\xBF\xBD");
}

TEST(Ticks, AreRoundAndInside) {
  EXPECT_DOUBLE_EQ(nice_step(0.13), 0.2);
  EXPECT_DOUBLE_EQ(nice_step(0.2), 0.2);
  EXPECT_DOUBLE_EQ(nice_step(6.0), 10.0);
  const Ticks t = linear_ticks(-3.2, 3.2, 6);
  EXPECT_EQ(t.values, (std::vector<double>{-2, 0, 2}));
  EXPECT_EQ(t.decimals, 0);
  EXPECT_EQ(linear_ticks(0, 0.1, 5).decimals, 2);
  EXPECT_EQ(log_ticks(0.02, 150, 6), (std::vector<LogTick>{{1, -1}, {1, 0}, {1, 1}, {1, 2}}));
  EXPECT_EQ(log_ticks(0.1, 1e17, 6), (std::vector<LogTick>{{1, -1}, {1, 3}, {1, 7}, {1, 11}, {1, 15}}));
  EXPECT_EQ(log_ticks(15, 120, 6), (std::vector<LogTick>{{2, 1}, {5, 1}, {1, 2}}));
  EXPECT_EQ(log_ticks(0.02, 0.04, 6), (std::vector<LogTick>{{2, -2}, {3, -2}, {4, -2}}));
}

TEST(MapFigure, KeepsTheProportionsAndPutsNorthUp) {
  Extent extent;
  extent.include({-1.0, -2.0});
  extent.include({3.0, 0.0});
  extent.include({kNan, 99.0});
  Room room;
  room.walls.push_back({"north", {0.0, kPi / 2}, 1.0, -3.0});  // along y = 0 from x = -1 to 3
  room.cylinders.push_back({"post", {{1.0, -1.0}, 0.5}});
  MapFigure figure(extent, 500, 2000);
  figure.room(room);
  const std::string svg = figure.svg("A <plan>", "");
  EXPECT_NE(svg.find("A &lt;plan&gt;"), std::string::npos);
  const double scale = attribute(svg, "truth-cylinder", "r") / 0.5;
  EXPECT_NEAR(attribute(svg, "truth-wall", "x2") - attribute(svg, "truth-wall", "x1"), 4 * scale, 0.03);
  EXPECT_NEAR(attribute(svg, "truth-cylinder", "cy") - attribute(svg, "truth-wall", "y1"), 1 * scale, 0.03);
  EXPECT_NEAR(attribute(svg, "truth-cylinder", "cx"), 250, 0.02);
  const double x2 = attribute(svg, "truth-wall", "x2");
  EXPECT_GT(x2, 400);
  EXPECT_LT(x2, 500);
}

TEST(MapFigure, EllipsesPointTheRightWay) {
  Extent extent;
  extent.include({0, 0}, 1.0);
  SlamEstimate e;
  const double sigma = 0.1, small = 0.02, tilt = radians(30);
  Matrix2 turn;
  turn << std::cos(tilt), -std::sin(tilt), std::sin(tilt), std::cos(tilt);
  e.covariance.topLeftCorner<2, 2>() = turn * Vector2(sigma * sigma, small * small).asDiagonal() * turn.transpose();
  MapFigure figure(extent, 500, 500);
  figure.pose_uncertainty(std::vector<SlamEstimate>{e}, 10);
  const std::string svg = figure.svg("", "");
  EXPECT_NEAR(attribute(svg, "pose-ellipse", "rx") / attribute(svg, "pose-ellipse", "ry"), sigma / small, 0.01);
  const double angle = number(text_between(svg, "rotate(", ")"));
  EXPECT_NEAR(std::remainder(angle + 30.0, 180.0), 0.0, 0.01) << "counter-clockwise is negative where y points down";
}

TEST(MapFigure, BandIsThreeSigmaWideAtTheFoot) {
  Extent extent;
  extent.include({0, 0}, 1.0);
  ContourMap map;
  WallEstimate w;
  w.wall = {0.5, 0.0};
  w.begin = w.end = 0.0;
  w.covariance << 0.0004, 0.0, 0.0, 0.01;
  map.walls.push_back(w);
  MapFigure figure(extent, 500, 500);
  figure.uncertainty(map);
  const std::string svg = figure.svg("", "");
  const std::string outline =
      text_between(svg, "class=\"band\" d=\"M", "Z\"");  // there along one side, back along the other
  const double scale = (500 - 2 * 26 - 20) / 2.0;
  EXPECT_NEAR(number(outline) - number(outline.substr(outline.rfind('L') + 1)), 2 * 3 * 0.02 * scale, 0.05);
}

TEST(MapFigure, SurvivesWhatIsNotANumber) {
  ContourMap map;
  map.walls.push_back({.wall = {kNan, 0.0}});
  map.cylinders.push_back({.cylinder = {{kNan, 0.0}, 0.1}});
  map.points.push_back({.position = {0.0, kNan}});
  MapFigure figure({}, 500, 500);
  figure.uncertainty(map);
  figure.contours(map, nullptr);
  figure.readings(std::vector<Vector2>{{kNan, 1.0}, {0.0, 0.0}});
  figure.path(std::vector<eval::TimedPose>{{0, {kNan, 0, 0}}, {1, {0, 0, 0}}}, "estimate-path");
  figure.start({kNan, 0, 0});
  const std::string svg = figure.svg("", "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

Chart long_chart(std::size_t n) {
  Chart chart;
  chart.id = "c";
  for (std::size_t i = 0; i < n; ++i) chart.time.push_back(static_cast<double>(i));
  chart.series = {{"s", "estimate", std::vector<double>(n, 1.0)}};
  return chart;
}

TEST(Chart, LongSeriesStaySmallAndKeepTheirSpikes) {
  Chart chart = long_chart(200'000);
  chart.series[0].values[123'456] = 50.0;
  chart.from_zero = true;
  const std::string html = chart_html(chart);
  EXPECT_LT(html.size(), 60'000u);
  // The spike reaches up to the 6 % that are left above the largest value.
  const std::string path = text_between(html, "class=\"line estimate\" d=\"", "\"");
  double top = 1e9;
  for (std::size_t i = path.find(' '); i != std::string::npos; i = path.find(' ', i + 1)) {
    top = std::min(top, number(path.substr(i + 1, 8)));
  }
  EXPECT_LT(top, 22.0);
}

TEST(Chart, GapsWhereThereIsNoNumber) {
  Chart chart = long_chart(10);
  chart.series[0].values[4] = kNan;
  const std::string html = chart_html(chart);
  EXPECT_EQ(count(text_between(html, "class=\"line estimate\" d=\"", "\""), "M"), 2u);
  EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(Chart, LogarithmicAxisLeavesOutWhatIsNotPositive) {
  Chart chart = long_chart(10);
  chart.logarithmic = true;
  chart.series[0].values = {1, 10, 0, -3, 100, 1, 1, 1, 1, 1};
  const std::string html = chart_html(chart);
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html.find("inf"), std::string::npos);
  EXPECT_NE(html.find(">100<"), std::string::npos);
}

TEST(Chart, EmptyChartIsStillADrawing) {
  Chart chart;
  chart.id = "empty";
  chart.series = {{"s", "estimate", {}}};
  EXPECT_EQ(chart_html(chart).find("nan"), std::string::npos);
}

}  // namespace
}  // namespace noctule::report
