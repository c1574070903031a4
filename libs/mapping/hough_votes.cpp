#include "mapping/hough_votes.hpp"

#include <algorithm>
#include <cmath>

namespace noctule::mapping {

Extent Extent::of(std::span<const SonarArc> arcs) {
  Extent extent;
  if (arcs.empty()) return extent;
  for (const SonarArc& arc : arcs) extent.centre += arc.sensor;
  extent.centre /= static_cast<double>(arcs.size());
  for (const SonarArc& arc : arcs) {
    extent.radius = std::max(extent.radius, (arc.sensor - extent.centre).norm() + arc.range);
  }
  return extent;
}

Extent Extent::of(std::span<const PointWithCovariance> points) {
  Extent extent;
  if (points.empty()) return extent;
  for (const PointWithCovariance& p : points) extent.centre += p.position;
  extent.centre /= static_cast<double>(points.size());
  for (const PointWithCovariance& p : points) {
    extent.radius = std::max(extent.radius, (p.position - extent.centre).norm());
  }
  return extent;
}

namespace {
constexpr int kMargin = 8;  // bins beyond the extent, for the spread of a vote
}

LineVotes::LineVotes(const HoughParameters& parameters, const Extent& extent, Normals normals)
    : parameters_(parameters), extent_(extent) {
  const int full_turn = static_cast<int>(std::lround(kTwoPi / parameters.theta_bin / 2.0)) * 2;
  parameters_.theta_bin = kTwoPi / full_turn;
  const int rows = normals == Normals::directed ? full_turn : full_turn / 2;
  for (int i = 0; i < rows; ++i) {
    const double theta = i * parameters_.theta_bin;
    normals_.emplace_back(std::cos(theta), std::sin(theta));
  }
  grid_ = VoteGrid(rows, 2 * (static_cast<int>(std::ceil(extent.radius / parameters.rho_bin)) + kMargin) + 1);
}

void LineVotes::spread(int row, double rho, double sigma, double weight) {
  // A triangle of the same variance, not narrower than what keeps the sum between two bins.
  const double half_width = std::max(1.0, std::sqrt(6.0) * sigma / parameters_.rho_bin);
  const double x = rho / parameters_.rho_bin + 0.5 * (grid_.columns() - 1);
  const int first = std::max(0, static_cast<int>(std::ceil(x - half_width)));
  const int last = std::min(grid_.columns() - 1, static_cast<int>(std::floor(x + half_width)));
  float* cells = grid_.row(row);
  const double slope = 1.0 / half_width, top = weight / half_width;
  for (int i = first; i <= last; ++i) cells[i] += static_cast<float>(top * (1.0 - slope * std::abs(i - x)));
}

void LineVotes::vote(const SonarArc& arc, double weight) {
  const double axis = std::atan2(arc.axis.y(), arc.axis.x());
  const int first = static_cast<int>(std::ceil((axis - arc.half_angle) / parameters_.theta_bin));
  const int last = std::max(first, static_cast<int>(std::floor((axis + arc.half_angle) / parameters_.theta_bin)));
  const Vector2 p = arc.sensor - extent_.centre;
  const int rows = grid_.rows();
  for (int i = first; i <= last; ++i) {
    const int row = (i % rows + rows) % rows;
    spread(row, normals_[static_cast<std::size_t>(row)].dot(p) + arc.range, arc.sigma, weight / (last - first + 1));
  }
}

void LineVotes::vote(const PointWithCovariance& point, double weight) {
  const Vector2 p = point.position - extent_.centre;
  for (int row = 0; row < grid_.rows(); ++row) {
    const Vector2& n = normals_[static_cast<std::size_t>(row)];
    spread(row, n.dot(p), std::sqrt(std::max(0.0, n.dot(point.covariance * n))), weight);
  }
}

Wall LineVotes::wall(const VoteGrid::Peak& peak) const {
  const Wall local{(peak.column - 0.5 * (grid_.columns() - 1)) * parameters_.rho_bin,
                   wrap(peak.row * parameters_.theta_bin)};
  return {local.rho + local.normal().dot(extent_.centre), local.theta};
}

CircleVotes::CircleVotes(const HoughParameters& parameters, const Extent& extent)
    : parameters_(parameters),
      cells_(2 * static_cast<int>(std::ceil((extent.radius + parameters.max_radius) / parameters.centre_bin)) + 2),
      layers_(static_cast<int>(std::floor(parameters.max_radius / parameters.radius_bin + 1e-9)) + 1),
      grid_(layers_ * cells_, cells_) {
  corner_ = extent.centre - Vector2::Constant(0.5 * cells_ * parameters.centre_bin);
}

void CircleVotes::add(int layer, const Vector2& p, float weight) {
  const Vector2 cell = (p - corner_) / parameters_.centre_bin;
  const int x = static_cast<int>(cell.x()), y = static_cast<int>(cell.y());
  if (x < 0 || y < 0 || x >= cells_ || y >= cells_) return;
  grid_.row(layer * cells_ + y)[x] += weight;
}

void CircleVotes::vote(const SonarArc& arc, double weight) {
  const int samples =
      1 + static_cast<int>(2.0 * arc.half_angle * (arc.range + parameters_.max_radius) / parameters_.centre_bin);
  const double step = 2.0 * arc.half_angle / samples;
  const Vector2 turn(std::cos(step), std::sin(step));
  Vector2 u(std::cos(0.5 * step - arc.half_angle), std::sin(0.5 * step - arc.half_angle));
  u = {arc.axis.x() * u.x() - arc.axis.y() * u.y(), arc.axis.y() * u.x() + arc.axis.x() * u.y()};
  directions_.clear();
  for (int i = 0; i < samples; ++i) {
    directions_.push_back(u);
    u = {turn.x() * u.x() - turn.y() * u.y(), turn.y() * u.x() + turn.x() * u.y()};
  }
  const auto share = static_cast<float>(weight / samples);
  for (int layer = 0; layer < layers_; ++layer) {
    const double distance = arc.range + layer * parameters_.radius_bin;
    for (const Vector2& d : directions_) add(layer, arc.sensor + distance * d, share);
  }
}

void CircleVotes::vote(const PointWithCovariance& point, double weight) {
  for (int layer = 1; layer < layers_; ++layer) {
    const double radius = layer * parameters_.radius_bin;
    const int samples = 1 + static_cast<int>(kTwoPi * radius / parameters_.centre_bin);
    const auto share = static_cast<float>(weight / samples);
    for (int i = 0; i < samples; ++i) {
      const double angle = kTwoPi * i / samples;
      add(layer, point.position + radius * Vector2(std::cos(angle), std::sin(angle)), share);
    }
  }
}

Cylinder CircleVotes::cylinder(const VoteGrid::Peak& peak) const {
  const int layer = peak.row / cells_, y = peak.row % cells_;
  const Vector2 centre = corner_ + parameters_.centre_bin * Vector2(peak.column + 0.5, y + 0.5);
  return {centre, layer * parameters_.radius_bin};
}

}  // namespace noctule::mapping
