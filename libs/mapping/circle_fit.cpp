#include "mapping/circle_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>
#include <vector>

#include "core/symmetric_eigen.hpp"

namespace noctule::mapping {
namespace {

constexpr int kIterations = 50;
constexpr double kConverged = 1e-10;  // [m]

Vector2 mean(std::span<const Vector2> points) {
  Vector2 sum = Vector2::Zero();
  for (const Vector2& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

std::optional<Cylinder> usable(const Cylinder& c) {
  if (!c.centre.allFinite() || !std::isfinite(c.radius)) return {};
  return c;
}

/// Normal equations of the geometric fit at one circle.
struct Normal {
  Matrix3 information = Matrix3::Zero();
  Vector3 gradient = Vector3::Zero();
  double chi2 = 0.0;
};

Normal linearise(std::span<const PointWithCovariance> points, const Cylinder& circle) {
  Normal n;
  for (const PointWithCovariance& p : points) {
    const Vector2 d = p.position - circle.centre;
    const double length = d.norm();
    if (length < 1e-9) continue;  // the centre itself says nothing about its direction
    const Vector2 u = d / length;
    const double variance = std::max(u.dot(p.covariance * u), 1e-9 * p.covariance.trace());
    const double e = length - circle.radius;
    const Vector3 j(-u.x(), -u.y(), -1.0);
    n.information += j * j.transpose() / variance;
    n.gradient += j * (e / variance);
    n.chi2 += e * e / variance;
  }
  return n;
}

}  // namespace

std::optional<Cylinder> kasa_circle(std::span<const Vector2> points) {
  if (points.size() < 3) return {};
  const Vector2 centre = mean(points);
  Matrix3 a = Matrix3::Zero();
  Vector3 b = Vector3::Zero();
  for (const Vector2& p : points) {
    const Vector2 q = p - centre;
    const Vector3 row(2.0 * q.x(), 2.0 * q.y(), 1.0);
    a += row * row.transpose();
    b += row * q.squaredNorm();
  }
  const Eigen::FullPivLU<Matrix3> lu(a);
  if (!lu.isInvertible()) return {};
  const Vector3 s = lu.solve(b);
  return usable({centre + s.head<2>(), std::sqrt(s.head<2>().squaredNorm() + s[2])});
}

std::optional<Cylinder> taubin_circle(std::span<const Vector2> points) {
  if (points.size() < 3) return {};
  const Vector2 centre = mean(points);
  double z_mean = 0.0;
  for (const Vector2& p : points) z_mean += (p - centre).squaredNorm();
  z_mean /= static_cast<double>(points.size());
  if (!(z_mean > 0.0)) return {};
  Matrix3 scatter = Matrix3::Zero();
  for (const Vector2& p : points) {
    const Vector2 q = p - centre;
    const Vector3 row((q.squaredNorm() - z_mean) / (2.0 * std::sqrt(z_mean)), q.x(), q.y());
    scatter += row * row.transpose();
  }
  const Vector3 a = symmetric_eigen<3>(scatter).vectors.col(0);
  const double a1 = a[0] / (2.0 * std::sqrt(z_mean));
  if (std::abs(a1) * std::sqrt(z_mean) < 1e-9) return {};  // a line
  const Vector2 c = -a.tail<2>() / (2.0 * a1);
  return usable({centre + c, std::sqrt(c.squaredNorm() + z_mean)});
}

std::optional<CircleFit> fit_circle(std::span<const PointWithCovariance> points) {
  std::vector<Vector2> positions;
  positions.reserve(points.size());
  for (const PointWithCovariance& p : points) {
    if (!p.position.allFinite() || !p.covariance.allFinite() || !(p.covariance.trace() > 0.0)) {
      throw std::invalid_argument("fit_circle: expected finite points with positive variance");
    }
    positions.push_back(p.position);
  }
  const auto start = taubin_circle(positions);
  if (!start) return {};

  Cylinder circle = *start;
  Normal at = linearise(points, circle);
  double damping = 1e-4;
  for (int i = 0; i < kIterations; ++i) {
    Matrix3 h = at.information;
    h.diagonal() *= 1.0 + damping;
    const Vector3 step = -h.ldlt().solve(at.gradient);
    const Cylinder next{circle.centre + step.head<2>(), circle.radius + step[2]};
    const Normal there = linearise(points, next);
    if (there.chi2 > at.chi2) {
      damping *= 10.0;
      if (damping > 1e12) break;
      continue;
    }
    circle = next;
    at = there;
    damping *= 0.1;
    if (step.norm() < kConverged) break;
  }
  if (!(circle.radius > 0.0) || !circle.centre.allFinite()) return {};
  const Eigen::FullPivLU<Matrix3> lu(at.information);
  if (!lu.isInvertible()) return {};
  return CircleFit{circle, lu.inverse(), at.chi2};
}

}  // namespace noctule::mapping
