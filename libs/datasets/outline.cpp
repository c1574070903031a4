#include "datasets/outline.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "datasets/table.hpp"

namespace noctule::datasets {
namespace {

constexpr double kSmall = 1e-6;  // [m] or [m^2]; outlines are measured with a tape

double cross(const Vector2& a, const Vector2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Corners where the outline really turns.
std::vector<Vector2> turning_points(std::span<const Vector2> corners) {
  std::vector<Vector2> distinct;
  for (const Vector2& c : corners) {
    if (distinct.empty() || (c - distinct.back()).norm() > kSmall) distinct.push_back(c);
  }
  while (distinct.size() > 1 && (distinct.front() - distinct.back()).norm() <= kSmall) distinct.pop_back();
  std::vector<Vector2> turning;
  const std::size_t n = distinct.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2 in = distinct[i] - distinct[(i + n - 1) % n], out = distinct[(i + 1) % n] - distinct[i];
    if (std::abs(cross(in, out)) > kSmall) turning.push_back(distinct[i]);
  }
  return turning;
}

RoomWall wall_between(const Vector2& a, const Vector2& b, const Vector2& outward) {
  Wall wall{outward.dot(a), std::atan2(outward.y(), outward.x())};
  if (std::abs(wall.rho) < kSmall) wall.rho = 0.0;
  wall = normalised(wall);
  const double along_a = wall.tangent().dot(a), along_b = wall.tangent().dot(b);
  return {{}, wall, std::min(along_a, along_b), std::max(along_a, along_b)};
}

}  // namespace

Room room_from_outline(std::span<const Vector2> corners) {
  const std::vector<Vector2> c = turning_points(corners);
  double twice_area = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) twice_area += cross(c[i], c[(i + 1) % c.size()]);
  if (c.size() < 3 || std::abs(twice_area) < kSmall) throw std::invalid_argument("the outline encloses no area");
  const double sense = twice_area > 0.0 ? 1.0 : -1.0;  // +1: counter-clockwise, the outside is to the right
  Room room;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const Vector2& a = c[i];
    const Vector2& b = c[(i + 1) % c.size()];
    const Vector2 along = (b - a).normalized();
    room.walls.push_back(wall_between(a, b, sense * Vector2(along.y(), -along.x())));
    room.walls.back().name = "wall " + std::to_string(i + 1);
  }
  return room;
}

Room read_outline(const std::filesystem::path& path) {
  const Table table(path, {.columns = {"x_m", "y_m"}, .separator = ',', .header = "x_m,y_m"});
  std::vector<Vector2> corners;
  for (int row = 0; row < table.rows(); ++row) corners.emplace_back(table(row, 0), table(row, 1));
  try {
    return room_from_outline(corners);
  } catch (const std::invalid_argument&) {
    throw InputError(path.string() + ": expected three or more corners around an area, got " +
                     std::to_string(table.rows()) + " that enclose none");
  }
}

}  // namespace noctule::datasets
