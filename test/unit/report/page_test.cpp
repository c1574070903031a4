#include "report/page.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <nlohmann/json.hpp>

#include "report/run_plans.hpp"
#include "unit/report/find_text.hpp"
#include "unit/report/sample_run.hpp"

namespace noctule::report {
namespace {

/// The first tag that is not closed in order, or an empty string. Content of script and style is skipped.
std::string first_unbalanced(const std::string& html) {
  std::vector<std::string> open;
  for (std::size_t i = html.find('<'); i != std::string::npos; i = html.find('<', i)) {
    if (html.compare(i, 2, "<!") == 0) {
      i = html.find('>', i);
      continue;
    }
    const std::size_t end = html.find('>', i);
    if (end == std::string::npos) return "unclosed <";
    const bool closing = html[i + 1] == '/';
    std::size_t stop = i + 1 + (closing ? 1 : 0);
    std::string name;
    while (std::isalnum(static_cast<unsigned char>(html[stop]))) name += html[stop++];
    i = end;
    if (name.empty()) return "no name at " + html.substr(stop, 20);
    if (closing) {
      if (open.empty() || open.back() != name) return "</" + name + ">";
      open.pop_back();
    } else if (html[end - 1] != '/' && name != "meta" && name != "input") {
      open.push_back(name);
      if (name == "script" || name == "style") i = html.find("</" + name, end);
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

RunData without_truth() {
  RunData data = sample_run();
  data.world = {};
  data.truth.clear();
  data.contours->errors.reset();
  data.contours_known_pose.reset();
  data.contours_dead_reckoning->errors.reset();
  data.metrics = run_metrics(data);
  return data;
}

RunData with_landmarks() {
  RunData data = sample_run();
  data.world.room.reset();
  data.contours.reset();
  data.contours_known_pose.reset();
  data.contours_dead_reckoning.reset();
  data.direct_points.clear();
  data.occupancy.reset();
  for (int i = 0; i < 5; ++i) {
    data.world.landmarks.push_back({i, {0.5 * i, 1.0}});
    LandmarkEstimate l;
    l.id = i;
    l.parameters = {0.5 * i + 0.01, 1.02, 0};
    l.covariance = 1e-4 * Matrix3::Identity();
    data.landmarks.landmarks.push_back(l);
  }
  data.metrics = run_metrics(data);
  return data;
}

TEST(Page, IsBalancedAndSelfContained) {
  for (const RunData& data : {sample_run(), without_truth(), with_landmarks(), RunData{}}) {
    const std::string html = page(data);
    EXPECT_EQ(first_unbalanced(html), "") << data.title;
    for (const char* outside : {"http://", "https://", "src=", "href=", "@import", "url("}) {
      EXPECT_EQ(html.find(outside), std::string::npos) << outside;
    }
  }
}

TEST(Page, EscapesEverythingThatComesFromOutside) {
  const std::string evil = "\"><script>alert('x')</script>\xFF";
  RunData data = sample_run();
  data.title = data.version = data.world.name = data.config_yaml = evil;
  data.warnings = data.notes = {evil};
  data.modules = {{evil, evil, 0, 0, 0, 0, 0, 0, evil, evil}};
  data.metrics.push_back({evil, 1.0, evil});
  data.timing.push_back({evil, 1.0, evil});
  data.world.room->walls[0].name = data.world.room->cylinders[0].name = evil;
  data.contours->errors = eval::contour_errors(data.contours->map, *data.world.room);
  const std::string html = page(data);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find('\xFF'), std::string::npos);
  EXPECT_EQ(first_unbalanced(html), "");
  EXPECT_EQ(map_svg(data).find("<script>alert"), std::string::npos);
}

TEST(Page, NumbersTravelAsJson) {
  const RunData data = sample_run();
  const std::string html = page(data);
  const nlohmann::json json = nlohmann::json::parse(text_between(html, "id=\"run-data\">", "</script>"));
  EXPECT_EQ(json.at("metrics").size(), data.metrics.size());
  for (const auto& chart : json.at("charts")) {
    EXPECT_NE(html.find("id=\"" + chart.at("id").get<std::string>() + "\""), std::string::npos);
    for (const auto& series : chart.at("series")) EXPECT_EQ(series.at("values").size(), chart.at("time").size());
  }
}

TEST(Page, ShowsThePapersFiguresOnlyForItsRoom) {
  RunData data = sample_run();
  std::string html = page(data);
  for (const char* word : {"VB-APF-SLAM", "323.13", "misprint", "Known pose", "Dead reckoning", "Map at known poses"}) {
    EXPECT_NE(html.find(word), std::string::npos) << word;
  }
  data.world.room->walls[2].wall.rho += 0.05;
  data.contours->errors = eval::contour_errors(data.contours->map, *data.world.room);
  html = page(data);
  EXPECT_EQ(html.find("VB-APF-SLAM"), std::string::npos);
}

TEST(Page, PrintsAnglesAsTheTableDoes) {
  RunData data = sample_run();
  data.world.room->walls[2].wall.theta = 1e-17;  // 360 degrees in table 3
  data.contours->errors = eval::contour_errors(data.contours->map, *data.world.room);
  EXPECT_NE(page(data).find(">360.00<"), std::string::npos);
}

TEST(Page, PrintsCentimetresAndDegrees) {
  RunData data;
  data.metrics = {{"wall_mae_rho", 0.0123, "m"}, {"wall_mae_theta", radians(1.5), "rad"}};
  const std::string html = page(data);
  EXPECT_NE(html.find("1.23 cm"), std::string::npos);
  EXPECT_NE(html.find("1.50\xC2\xB0"), std::string::npos);
}

TEST(Page, AdaptsToWhatIsThere) {
  const std::string recorded = page(without_truth());
  EXPECT_EQ(recorded.find("Errors over time"), std::string::npos);
  EXPECT_NE(recorded.find("nobody has measured"), std::string::npos);
  EXPECT_NE(recorded.find("Walls found"), std::string::npos);
  const std::string sightings = page(with_landmarks());
  EXPECT_NE(sightings.find("Landmarks, RMS error"), std::string::npos);
  EXPECT_EQ(sightings.find("Direct map"), std::string::npos);
  EXPECT_NE(page({}).find("before anything was measured"), std::string::npos);
}

TEST(Page, SaysWhatAMeanLeavesOut) {
  RunData data = sample_run();
  data.contours->map.walls.erase(data.contours->map.walls.begin() + 3);
  data.contours->errors = eval::contour_errors(data.contours->map, *data.world.room);
  data.metrics = run_metrics(data);
  const std::string html = page(data);
  EXPECT_NE(html.find(" of 6 found"), std::string::npos);
  EXPECT_NE(html.find(">missed<"), std::string::npos);
}

TEST(MapSvg, IsADrawingOfItsOwn) {
  const std::string svg = map_svg(sample_run());
  const std::string width = text_between(svg, " width=\"", "\""), height = text_between(svg, " height=\"", "\"");
  EXPECT_EQ(text_between(svg, "viewBox=\"", "\""), "0 0 " + width + " " + height);
  EXPECT_NE(svg.find("xmlns=\"http://www.w3.org/2000/svg\""), std::string::npos);
  EXPECT_GT(number(width), 300);
  EXPECT_GT(number(height), 300);
  EXPECT_EQ(first_unbalanced(svg), "");
  EXPECT_NE(svg.find("<style>"), std::string::npos);
  EXPECT_NE(svg.find("class=\"truth-wall\""), std::string::npos);
}

}  // namespace
}  // namespace noctule::report
