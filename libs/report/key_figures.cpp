#include "report/key_figures.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "report/tables.hpp"
#include "report/text.hpp"

namespace noctule::report {
namespace {

struct Mark {
  const char* css_class;
  double value;
};

/// Marks on a logarithmic line: how far from the limit, how far from no filter at all.
std::string scale(const std::vector<Mark>& marks) {
  constexpr double kLeft = 6.0, kRight = 194.0, kMiddle = 9.0;
  double low = marks.front().value, high = low;
  for (const Mark& m : marks) {
    low = std::min(low, m.value);
    high = std::max(high, m.value);
  }
  if (!(low > 0.0) || high <= low) return {};
  std::string out =
      "<svg class=\"scale-line\" viewBox=\"0 0 200 18\" preserveAspectRatio=\"xMinYMid\" aria-hidden=\"true\"><path "
      "class=\"grid\" d=\"M" +
      fixed(kLeft, 0) + " " + fixed(kMiddle, 0) + "H" + fixed(kRight, 0) + "\"/>";
  for (const Mark& m : marks) {
    const double x = std::lerp(kLeft, kRight, std::log(m.value / low) / std::log(high / low));
    out += std::string("<circle class=\"mark ") + m.css_class + "\" cx=\"" + fixed(x, 1) + "\" cy=\"" +
           fixed(kMiddle, 0) + "\" r=\"" + (m.css_class == std::string("estimate") ? "6" : "4") + "\"/>";
  }
  return out + "</svg>";
}

std::string tile(const std::string& name, const std::string& value, const std::string& below) {
  return "<div class=\"tile\"><h3>" + name + "</h3><p class=\"figure\">" + value + "</p>" + below + "</div>\n";
}

std::string with_unit(double value, const char* unit_name) {
  const PrintUnit unit = print_unit(unit_name, value);
  return printed(value * unit.scale) +
         (unit.symbol.empty() ? "" : "<span class=\"unit " + std::string(unit_name) + "\">" + unit.symbol + "</span>");
}

/// "of 4 found" where a mean leaves out what was missed: it is the better for it.
std::string of_found(const RunData& data, const std::string& counted, const std::string& suffix) {
  if (counted.empty() || find_metric(data.metrics, counted + "_missed" + suffix).value_or(0.0) == 0.0) return {};
  return " of " + fixed(find_metric(data.metrics, counted + "_found" + suffix).value_or(0.0), 0) + " found";
}

/// A metric between its limit and dead reckoning. `counted` names what it is a mean of.
std::string compared(const RunData& data, const char* title, const std::string& name, const char* unit,
                     const std::string& counted = {}) {
  const auto ours = find_metric(data.metrics, name);
  if (!ours) return {};
  std::vector<Mark> marks;
  std::string below;
  const auto add = [&](const char* label, const char* css_class, const std::string& suffix) {
    const auto value = find_metric(data.metrics, name + suffix);
    if (!value) return;
    marks.push_back({css_class, *value});
    below += std::string("<span class=\"key ") + css_class + "\">" + label + " <b>" + quantity(*value, unit) + "</b>" +
             of_found(data, counted, suffix) + "</span>";
  };
  add("known pose", "limit", "_known_pose");
  add("dead reckoning", "odometry", "_dead_reckoning");
  marks.push_back({"estimate", *ours});
  return tile(title, with_unit(*ours, unit) + "<span class=\"unit\">" + of_found(data, counted, "") + "</span>",
              scale(marks) + "<p class=\"others\">" + below + "</p>");
}

std::string remark(const std::string& text) {
  return "<p class=\"others\"><span>" + text + "</span></p>";
}

std::string found_tile(const RunData& data) {
  if (!data.contours) return {};
  if (!data.contours->errors) {
    const ContourMap& map = data.contours->map;
    return tile("Contours found", std::to_string(map.walls.size()) + "<span class=\"unit\">walls</span>",
                remark(std::to_string(map.cylinders.size()) + " cylinders, " + std::to_string(map.points.size()) +
                       " corners; the room is not known"));
  }
  const eval::ContourErrors& e = *data.contours->errors;
  const std::size_t all = e.walls.size() + e.cylinders.size(),
                    invented = e.invented_walls.size() + e.invented_cylinders.size();
  return tile("Contours found",
              std::to_string(e.walls_found() + e.cylinders_found()) + "<span class=\"unit\">of " + std::to_string(all) +
                  "</span>",
              remark(std::to_string(e.walls_found()) + " of " + std::to_string(e.walls.size()) + " walls, " +
                     std::to_string(e.cylinders_found()) + " of " + std::to_string(e.cylinders.size()) +
                     " cylinders; " + (invented == 0 ? "none" : std::to_string(invented)) + " invented"));
}

std::string landmark_tile(const RunData& data) {
  const auto rmse = find_metric(data.metrics, "landmark_rmse");
  if (!rmse) return {};
  const double found = find_metric(data.metrics, "landmarks_found").value_or(0.0);
  return tile("Landmarks, RMS error", with_unit(*rmse, "m"),
              remark(fixed(found, 0) + " of " + std::to_string(data.world.landmarks.size()) + " found"));
}

std::string consistency_tile(const RunData& data) {
  const auto nees = find_metric(data.metrics, "nees_mean");
  const auto median = find_metric(data.metrics, "nees_median");
  const auto inside = find_metric(data.metrics, "nees_inside");
  if (!nees || !median || !inside) return {};
  // A single collapse of the particles makes the mean of any size: the median is what the eye should meet first.
  return tile("Consistency, median NEES", with_unit(*median, "1"),
              remark("2.4 expected; mean " + printed(*nees) + " (3 expected); " + fixed(100.0 * *inside, 0) +
                     " % of the steps within 95 % bounds"));
}

std::string speed_tile(const RunData& data) {
  const auto factor = find_metric(data.timing, "realtime_factor");
  if (!factor) return {};
  return tile("Speed", printed(*factor) + "<span class=\"unit\">\xC3\x97 real time</span>",
              data.duration > 0.0 ? remark(printed_duration(data.duration) + " of data") : "");
}

}  // namespace

std::string key_figures(const RunData& data) {
  const std::string tiles = found_tile(data) +
                            compared(data, "Wall distance <i>\xCF\x81</i>, mean error", "wall_mae_rho", "m", "walls") +
                            compared(data, "Wall angle <i>\xCE\xB8</i>, mean error", "wall_mae_theta", "rad", "walls") +
                            compared(data, "Cylinders, mean error", "cylinder_mae", "m", "cylinders") +
                            compared(data, "Position, RMS error", "position_rmse", "m") +
                            compared(data, "Heading, RMS error", "heading_rmse", "rad") + landmark_tile(data) +
                            consistency_tile(data) + speed_tile(data);
  return tiles.empty() ? "" : "<section class=\"tiles\" aria-label=\"Key figures\">\n" + tiles + "</section>\n";
}

}  // namespace noctule::report
