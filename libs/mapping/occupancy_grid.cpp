#include "mapping/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "core/error.hpp"
#include "mapping/sonar_arc.hpp"

namespace noctule::mapping {
namespace {
constexpr std::int64_t kStep = 32;  // cells by which a growing grid grows at least
}

OccupancyGrid::OccupancyGrid(const OccupancyParameters& parameters) : parameters_(parameters), grows_(true) {}

OccupancyGrid::OccupancyGrid(const OccupancyParameters& parameters, const Vector2& low, const Vector2& high)
    : parameters_(parameters), grows_(false) {
  if (!low.allFinite() || !high.allFinite() || !(low.x() < high.x() && low.y() < high.y())) {
    std::ostringstream line;
    line << "mapping: occupancy grid: expected finite bounds, low < high, got (" << low.transpose() << ") and ("
         << high.transpose() << ')';
    throw InputError(line.str());
  }
  resize(box(low, high));
}

OccupancyGrid::Box OccupancyGrid::box(const Vector2& low, const Vector2& high) const {
  const double extent = std::max({std::abs(low.x()), std::abs(low.y()), std::abs(high.x()), std::abs(high.y())});
  if (extent / parameters_.resolution > 1e12) throw InputError("mapping: occupancy grid: position out of all bounds");
  const auto cell = [&](double v) { return static_cast<std::int64_t>(std::floor(v / parameters_.resolution)); };
  return {cell(low.x()), cell(low.y()), cell(high.x()) + 1, cell(high.y()) + 1};
}

void OccupancyGrid::resize(const Box& b) {
  const std::int64_t width = b.x_end - b.x, height = b.y_end - b.y;
  if (static_cast<double>(width) * static_cast<double>(height) > parameters_.max_cells) {
    std::ostringstream line;
    line << "mapping: occupancy grid: expected at most " << parameters_.max_cells << " cells, got " << width << " x "
         << height << "; raise max_cells or the resolution";
    throw InputError(line.str());
  }
  std::vector<float> cells(static_cast<std::size_t>(width * height), 0.0F);
  for (int row = 0; row < height_; ++row) {
    const auto from = cells_.begin() + static_cast<std::ptrdiff_t>(index(0, row));
    std::copy_n(from, width_, cells.begin() + ((first_y_ + row - b.y) * width + first_x_ - b.x));
  }
  cells_ = std::move(cells);
  first_x_ = b.x;
  first_y_ = b.y;
  width_ = static_cast<int>(width);
  height_ = static_cast<int>(height);
}

void OccupancyGrid::include(const Box& b) {
  const std::int64_t last_x = first_x_ + width_, last_y = first_y_ + height_;
  if (cells_.empty()) return resize({b.x - kStep, b.y - kStep, b.x_end + kStep, b.y_end + kStep});
  if (b.x >= first_x_ && b.y >= first_y_ && b.x_end <= last_x && b.y_end <= last_y) return;
  resize({b.x < first_x_ ? b.x - kStep : first_x_, b.y < first_y_ ? b.y - kStep : first_y_,
          b.x_end > last_x ? b.x_end + kStep : last_x, b.y_end > last_y ? b.y_end + kStep : last_y});
}

double OccupancyGrid::log_odds_at(const Vector2& point) const {
  const Vector2 cell = (point - origin()) / parameters_.resolution;
  if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() < width_ && cell.y() < height_)) return 0.0;
  return log_odds(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
}

void OccupancyGrid::add(const UltrasonicScan& scan, const Pose2& base_in_map) {
  check(scan, base_in_map);
  for (const UltrasonicBeam& beam : scan.beams) {
    if (beam.echo == Echo::hit) add_echo(base_in_map * beam.sensor_in_base, beam.range, scan.half_angle);
  }
}

void OccupancyGrid::add_echo(const Pose2& sensor, double range, double half_angle) {
  // Deep enough for every cell that the arc crosses.
  const double depth =
      std::max(std::numbers::sqrt2 / 2.0 * parameters_.resolution, 2.0 * parameters_.range_noise.sd(range));
  const Vector2 axis(std::cos(sensor.yaw), std::sin(sensor.yaw)), p = sensor.position();
  const double reach = range + depth;
  // The cone lies within the box of its tip and of its end, which is at most `bow` from the end of its axis.
  const Vector2 tip = p + reach * axis;
  const double bow = 2.0 * reach * std::sin(0.5 * half_angle);
  const Box b = box(p.cwiseMin(tip - Vector2::Constant(bow)), p.cwiseMax(tip + Vector2::Constant(bow)));
  if (grows_) include(b);

  const double inner = parameters_.inner_cone * half_angle, slope = std::tan(half_angle);
  const auto limit = static_cast<float>(parameters_.limit);
  const std::int64_t last_x = std::min(b.x_end, first_x_ + width_), last_y = std::min(b.y_end, first_y_ + height_);
  for (std::int64_t y = std::max(b.y, first_y_); y < last_y; ++y) {
    for (std::int64_t x = std::max(b.x, first_x_); x < last_x; ++x) {
      const Vector2 d =
          parameters_.resolution * Vector2(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5) - p;
      const double along = axis.dot(d), across = std::abs(axis.x() * d.y() - axis.y() * d.x());
      if (along <= 0.0 || across > slope * along) continue;
      const double distance = d.norm();
      if (distance > reach) continue;
      const double angle = std::atan2(across, along);
      double change = 0.0;
      if (distance > range - depth) {
        const double a = angle / half_angle;
        if (a < 1.0) change = parameters_.occupied * (1.0 - a * a);
      } else if (angle < inner) {
        const double a = angle / inner;
        change = -parameters_.free * (1.0 - a * a);
      }
      float& cell = cells_[index(static_cast<int>(x - first_x_), static_cast<int>(y - first_y_))];
      cell = std::clamp(cell + static_cast<float>(change), -limit, limit);
    }
  }
}

}  // namespace noctule::mapping
