#include "report/page.hpp"

#include "eval/published_contours.hpp"
#include "report/assets.hpp"
#include "report/camera_figure.hpp"
#include "report/document.hpp"
#include "report/json.hpp"
#include "report/key_figures.hpp"
#include "report/run_charts.hpp"
#include "report/run_plans.hpp"
#include "report/tables.hpp"
#include "report/text.hpp"

namespace noctule::report {
namespace {

std::string plan(const std::string& css_class, const std::string& heading, const std::string& toggles,
                 const std::string& svg) {
  if (svg.empty()) return {};
  return "<figure class=\"plan " + css_class + "\"><figcaption><b>" + heading + "</b>" + toggles + "</figcaption>\n" +
         svg + "</figure>\n";
}

/// A switch for a layer of the plan around it; page.css does the rest.
std::string toggle(const char* layer, const char* css_class, const char* label, bool on) {
  return std::string("<label class=\"key ") + css_class + "\"><input type=\"checkbox\" data-layer=\"" + layer + "\"" +
         (on ? " checked" : "") + ">" + label + "</label>";
}

constexpr const char* kInventedKey = "<span class=\"key invented\">invented</span>";

bool has_invented(const std::optional<ContourResult>& result) {
  return result && result->errors &&
         !(result->errors->invented_walls.empty() && result->errors->invented_cylinders.empty());
}

bool knows_world(const RunData& data) {
  return data.world.room || !data.world.landmarks.empty();
}

std::string header(const RunData& data) {
  const auto length = find_metric(data.metrics, "path_length");
  return page_header("Noctule run report", data.title,
                     {{"World", data.world.name},
                      {"Seed", std::to_string(data.seed)},
                      {"Duration", data.duration > 0.0 ? printed_duration(data.duration) : ""},
                      {"Path", length ? fixed(*length, 1) + " m" : ""},
                      {"Particles", data.estimates.empty() ? "" : std::to_string(data.estimates.back().particles)},
                      {"Version", data.version}});
}

std::string sentences(const std::vector<std::string>& texts, const char* css_class, const char* label) {
  if (texts.empty()) return {};
  std::string items;
  for (const std::string& t : texts) items += "<li>" + escape(t) + "</li>";
  return std::string("<aside class=\"") + css_class + "\" aria-label=\"" + label + "\"><ul>" + items +
         "</ul></aside>\n";
}

/// The plan whose layers can be switched.
std::string estimated_map(const RunData& data) {
  if (!data.contours && data.landmarks.landmarks.empty()) return {};
  std::string legend = "<span class=\"legend\">" + toggle("estimate", "estimate", "estimate", true) +
                       toggle("uncertainty", "band-key", "3\xCF\x83", true) +
                       toggle("estimate-path", "path-key", "path", true);
  if (knows_world(data)) legend += toggle("truth", "truth", "truth", true);
  if (!data.direct_points.empty()) legend += toggle("readings", "readings-key", "readings", false);
  if (has_invented(data.contours)) legend += kInventedKey;
  return plan("map-plan", "Estimated map", legend + "</span>", map_plan(data));
}

std::string direct_map(const RunData& data) {
  if (data.direct_points.empty()) return {};
  return plan("readings-plan", "Direct map, unfiltered",
              "<span class=\"legend\"><span class=\"key readings-key\">readings</span>"
              "<span class=\"key odometry\">dead reckoning</span></span>",
              readings_plan(data));
}

std::string path_map(const RunData& data) {
  if (data.estimates.empty()) return {};
  std::string legend = "<span class=\"legend\">" + toggle("estimate-path", "estimate", "filter", true) +
                       toggle("uncertainty", "band-key", "3\xCF\x83", true);
  if (!data.dead_reckoning.empty()) legend += toggle("odometry-path", "odometry", "dead reckoning", true);
  if (!data.truth.empty()) legend += toggle("truth-path", "truth-line", "truth", true);
  return plan("path-plan", "Path", legend + "</span>", path_plan(data));
}

std::string other_map(const RunData& data, const char* css_class, const char* title,
                      const std::optional<ContourResult>& contours) {
  if (!contours) return {};
  const std::string legend =
      has_invented(contours) ? std::string("<span class=\"legend\">") + kInventedKey + "</span>" : "";
  return plan(css_class, title, legend, contour_plan(data, *contours, title));
}

std::string map_section(const RunData& data) {
  const std::string plans = estimated_map(data) + direct_map(data) + path_map(data) +
                            other_map(data, "limit-plan", "Map at known poses, the limit", data.contours_known_pose) +
                            other_map(data, "odometry-plan", "Map along dead reckoning", data.contours_dead_reckoning) +
                            plan("occupancy-plan", "Occupancy grid", "", occupancy_plan(data));
  if (plans.empty()) return {};
  const bool echoes = data.contours || !data.direct_points.empty();
  const std::string lead =
      std::string("What the robot made of its ") + (echoes ? "echoes" : "sightings") +
      (knows_world(data) ? ", drawn over the world as it is." : "; how the world really is, nobody has measured.") +
      (data.direct_points.empty() ? ""
                                  : " The direct map is what it would draw without a filter: each reading on the axis "
                                    "of its beam, along dead reckoning.");
  return section("Map and path", lead, "<div class=\"pair\">\n" + plans + "</div>\n");
}

std::string chart_section(const std::string& heading, const std::string& lead, const std::vector<Chart>& charts) {
  std::string content;
  for (const Chart& c : charts) content += chart_html(c);
  return content.empty() ? "" : section(heading, lead, "<div class=\"pair charts\">\n" + content + "</div>\n");
}

std::string contour_section(const RunData& data) {
  if (!data.contours) return {};
  std::string content = wall_table(data) + cylinder_table(data);
  if (content.empty()) {
    content = found_walls_table(data.contours->map) + found_cylinders_table(data.contours->map);
    return section("Walls and cylinders", "The room is not known: estimates with their standard deviations.", content);
  }
  if (has_published_figures(data)) content += "<p class=\"note\">" + escape(eval::published_contours_note()) + "</p>\n";
  return section("Walls and cylinders",
                 "Each estimate with its error below it. Known pose is the mapper on the true path, the limit of any "
                 "filter; dead reckoning is the mapper on odometry alone.",
                 content);
}

std::string camera_section(const RunData& data) {
  if (!data.camera) return {};
  return section("What the camera saw",
                 "The image with the most landmarks, at " + fixed(data.camera->time, 1) +
                     " s: their outlines, numbers and distances.",
                 "<div class=\"pair\">\n<figure>" + camera_figure(*data.camera) + "</figure>\n</div>\n");
}

std::string run_section(const RunData& data) {
  std::string beside = timing_table(data);
  if (!data.config_yaml.empty()) beside += folded("Effective configuration", data.config_yaml);
  const std::string metrics = metric_table(data), modules = module_table(data);
  if (metrics.empty() && beside.empty() && modules.empty()) return {};
  return section("The run in figures", "",
                 "<div class=\"split\"><div>\n" + metrics + "</div>\n<div>\n" + beside + "</div></div>\n" + modules);
}

}  // namespace

std::string page(const RunData& data) {
  const std::vector<Chart> errors = error_charts(data), health = health_charts(data);
  std::vector<Chart> all = errors;
  all.insert(all.end(), health.begin(), health.end());
  const std::string body =
      key_figures(data) + map_section(data) + camera_section(data) +
      chart_section("Errors over time", "Shaded: three standard deviations by the filter's own account.", errors) +
      contour_section(data) +
      chart_section("Health of the filter",
                    "Whether the particles are many and different, and the innovations and errors as large as the "
                    "filter believes.",
                    health) +
      run_section(data);
  return document(data.title, header(data),
                  sentences(data.warnings, "warnings", "Warnings") +
                      (body.empty() ? "<p class=\"lead\">The run ended before anything was measured.</p>\n" : body) +
                      sentences(data.notes, "notes", "Notes"),
                  "<script type=\"application/json\" id=\"run-data\">" + page_json(data, all) +
                      "</script>\n<script>\n" + kPageScript + "</script>\n");
}

}  // namespace noctule::report
