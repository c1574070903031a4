#pragma once
/// An occupancy grid from sonar scans.
#include <vector>

#include "core/observations.hpp"
#include "core/parameters.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::mapping {

struct OccupancyParameters {
  double resolution = 0.05;  ///< side of a cell [m]
  double free = 0.40;        ///< log odds that an echo takes from a cell on the axis before it
  double occupied = 0.85;    ///< log odds that it gives to a cell on the axis at its range
  double inner_cone = 0.5;   ///< share of the half angle within which a nearer surface would have been heard
  double limit = 6.0;        ///< log odds stay within +- limit, so that a cell can change its mind
  double max_cells = 16e6;   ///< the grid refuses to grow beyond
  models::RangeNoise range_noise;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("resolution_cm", &OccupancyParameters::resolution, unit::centimetre, "side of a cell", positive());
    v.field("free", &OccupancyParameters::free, unit::one, "log odds an echo takes from cells before it",
            at_least(0.0));
    v.field("occupied", &OccupancyParameters::occupied, unit::one, "log odds it gives to cells at its range",
            at_least(0.0));
    v.field("inner_cone", &OccupancyParameters::inner_cone, unit::one,
            "share of the half angle within which a nearer surface would have been heard", between(0.0, 1.0));
    v.field("limit", &OccupancyParameters::limit, unit::one, "largest log odds", positive());
    v.field("max_cells", &OccupancyParameters::max_cells, unit::one, "largest size of the grid", positive());
    v.group("range_noise", &OccupancyParameters::range_noise, "noise of a range");
  }
};

/// Log odds of cells being occupied, 0 where nothing is known (Moravec and Elfes 1985; Thrun, Burgard, Fox 2005, table
/// 9.1, with an inverse model for the cone of a ranger): an echo frees the inner cone up to its range, less on the
/// sides, and occupies, on some of its arc, cells near its range. Silence says nothing: most pings return no echo.
class OccupancyGrid {
 public:
  /// A grid that grows with what it is given.
  explicit OccupancyGrid(const OccupancyParameters& parameters);
  /// A grid of at least [low, high] [m], map frame; what lies outside is ignored.
  /// \throws InputError unless low < high, finite, and not more than max_cells
  OccupancyGrid(const OccupancyParameters& parameters, const Vector2& low, const Vector2& high);

  /// \throws InputError when the pose or a hit is not finite, or the grid would grow beyond max_cells
  void add(const UltrasonicScan& scan, const Pose2& base_in_map);

  [[nodiscard]] int width() const { return width_; }    ///< cells along x
  [[nodiscard]] int height() const { return height_; }  ///< cells along y
  [[nodiscard]] double resolution() const { return parameters_.resolution; }
  /// Lower left corner of cell (0, 0) [m], map frame. Images have their first row at the top: write row height - 1
  /// first.
  [[nodiscard]] Vector2 origin() const {
    return parameters_.resolution * Vector2(static_cast<double>(first_x_), static_cast<double>(first_y_));
  }
  /// Log odds of a cell, 0 <= column < width, 0 <= row < height, rows towards larger y.
  [[nodiscard]] double log_odds(int column, int row) const { return cells_[index(column, row)]; }
  [[nodiscard]] double probability(int column, int row) const { return 1.0 / (1.0 + std::exp(-log_odds(column, row))); }
  /// Log odds at a point [m] of the map, 0 outside the grid.
  [[nodiscard]] double log_odds_at(const Vector2& point) const;

 private:
  /// Cells [x, x_end) x [y, y_end), counted from the origin of the map.
  struct Box {
    std::int64_t x, y, x_end, y_end;
  };
  [[nodiscard]] Box box(const Vector2& low, const Vector2& high) const;
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
  }
  void resize(const Box& b);
  void include(const Box& b);
  void add_echo(const Pose2& sensor, double range, double half_angle);

  OccupancyParameters parameters_;
  bool grows_;
  std::int64_t first_x_ = 0, first_y_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<float> cells_;  // rows of equal y
};

}  // namespace noctule::mapping
