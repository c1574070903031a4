#include "eval/contour_error.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/assignment.hpp"
#include "core/limits.hpp"

namespace noctule::eval {
namespace {

void check(const ContourErrorParameters& p) {
  if (!(p.rho_scale > 0.0 && p.theta_scale > 0.0 && p.wall_gate > 0.0 && p.cylinder_gate > 0.0)) {
    throw std::invalid_argument("contour_errors: scales and gates must be positive");
  }
}

std::size_t anchor_index(const Room& room, const std::string& name) {
  if (name.empty()) return 0;
  const auto it = std::find_if(room.walls.begin(), room.walls.end(), [&](const RoomWall& w) { return w.name == name; });
  if (it == room.walls.end()) throw std::invalid_argument("contour_errors: no wall '" + name + "' in the room");
  return static_cast<std::size_t>(it - room.walls.begin());
}

struct WallDifference {
  double rho = 0.0;
  double theta = 0.0;
  double cost = kInf;
};

/// On the branch of (rho, theta) = (-rho, theta + pi) that costs less.
WallDifference wall_difference(const Wall& estimate, const Wall& truth, const ContourErrorParameters& p) {
  const auto on_branch = [&](double rho, double theta) {
    const WallDifference d{rho - truth.rho, wrap(theta - truth.theta), 0.0};
    return WallDifference{d.rho, d.theta, std::abs(d.rho) / p.rho_scale + std::abs(d.theta) / p.theta_scale};
  };
  const WallDifference same = on_branch(estimate.rho, estimate.theta);
  const WallDifference other = on_branch(-estimate.rho, estimate.theta + kPi);
  return other.cost < same.cost ? other : same;
}

/// Column of each row, -1 where nothing is closer than the gate.
template <class Cost>
std::vector<int> associate(std::size_t rows, std::size_t columns, double gate, const Cost& cost) {
  Eigen::MatrixXd costs(rows, columns);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      const double c = cost(i, j);
      costs(i, j) = c < gate ? c : kInf;  // NaN compares false: forbidden
    }
  }
  return assign(costs, gate);
}

std::vector<int> unmatched(std::size_t count, const std::vector<int>& matched) {
  std::vector<int> result;
  for (int j = 0; j < static_cast<int>(count); ++j) {
    if (std::find(matched.begin(), matched.end(), j) == matched.end()) result.push_back(j);
  }
  return result;
}

/// Circular mean of the walls' theta errors, weighted by their true lengths (equally when lengths are unknown).
double common_rotation(const std::vector<WallError>& walls, const Room& room) {
  double total_length = 0.0;
  for (const RoomWall& w : room.walls) total_length += w.end - w.begin;
  double sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    if (!walls[i].found()) continue;
    const double weight = total_length > 0.0 ? room.walls[i].end - room.walls[i].begin : 1.0;
    sine += weight * std::sin(walls[i].theta);
    cosine += weight * std::cos(walls[i].theta);
  }
  return sine == 0.0 && cosine == 0.0 ? 0.0 : std::atan2(sine, cosine);
}

WallMeans wall_means(const std::vector<WallError>& walls, bool with_anchor) {
  WallMeans m;
  for (const WallError& w : walls) {
    if (!w.found() || (w.anchor && !with_anchor)) continue;
    ++m.found;
    m.rho += std::abs(w.rho);
    m.theta += std::abs(w.theta);
    m.theta_rotation_free += std::abs(w.theta_rotation_free);
  }
  if (m.found == 0) return {0, kNan, kNan, kNan};
  return {m.found, m.rho / m.found, m.theta / m.found, m.theta_rotation_free / m.found};
}

void compare_walls(const ContourMap& map, const Room& room, const ContourErrorParameters& p, ContourErrors& result) {
  const auto difference = [&](std::size_t i, std::size_t j) {
    return wall_difference(map.walls[j].wall, room.walls[i].wall, p);
  };
  const std::vector<int> match = associate(room.walls.size(), map.walls.size(), p.wall_gate,
                                           [&](std::size_t i, std::size_t j) { return difference(i, j).cost; });
  const std::size_t anchor = anchor_index(room, p.anchor_wall);
  for (std::size_t i = 0; i < room.walls.size(); ++i) {
    WallError error{room.walls[i].name, room.walls[i].wall, i == anchor, match[i], 0.0, 0.0, 0.0};
    if (error.found()) {
      const WallDifference d = difference(i, static_cast<std::size_t>(match[i]));
      error.rho = d.rho;
      error.theta = d.theta;
    }
    result.walls.push_back(error);
  }
  result.common_rotation = common_rotation(result.walls, room);
  for (WallError& w : result.walls) {
    if (w.found()) w.theta_rotation_free = wrap(w.theta - result.common_rotation);
  }
  result.invented_walls = unmatched(map.walls.size(), match);
  result.other_walls = wall_means(result.walls, false);
  result.all_walls = wall_means(result.walls, true);
}

void compare_cylinders(const ContourMap& map, const Room& room, double gate, ContourErrors& result) {
  const std::vector<int> match =
      associate(room.cylinders.size(), map.cylinders.size(), gate, [&](std::size_t i, std::size_t j) {
        const Cylinder& estimate = map.cylinders[j].cylinder;
        return std::isfinite(estimate.radius) ? (estimate.centre - room.cylinders[i].cylinder.centre).norm() : kNan;
      });
  for (std::size_t i = 0; i < room.cylinders.size(); ++i) {
    CylinderError error{room.cylinders[i].name, room.cylinders[i].cylinder, match[i], Vector2::Zero(), 0.0};
    if (error.found()) {
      const Cylinder& estimate = map.cylinders[static_cast<std::size_t>(match[i])].cylinder;
      error.centre = estimate.centre - error.truth.centre;
      error.radius = estimate.radius - error.truth.radius;
      result.cylinder_mae += error.mean_absolute();
      result.cylinder_mae_radius += std::abs(error.radius);
    }
    result.cylinders.push_back(error);
  }
  result.invented_cylinders = unmatched(map.cylinders.size(), match);
  const int found = result.cylinders_found();
  result.cylinder_mae = found > 0 ? result.cylinder_mae / found : kNan;
  result.cylinder_mae_radius = found > 0 ? result.cylinder_mae_radius / found : kNan;
}

}  // namespace

double CylinderError::mean_absolute() const {
  return (std::abs(centre.x()) + std::abs(centre.y()) + std::abs(radius)) / 3.0;
}

int ContourErrors::cylinders_found() const {
  return static_cast<int>(
      std::count_if(cylinders.begin(), cylinders.end(), [](const CylinderError& c) { return c.found(); }));
}

bool ContourErrors::complete() const {
  return walls_missed() == 0 && cylinders_missed() == 0 && invented_walls.empty() && invented_cylinders.empty();
}

ContourErrors contour_errors(const ContourMap& map, const Room& room, const ContourErrorParameters& parameters) {
  check(parameters);
  ContourErrors result;
  compare_walls(map, room, parameters, result);
  compare_cylinders(map, room, parameters.cylinder_gate, result);
  return result;
}

std::vector<Metric> contour_metrics(const ContourErrors& e, std::string_view suffix) {
  std::vector<Metric> metrics;
  const auto add = [&](const std::string& name, double value, const char* unit) {
    metrics.push_back({name + std::string(suffix), value, unit});
  };
  add("walls_found", e.walls_found(), "1");
  add("walls_missed", e.walls_missed(), "1");
  add("walls_invented", static_cast<double>(e.invented_walls.size()), "1");
  add("cylinders_found", e.cylinders_found(), "1");
  add("cylinders_missed", e.cylinders_missed(), "1");
  add("cylinders_invented", static_cast<double>(e.invented_cylinders.size()), "1");
  if (!e.walls.empty()) {
    add("wall_mae_rho", e.other_walls.rho, "m");
    add("wall_mae_theta", e.other_walls.theta, "rad");
    add("wall_mae_theta_rotation_free", e.other_walls.theta_rotation_free, "rad");
    add("wall_mae_rho_all", e.all_walls.rho, "m");
    add("wall_mae_theta_all", e.all_walls.theta, "rad");
    add("common_rotation", e.common_rotation, "rad");
  }
  if (!e.cylinders.empty()) {
    add("cylinder_mae", e.cylinder_mae, "m");
    add("cylinder_mae_radius", e.cylinder_mae_radius, "m");
    for (std::size_t i = 0; i < e.cylinders.size(); ++i) {
      add("cylinder_mae_" + std::to_string(i + 1), e.cylinders[i].found() ? e.cylinders[i].mean_absolute() : kNan, "m");
    }
  }
  return metrics;
}

}  // namespace noctule::eval
