#include "mapping/hough_votes.hpp"

#include <algorithm>
#include <cmath>

namespace noctule::mapping {

namespace {

constexpr int kMargin = 8;       // rho bins beyond the extent, for the spread of a vote
constexpr double kWidest = 2.0;  // half width of that spread in bins: broader votes only make peaks flat
constexpr double kHeld = 0.98;   // share of the data an extent holds
constexpr double kMarginFactor = 1.1;
constexpr double kRefusedAngle = radians(3.0);  // peaks as near as this to a refused one are the same
constexpr double kRefusedDistance = 0.06;       // [m]

/// How a vote spreads over the bins of rho: a triangle of the same variance, not narrower than what keeps the sum
/// between two bins. It always fills four bins, those outside the triangle with 0.
class Spread {
 public:
  /// \param sigma standard deviation of rho in bins
  Spread(double sigma, double weight)
      : weight_(static_cast<float>(weight)),
        slope_(static_cast<float>(1.0 / std::clamp(std::sqrt(6.0) * sigma, 1.0, kWidest))) {}

  /// \param x middle of the vote, in bins from the middle of the first one
  void add(VoteGrid& grid, int row, double x) const {
    using Bins = Eigen::Array<float, 4, 1>;
    const int first = static_cast<int>(x) - 1;
    if (first < 0 || first + 4 > grid.columns()) return;
    const Bins distance = (Bins(0.0F, 1.0F, 2.0F, 3.0F) + static_cast<float>(first - x)).abs();
    grid.add<4>(row, first, weight_ * slope_ * (1.0F - slope_ * distance).max(0.0F));
  }

 private:
  float weight_;
  float slope_;  // of a triangle of height 1
};

Extent about(std::span<const Vector2> points) {
  Extent extent;
  if (points.empty()) return extent;
  for (const Vector2& p : points) extent.centre += p;
  extent.centre /= static_cast<double>(points.size());
  std::vector<double> radii;
  radii.reserve(points.size());
  for (const Vector2& p : points) radii.push_back((p - extent.centre).norm());
  const auto held = radii.begin() + static_cast<std::ptrdiff_t>(kHeld * static_cast<double>(radii.size() - 1));
  std::nth_element(radii.begin(), held, radii.end());
  extent.radius = kMarginFactor * *held;
  return extent;
}

}  // namespace

Extent Extent::of(std::span<const SonarArc> arcs) {
  std::vector<Vector2> points;
  points.reserve(arcs.size());
  for (const SonarArc& arc : arcs) points.push_back(arc.sensor + arc.range * arc.axis);
  return about(points);
}

Extent Extent::of(std::span<const PointWithCovariance> points) {
  std::vector<Vector2> positions;
  positions.reserve(points.size());
  for (const PointWithCovariance& p : points) positions.push_back(p.position);
  return about(positions);
}

LineVotes::LineVotes(const HoughParameters& parameters, const Extent& extent, Normals normals)
    : parameters_(parameters), extent_(extent), undirected_(normals == Normals::undirected) {
  const int full_turn = static_cast<int>(std::lround(kTwoPi / parameters.theta_bin / 2.0)) * 2;
  parameters_.theta_bin = kTwoPi / full_turn;
  const int rows = normals == Normals::directed ? full_turn : full_turn / 2;
  for (int i = 0; i < rows; ++i) {
    const double theta = i * parameters_.theta_bin;
    normals_.emplace_back(std::cos(theta), std::sin(theta));
  }
  grid_ = VoteGrid(rows, 2 * (static_cast<int>(std::ceil(extent.radius / parameters.rho_bin)) + kMargin) + 1);
}

void LineVotes::vote(const SonarArc& arc, double weight) {
  const double axis = std::atan2(arc.axis.y(), arc.axis.x()), bin = parameters_.theta_bin;
  const int first = static_cast<int>(std::ceil((axis - arc.half_angle) / bin));
  const int last = std::max(first, static_cast<int>(std::floor((axis + arc.half_angle) / bin)));
  const Spread spread(arc.sigma / parameters_.rho_bin, weight / (last - first + 1));
  const Vector2 p = (arc.sensor - extent_.centre) / parameters_.rho_bin;
  const double zero = arc.range / parameters_.rho_bin + 0.5 * (grid_.columns() - 1);
  const int rows = grid_.rows();
  for (int i = first; i <= last; ++i) {
    const int row = i < 0 ? i + rows : (i >= rows ? i - rows : i);
    spread.add(grid_, row, normals_[static_cast<std::size_t>(row)].dot(p) + zero);
  }
}

void LineVotes::vote(const PointWithCovariance& point, double weight) {
  const Vector2 p = (point.position - extent_.centre) / parameters_.rho_bin;
  const double zero = 0.5 * (grid_.columns() - 1);
  for (int row = 0; row < grid_.rows(); ++row) {
    const Vector2& n = normals_[static_cast<std::size_t>(row)];
    const double sigma = std::sqrt(std::max(0.0, n.dot(point.covariance * n)));
    Spread(sigma / parameters_.rho_bin, weight).add(grid_, row, n.dot(p) + zero);
  }
}

std::optional<LineVotes::Peak> LineVotes::best(double threshold) {
  const VoteGrid::Peak cell = grid_.best(static_cast<float>(threshold));
  if (cell.row < 0) return {};
  Wall wall{(cell.column - 0.5 * (grid_.columns() - 1)) * parameters_.rho_bin, wrap(cell.row * parameters_.theta_bin)};
  wall.rho += wall.normal().dot(extent_.centre);
  return Peak{wall, cell.votes, cell};
}

void LineVotes::refuse(const Peak& peak) {
  const int rows = grid_.rows(), last = grid_.columns() - 1;
  const auto reach_theta = static_cast<int>(std::ceil(kRefusedAngle / parameters_.theta_bin));
  const auto reach_rho = static_cast<int>(std::ceil(kRefusedDistance / parameters_.rho_bin));
  for (int i = -reach_theta; i <= reach_theta; ++i) {
    const int row = peak.cell.row + i;
    // Half a turn further undirected lines come back with the sign of rho changed.
    const bool turned = undirected_ && (row < 0 || row >= rows);
    const int column = turned ? last - peak.cell.column : peak.cell.column;
    grid_.forbid((row + rows) % rows, column - reach_rho, column + reach_rho);
  }
}

CircleVotes::CircleVotes(const HoughParameters& parameters, const Extent& extent)
    : parameters_(parameters),
      cells_(2 * static_cast<int>(std::ceil((extent.radius + parameters.max_radius) / parameters.centre_bin)) + 2),
      layers_(static_cast<int>(std::floor(parameters.max_radius / parameters.radius_bin + 1e-9)) + 1),
      grid_(layers_ * cells_, cells_) {
  corner_ = extent.centre - Vector2::Constant(0.5 * cells_ * parameters.centre_bin);
}

void CircleVotes::vote(int layer, const Vector2& position, double distance, double weight) {
  const Vector2 p = (position - corner_) / parameters_.centre_bin;
  const auto x0 = static_cast<float>(p.x()), y0 = static_cast<float>(p.y());
  const auto d = static_cast<float>(distance / parameters_.centre_bin), limit = static_cast<float>(cells_);
  const auto share = static_cast<float>(weight / static_cast<double>(directions_.size()));
  for (const Eigen::Vector2f& u : directions_) {
    const float x = x0 + d * u.x(), y = y0 + d * u.y();
    if (x < 0.0F || y < 0.0F || x >= limit || y >= limit) continue;
    grid_.add(layer * cells_ + static_cast<int>(y), static_cast<int>(x), share);
  }
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
    directions_.push_back(u.cast<float>());
    u = {turn.x() * u.x() - turn.y() * u.y(), turn.y() * u.x() + turn.x() * u.y()};
  }
  for (int layer = 0; layer < layers_; ++layer) {
    vote(layer, arc.sensor, arc.range + layer * parameters_.radius_bin, weight);
  }
}

void CircleVotes::vote(const PointWithCovariance& point, double weight) {
  for (int layer = 1; layer < layers_; ++layer) {
    const double radius = layer * parameters_.radius_bin;
    const int samples = 1 + static_cast<int>(kTwoPi * radius / parameters_.centre_bin);
    directions_.clear();
    for (int i = 0; i < samples; ++i) {
      const double angle = kTwoPi * i / samples;
      directions_.push_back(Vector2(std::cos(angle), std::sin(angle)).cast<float>());
    }
    vote(layer, point.position, radius, weight);
  }
}

std::optional<CircleVotes::Peak> CircleVotes::best(double threshold) {
  const VoteGrid::Peak cell = grid_.best(static_cast<float>(threshold));
  if (cell.row < 0) return {};
  const int layer = cell.row / cells_, y = cell.row % cells_;
  const Vector2 centre = corner_ + parameters_.centre_bin * Vector2(cell.column + 0.5, y + 0.5);
  return Peak{{centre, layer * parameters_.radius_bin}, cell.votes, cell};
}

void CircleVotes::refuse(const Peak& peak) {
  const int layer = peak.cell.row / cells_, y = peak.cell.row % cells_;
  const auto reach = static_cast<int>(std::ceil(kRefusedDistance / parameters_.centre_bin));
  const auto reach_radius = static_cast<int>(std::ceil(kRefusedDistance / parameters_.radius_bin));
  for (int k = std::max(0, layer - reach_radius); k <= std::min(layers_ - 1, layer + reach_radius); ++k) {
    for (int row = std::max(0, y - reach); row <= std::min(cells_ - 1, y + reach); ++row) {
      grid_.forbid(k * cells_ + row, peak.cell.column - reach, peak.cell.column + reach);
    }
  }
}

}  // namespace noctule::mapping
