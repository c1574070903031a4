#include <array>
#include <cmath>
#include <limits>

#include "eval/published_contours.hpp"
#include "report/table_html.hpp"
#include "report/tables.hpp"
#include "report/text.hpp"

namespace noctule::report {
namespace {

constexpr const char* kRho = "<i>\xCF\x81</i> <span class=\"unit\">cm</span>";
constexpr const char* kTheta = "<i>\xCE\xB8</i> <span class=\"unit\">\xC2\xB0</span>";
constexpr const char* kPlusMinus = " \xC2\xB1 ";

/// One method's columns.
struct Method {
  std::string name;
  std::string css_class;
  eval::ContourErrors errors;
  [[nodiscard]] std::string heading() const {
    return escape(name) + (css_class == "paper" ? "<small>paper</small>" : "");
  }
};

std::vector<Method> methods_of(const RunData& data) {
  std::vector<Method> methods;
  const auto add = [&](const char* name, const char* css_class, const std::optional<ContourResult>& result) {
    if (result && result->errors) methods.push_back({name, css_class, *result->errors});
  };
  add("This run", "estimate", data.contours);
  add("Known pose", "limit", data.contours_known_pose);
  add("Dead reckoning", "odometry", data.contours_dead_reckoning);
  if (methods.empty() || !has_published_figures(data)) return methods;
  for (const eval::PublishedContours& p : eval::published_contours()) {
    // The paper prints every row, however far from the truth: no gate.
    constexpr double kNoGate = std::numeric_limits<double>::infinity();
    methods.push_back({p.method, "paper", eval::contour_errors(p.map, *data.world.room, {.wall_gate = kNoGate})});
  }
  return methods;
}

/// [deg] in (0, 360], as in table 3.
double table_angle(double theta) {
  const double angle = degrees(theta);
  constexpr double kRounding = 1e-9;  // of an angle of 0 that was computed
  return angle > kRounding ? angle : angle + 360.0;
}

std::string wall_cells(const Method& m, std::size_t i) {
  const eval::WallError& w = m.errors.walls[i];
  if (!w.found()) return cell("missed", "missed " + m.css_class, 2);
  if (std::isnan(w.rho)) return cell("found, not scored", m.css_class, 2);
  const double rho = 100.0 * w.rho, theta = degrees(w.theta);
  return cell(value_with_error(100.0 * w.truth.rho + rho, rho), m.css_class) +
         cell(value_with_error(table_angle(w.truth.theta) + theta, theta), m.css_class);
}

std::string wall_head(const std::vector<Method>& methods) {
  std::string groups = column_head("Wall", "", 1, 2) + column_head("True", "truth", 2);
  std::string units = column_head(kRho, "truth") + column_head(kTheta, "truth");
  for (const Method& m : methods) {
    groups += column_head(m.heading(), m.css_class, 2);
    units += column_head(kRho, m.css_class) + column_head(kTheta, m.css_class);
  }
  return row(groups) + row(units);
}

/// Means over walls: (rho [m], theta [rad]) a method; what is NaN stays blank.
template <class Means>
std::string wall_mean_row(const std::string& label, const std::vector<Method>& methods, const Means& means) {
  std::string cells = row_head(label) + cell("", "truth", 2);
  for (const Method& m : methods) {
    const auto [rho, theta] = means(m.errors);
    cells += cell(std::isnan(rho) ? "" : fixed(100.0 * rho, 2), m.css_class) +
             cell(std::isnan(theta) ? "" : fixed(degrees(theta), 2), m.css_class);
  }
  return row(cells, "mean");
}

std::string found_text(std::size_t found, std::size_t of, std::size_t invented) {
  std::string text = std::to_string(found) + " of " + std::to_string(of);
  if (invented > 0) text += ", " + std::to_string(invented) + " invented";
  return text;
}

using Pair = std::array<double, 2>;
constexpr double kBlank = std::numeric_limits<double>::quiet_NaN();

std::string cylinder_rows(const std::vector<Method>& methods, std::size_t i, const eval::CylinderError& known) {
  const std::array<const char*, 3> names{"<i>x</i>", "<i>y</i>", "<i>R</i>"};
  const Vector3 truth(known.truth.centre.x(), known.truth.centre.y(), known.truth.radius);
  std::string rows;
  for (int k = 0; k < 3; ++k) {
    std::string cells = k == 0 ? row_head(escape(known.name), 3) : "";
    cells += cell(names[static_cast<std::size_t>(k)], "component") + cell(fixed(100.0 * truth[k], 2), "truth");
    for (const Method& m : methods) {
      const eval::CylinderError& c = m.errors.cylinders[i];
      const double error = 100.0 * Vector3(c.centre.x(), c.centre.y(), c.radius)[k];
      cells += c.found() ? cell(value_with_error(100.0 * truth[k] + error, error), m.css_class)
                         : cell("missed", "missed " + m.css_class);
    }
    rows += row(cells);
  }
  return rows;
}

/// "12.34 +- 0.05" of an SI value in print units.
std::string with_sigma(double value, double variance, double scale) {
  return aligned(scale * value) + kPlusMinus + fixed(scale * std::sqrt(std::max(variance, 0.0)), 2);
}

}  // namespace

bool has_published_figures(const RunData& data) {
  return data.world.room && eval::same_contours(*data.world.room, eval::published_room());
}

std::string wall_table(const RunData& data) {
  const std::vector<Method> methods = methods_of(data);
  if (methods.empty() || methods.front().errors.walls.empty()) return {};
  const std::vector<eval::WallError>& known = methods.front().errors.walls;
  std::string body, anchor;
  for (std::size_t i = 0; i < known.size(); ++i) {
    std::string cells = row_head(escape(known[i].name));
    cells += cell(fixed(100.0 * known[i].truth.rho, 2), "truth") +
             cell(fixed(table_angle(known[i].truth.theta), 2), "truth");
    for (const Method& m : methods) cells += wall_cells(m, i);
    body += row(cells);
    if (known[i].anchor) anchor = " without wall " + escape(known[i].name);
  }
  body += wall_mean_row("Mean |error|" + anchor, methods, [](const eval::ContourErrors& e) {
    return Pair{e.other_walls.rho, e.other_walls.theta};
  });
  body += wall_mean_row("Mean |error| free of the common rotation", methods, [](const eval::ContourErrors& e) {
    return Pair{kBlank, e.other_walls.theta_rotation_free};
  });
  std::string found = row_head("Found") + cell("", "truth", 2);
  for (const Method& m : methods) {
    const std::size_t count = static_cast<std::size_t>(m.errors.walls_found());
    found += cell(found_text(count, known.size(), m.errors.invented_walls.size()), m.css_class, 2);
  }
  return table("Walls", wall_head(methods), body + row(found, "mean"), "contours");
}

std::string cylinder_table(const RunData& data) {
  const std::vector<Method> methods = methods_of(data);
  if (methods.empty() || methods.front().errors.cylinders.empty()) return {};
  const std::vector<eval::CylinderError>& known = methods.front().errors.cylinders;
  std::string head = column_head("Cylinder") + column_head("cm", "unit") + column_head("True", "truth");
  for (const Method& m : methods) head += column_head(m.heading(), m.css_class);
  std::string body;
  for (std::size_t i = 0; i < known.size(); ++i) body += cylinder_rows(methods, i, known[i]);
  for (std::size_t i = 0; i < known.size(); ++i) {
    std::string means = row_head("Mean |error|") + cell(escape(known[i].name), "component") + cell("", "truth");
    for (const Method& m : methods) {
      const eval::CylinderError& c = m.errors.cylinders[i];
      means += cell(c.found() ? fixed(100.0 * c.mean_absolute(), 2) : "", m.css_class);
    }
    body += row(means, "mean");
  }
  std::string found = row_head("Found") + cell("", "truth", 2);
  for (const Method& m : methods) {
    const std::size_t count = static_cast<std::size_t>(m.errors.cylinders_found());
    found += cell(found_text(count, known.size(), m.errors.invented_cylinders.size()), m.css_class);
  }
  return table("Cylinders", row(head), body + row(found, "mean"), "contours");
}

std::string found_walls_table(const ContourMap& map) {
  if (map.walls.empty()) return {};
  std::string body;
  for (std::size_t i = 0; i < map.walls.size(); ++i) {
    const WallEstimate& w = map.walls[i];
    body +=
        row(row_head(std::to_string(i + 1)) + cell(with_sigma(w.wall.rho, w.covariance(0, 0), 100.0)) +
            cell(with_sigma(w.wall.theta, w.covariance(1, 1), degrees(1.0))) + cell(quantity(w.end - w.begin, "m")) +
            cell(std::to_string(w.readings)) + cell(std::to_string(w.stops)));
  }
  return table("Walls found", head_row({"Wall", kRho, kTheta, "Seen length", "Readings", "Stops"}), body);
}

std::string found_cylinders_table(const ContourMap& map) {
  if (map.cylinders.empty()) return {};
  std::string body;
  for (std::size_t i = 0; i < map.cylinders.size(); ++i) {
    const CylinderEstimate& c = map.cylinders[i];
    body += row(row_head(std::to_string(i + 1)) + cell(with_sigma(c.cylinder.centre.x(), c.covariance(0, 0), 100.0)) +
                cell(with_sigma(c.cylinder.centre.y(), c.covariance(1, 1), 100.0)) +
                cell(with_sigma(c.cylinder.radius, c.covariance(2, 2), 100.0)) +
                cell(quantity(c.viewing_angle, "rad")) + cell(std::to_string(c.readings)));
  }
  const std::string cm = " <span class=\"unit\">cm</span>";
  return table("Cylinders found",
               head_row({"Cylinder", "<i>x</i>" + cm, "<i>y</i>" + cm, "<i>R</i>" + cm, "Seen over", "Readings"}),
               body);
}

}  // namespace noctule::report
