#include "mapping/line_fit.hpp"

#include <algorithm>
#include <stdexcept>

#include "mapping/rho_theta.hpp"

namespace noctule::mapping {
namespace {

constexpr int kLineIterations = 10;
constexpr double kLineConverged = 1e-12;  // [rad]

/// Weighted sums of points: weight, centroid, scatter about it.
struct Moments {
  double weight = 0.0;
  Vector2 centroid = Vector2::Zero();
  Matrix2 scatter = Matrix2::Zero();
};

template <class Weight>
Moments moments(std::span<const PointWithCovariance> points, const Weight& weight) {
  Moments m;
  for (const PointWithCovariance& p : points) {
    const double w = weight(p);
    m.weight += w;
    m.centroid += w * p.position;
  }
  m.centroid /= m.weight;
  for (const PointWithCovariance& p : points) {
    const Vector2 d = p.position - m.centroid;
    m.scatter += weight(p) * d * d.transpose();
  }
  return m;
}

Wall principal_line(const Moments& m) {
  const double theta = 0.5 * std::atan2(-2.0 * m.scatter(0, 1), m.scatter(1, 1) - m.scatter(0, 0));
  Wall w{0.0, theta};
  w.rho = w.normal().dot(m.centroid);
  return w;
}

}  // namespace

std::optional<LineFit> fit_line(std::span<const PointWithCovariance> points) {
  for (const PointWithCovariance& p : points) {
    if (!p.position.allFinite() || !p.covariance.allFinite() || !(p.covariance.trace() > 0.0)) {
      throw std::invalid_argument("fit_line: expected finite points with positive variance");
    }
  }
  if (points.size() < 2) return {};

  // The variance across the line must not vanish for points that are certain in one direction.
  const auto variance = [](const PointWithCovariance& p, const Vector2& n) {
    return std::max(n.dot(p.covariance * n), 1e-9 * p.covariance.trace());
  };
  Moments m = moments(points, [](const PointWithCovariance& p) { return 1.0 / p.covariance.trace(); });
  Wall wall = principal_line(m);
  for (int i = 0; i < kLineIterations; ++i) {
    const Vector2 n = wall.normal();
    m = moments(points, [&](const PointWithCovariance& p) { return 1.0 / variance(p, n); });
    const Wall next = aligned(principal_line(m), wall);
    const bool done = std::abs(wrap(next.theta - wall.theta)) < kLineConverged;
    wall = next;
    if (done) break;
  }
  const Vector2 t = wall.tangent(), n = wall.normal();
  const double spread = t.dot(m.scatter * t);
  if (!(spread > 0.0)) return {};

  wall = normalised(wall);
  const double along = wall.tangent().dot(m.centroid), var_theta = 1.0 / spread;
  LineFit fit{.wall = wall};
  fit.covariance << 1.0 / m.weight + along * along * var_theta, along * var_theta, along * var_theta, var_theta;
  for (const PointWithCovariance& p : points) {
    const double e = wall.distance(p.position);
    fit.chi2 += e * e / variance(p, n);
  }
  return fit;
}

}  // namespace noctule::mapping
