#include "eval/contour_file.hpp"

#include <array>
#include <cmath>

#include "eval/number_rows.hpp"
#include "eval/number_text.hpp"

namespace noctule::eval {
namespace {

constexpr std::array<std::string_view, 4> kWall{"rho", "theta", "begin", "end"};
constexpr std::array<std::string_view, 3> kCylinder{"x", "y", "radius"};
constexpr std::array<std::string_view, 3> kFix{"t", "x", "y"};

template <std::size_t N>
std::string header(const std::array<std::string_view, N>& columns) {
  std::string line;
  for (const std::string_view column : columns) line.append(line.empty() ? "" : ",").append(column);
  return line + '\n';
}

std::string row(std::initializer_list<double> values) {
  std::string line;
  for (const double value : values) line += (line.empty() ? "" : ",") + shortest(value);
  return line + '\n';
}

}  // namespace

std::string walls_csv(std::span<const RoomWall> walls) {
  std::string text = header(kWall);
  for (const RoomWall& w : walls) text += row({w.wall.rho, w.wall.theta, w.begin, w.end});
  return text;
}

std::string cylinders_csv(std::span<const RoomCylinder> cylinders) {
  std::string text = header(kCylinder);
  for (const auto& [name, c] : cylinders) text += row({c.centre.x(), c.centre.y(), c.radius});
  return text;
}

std::vector<RoomWall> parse_walls(std::string_view text, const std::string& place) {
  std::vector<RoomWall> walls;
  for (const NumberRow& r : parse_rows(text, place, kWall, ',')) {
    walls.push_back({"wall " + std::to_string(walls.size() + 1), {r.values[0], r.values[1]}, r.values[2], r.values[3]});
  }
  return walls;
}

std::vector<RoomCylinder> parse_cylinders(std::string_view text, const std::string& place) {
  std::vector<RoomCylinder> cylinders;
  for (const NumberRow& r : parse_rows(text, place, kCylinder, ',')) {
    if (r.values[2] < 0.0) refuse_row(place, r.line, "a radius of at least 0", shortest(r.values[2]));
    cylinders.push_back(
        {"cylinder " + std::to_string(cylinders.size() + 1), {{r.values[0], r.values[1]}, r.values[2]}});
  }
  return cylinders;
}

Room as_room(const ContourMap& map) {
  Room room;
  for (const WallEstimate& w : map.walls) room.walls.push_back({"", w.wall, w.begin, w.end});
  for (const CylinderEstimate& c : map.cylinders) room.cylinders.push_back({"", c.cylinder});
  return room;
}

ContourMap as_map(const Room& room) {
  ContourMap map;
  for (const RoomWall& w : room.walls) {
    map.walls.emplace_back();
    map.walls.back().wall = w.wall;
    map.walls.back().begin = w.begin;
    map.walls.back().end = w.end;
  }
  for (const RoomCylinder& c : room.cylinders) {
    map.cylinders.emplace_back();
    map.cylinders.back().cylinder = c.cylinder;
  }
  return map;
}

std::string fixes_csv(std::span<const KnownPosition> fixes) {
  std::string text = header(kFix);
  for (const KnownPosition& f : fixes)
    text += row({1e-6 * static_cast<double>(f.utime), f.position.x(), f.position.y()});
  return text;
}

std::vector<KnownPosition> parse_fixes(std::string_view text, const std::string& place) {
  std::vector<KnownPosition> fixes;
  for (const NumberRow& r : parse_rows(text, place, kFix, ',')) {
    if (std::abs(r.values[0]) > 1e11) refuse_row(place, r.line, "a time in seconds", shortest(r.values[0]));
    const std::int64_t utime = std::llround(1e6 * r.values[0]);
    if (!fixes.empty() && utime <= fixes.back().utime) {
      refuse_row(place, r.line, "a later time than above", shortest(r.values[0]));
    }
    fixes.push_back({utime, {r.values[1], r.values[2]}});
  }
  return fixes;
}

}  // namespace noctule::eval
