#include "sensors/ultrasonic/geometry.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <limits>

#include "models/ultrasonic.hpp"

namespace noctule::sensors {
namespace {

constexpr double kCoincident = 1e-6;  ///< positions closer than this are one [m]

[[nodiscard]] Vector2 left_of(const Vector2& v) {
  return {-v.y(), v.x()};
}

/// Positions about their mean, in the order of their spread.
struct Layout {
  Vector2 mean = Vector2::Zero();
  double mean_range = 0.0;
  Vector2 major = Vector2::UnitX();  ///< direction of the larger spread, from the first towards the last position
  Vector2 minor = Vector2::UnitY();  ///< left of major
  double major_scatter = 0.0;        ///< sum of squares along major [m^2]
  double minor_scatter = 0.0;
};

[[nodiscard]] Layout layout(std::span<const Sighting> sightings) {
  Layout l;
  const double weight = 1.0 / static_cast<double>(sightings.size());
  for (const Sighting& s : sightings) {
    l.mean += weight * s.position;
    l.mean_range += weight * s.range;
  }
  Matrix2 scatter = Matrix2::Zero();
  for (const Sighting& s : sightings) {
    const Vector2 d = s.position - l.mean;
    scatter += d * d.transpose();
  }
  const double half_trace = 0.5 * scatter.trace();
  const double half_difference = 0.5 * (scatter(0, 0) - scatter(1, 1));
  const double radius = std::hypot(half_difference, scatter(0, 1));
  l.major_scatter = half_trace + radius;
  const double angle = 0.5 * std::atan2(scatter(0, 1), half_difference);
  l.major = {std::cos(angle), std::sin(angle)};
  if (l.major.dot(sightings.back().position - sightings.front().position) < 0.0) l.major = -l.major;
  l.minor = left_of(l.major);
  // Not half_trace - radius: that cancels for positions on a line.
  for (const Sighting& s : sightings) l.minor_scatter += std::pow(l.minor.dot(s.position - l.mean), 2);
  return l;
}

/// Root x in (0, inf) of (a/x)^2 + (b/(d + x))^2 = 1, a > 0, d >= 0; or 0 in the hard case a = 0, |b| <= d.
[[nodiscard]] double outer_secular_root(double a, double b, double d) {
  if (a == 0.0) return std::max(0.0, std::abs(b) - d);
  double x = a;  // the left side is >= 1 here, and Newton on 1 - 1/sqrt(left side) climbs to the root
  for (int i = 0; i < 60; ++i) {
    const double p = a / x, q = b / (d + x);
    const double square = p * p + q * q;
    const double step = square * (std::sqrt(square) - 1.0) / (p * p / x + q * q / (d + x));
    x += step;
    if (std::abs(step) <= 1e-15 * x) break;
  }
  return x;
}

/// Smallest root x in (0, d) of (a/x)^2 + (b/(d - x))^2 = 1: the second local minimum, or nothing.
[[nodiscard]] std::optional<double> inner_secular_root(double a, double b, double d) {
  if (a == 0.0) return std::abs(b) <= d ? std::optional(0.0) : std::nullopt;
  const auto excess = [&](double x) { return std::pow(a / x, 2) + std::pow(b / (d - x), 2) - 1.0; };
  const double ratio = std::cbrt(a * a), other = std::cbrt(b * b);
  double high = d * ratio / (ratio + other);  // minimum of the convex left side
  if (!(high > 0.0) || !(high < d)) high = std::clamp(high, 1e-12 * d, d * (1.0 - 1e-12));
  if (!(excess(high) <= 0.0)) return std::nullopt;
  double low = a;  // excess(a) >= 0
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

template <class Surface>
[[nodiscard]] double misfit_of(std::span<const Sighting> sightings, const Surface& surface) {
  double sum = 0.0;
  for (const Sighting& s : sightings) {
    const auto echo = models::predict_echo(s.position, surface);
    sum += std::pow(s.range - echo.range, 2) / s.range_variance +
           std::pow(wrap(s.direction - echo.direction), 2) / s.direction_variance;
  }
  return sum;
}

/// Keeps the candidate with the smallest misfit, the first of equals.
template <class Surface>
class Best {
 public:
  explicit Best(std::span<const Sighting> sightings) : sightings_(sightings) {}
  void offer(const Surface& candidate) {
    const double cost = misfit(sightings_, candidate);
    if (cost < cost_) {
      cost_ = cost;
      best_ = candidate;
    }
  }
  [[nodiscard]] const std::optional<Surface>& get() const { return best_; }

 private:
  std::span<const Sighting> sightings_;
  std::optional<Surface> best_;
  double cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace

FrameChange::FrameChange(const PoseGaussian& motion) : new_T_old_(inverse(motion.mean)) {
  const double c = std::cos(new_T_old_.yaw), s = std::sin(new_T_old_.yaw);
  Matrix2 rotation;
  rotation << c, -s, s, c;
  adjoint_.setIdentity();
  adjoint_.topLeftCorner<2, 2>() = rotation;
  adjoint_.topRightCorner<2, 1>() = rotation * left_of(motion.mean.position());
  Matrix3 turn = Matrix3::Identity();
  turn.topLeftCorner<2, 2>() = rotation;
  drift_ = turn * motion.covariance * turn.transpose();
}

void FrameChange::apply(Sighting& sighting) const {
  sighting.position = new_T_old_ * sighting.position;
  sighting.direction = wrap(sighting.direction + new_T_old_.yaw);
  sighting.drift = (adjoint_ * sighting.drift * adjoint_.transpose() + drift_).eval();
}

void FrameChange::apply(Wall& wall, Matrix2& covariance) const {
  wall = transformed(new_T_old_, wall);
  Matrix2 j = Matrix2::Identity();
  j(0, 1) = wall.tangent().dot(new_T_old_.position());
  Eigen::Matrix<double, 2, 3> g = Eigen::Matrix<double, 2, 3>::Zero();
  g.topLeftCorner<1, 2>() = wall.normal().transpose();
  g(1, 2) = 1.0;
  covariance = (j * covariance * j.transpose() + g * drift_ * g.transpose()).eval();
}

void FrameChange::apply(Vector2& point, Matrix2& covariance) const {
  Cylinder cylinder{point, 0.0};
  Matrix3 full = Matrix3::Zero();
  full.topLeftCorner<2, 2>() = covariance;
  apply(cylinder, full);
  point = cylinder.centre;
  covariance = full.topLeftCorner<2, 2>();
}

void FrameChange::apply(Cylinder& cylinder, Matrix3& covariance) const {
  cylinder.centre = new_T_old_ * cylinder.centre;
  Matrix3 j = adjoint_;
  j.topRightCorner<2, 1>().setZero();
  Matrix3 g = Matrix3::Zero();
  g.topLeftCorner<2, 2>().setIdentity();
  g.topRightCorner<2, 1>() = left_of(cylinder.centre);
  covariance = (j * covariance * j.transpose() + g * drift_ * g.transpose()).eval();
}

void FrameChange::apply(ContourFeature& feature) const {
  if (feature.has_wall) apply(feature.wall, feature.wall_covariance);
  if (feature.has_circle) apply(feature.circle, feature.circle_covariance);
  feature.surface = new_T_old_ * feature.surface;
}

double misfit(std::span<const Sighting> sightings, const Wall& wall) {
  return misfit_of(sightings, wall);
}
double misfit(std::span<const Sighting> sightings, const Cylinder& cylinder) {
  return misfit_of(sightings, cylinder);
}

std::optional<Wall> tangent_wall(std::span<const Sighting> sightings) {
  if (sightings.size() < 2) return std::nullopt;
  const Layout l = layout(sightings);
  if (l.major_scatter < kCoincident * kCoincident) return std::nullopt;
  // Centred: minimise sum ((r_i - rbar) + n.(p_i - pbar))^2, |n| = 1, in the principal axes of the positions.
  double along = 0.0, across = 0.0;  // components of A'y
  for (const Sighting& s : sightings) {
    const Vector2 d = s.position - l.mean;
    along -= l.major.dot(d) * (s.range - l.mean_range);
    across -= l.minor.dot(d) * (s.range - l.mean_range);
  }
  const double gap = l.major_scatter - l.minor_scatter;
  const double side = across < 0.0 ? -1.0 : 1.0;
  // What rounding leaves of positions on a line must not choose between the mirror images.
  const double a = std::abs(across) > 1e-14 * l.major_scatter ? std::abs(across) : 0.0;

  Best<Wall> best(sightings);
  const auto offer = [&](double major_component, double sign) {
    const double m = std::clamp(major_component, -1.0, 1.0);
    const Vector2 n = m * l.major + sign * std::sqrt(1.0 - m * m) * l.minor;
    best.offer({l.mean_range + n.dot(l.mean), std::atan2(n.y(), n.x())});
  };
  const double outer = outer_secular_root(a, along, gap);
  if (gap + outer > 0.0) offer(along / (gap + outer), side);
  if (const auto inner = inner_secular_root(a, along, gap); inner && gap - *inner > 0.0)
    offer(along / (gap - *inner), -side);
  return best.get();
}

std::optional<Vector2> point_at_ranges(std::span<const Sighting> sightings) {
  if (sightings.size() < 2) return std::nullopt;
  const Layout l = layout(sightings);
  if (l.major_scatter < kCoincident * kCoincident) return std::nullopt;
  // |p_i - q|^2 = r_i^2, centred: 2 d_i.(q - pbar) = |d_i|^2 - r_i^2 - mean of the same, axis by axis.
  double mean_power = 0.0, along = 0.0, across = 0.0;
  const double count = static_cast<double>(sightings.size());
  for (const Sighting& s : sightings) mean_power += (s.range * s.range - (s.position - l.mean).squaredNorm()) / count;
  for (const Sighting& s : sightings) {
    const Vector2 d = s.position - l.mean;
    const double power = d.squaredNorm() - s.range * s.range + mean_power;
    along += 0.5 * l.major.dot(d) * power;
    across += 0.5 * l.minor.dot(d) * power;
  }
  const double x = along / l.major_scatter;
  Best<Cylinder> best(sightings);
  const auto offer = [&](double y) { best.offer({l.mean + x * l.major + y * l.minor, 0.0}); };
  if (const double square = mean_power - x * x; square >= 0.0) {
    offer(std::sqrt(square));
    offer(-std::sqrt(square));
  }
  if (sightings.size() > 2 && l.minor_scatter > 1e-12 * l.major_scatter) offer(across / l.minor_scatter);
  if (!best.get()) return std::nullopt;
  return best.get()->centre;
}

std::optional<Cylinder> apollonius(std::span<const Sighting> sightings, double max_radius) {
  const int n = static_cast<int>(sightings.size());
  if (n < 3 || n > kMaxSightings) return std::nullopt;
  const Layout l = layout(sightings);
  if (l.major_scatter < kCoincident * kCoincident) return std::nullopt;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxSightings, 1>;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMaxSightings, 3>;
  Columns m(n, 3);  // 2 d.(c - pbar) + 2 r R = |d|^2 - r^2 + k, k = |c - pbar|^2 - R^2, in principal axes
  Column power(n);
  for (int i = 0; i < n; ++i) {
    const Vector2 d = sightings[i].position - l.mean;
    m.row(i) << 2.0 * l.major.dot(d), 2.0 * l.minor.dot(d), 2.0 * sightings[i].range;
    power[i] = d.squaredNorm() - sightings[i].range * sightings[i].range;
  }
  Best<Cylinder> best(sightings);
  const auto offer = [&](double x, double y, double radius) {
    if (radius > 0.0 && radius <= max_radius) best.offer({l.mean + x * l.major + y * l.minor, radius});
  };
  // Positions that span the plane: (c, R) = a + k b, and k from its definition.
  if (l.minor_scatter > 1e-12 * l.major_scatter) {
    const Eigen::ColPivHouseholderQR<Columns> qr(m);
    if (qr.rank() == 3) {
      const Vector3 a = qr.solve(power), b = qr.solve(Column::Ones(n));
      const auto form = [](const Vector3& u, const Vector3& v) { return u[0] * v[0] + u[1] * v[1] - u[2] * v[2]; };
      const double qa = form(b, b), qb = form(a, b) - 0.5, qc = form(a, a);  // qa k^2 + 2 qb k + qc = 0
      if (const double discriminant = qb * qb - qa * qc; discriminant >= 0.0) {
        const double q = -(qb + std::copysign(std::sqrt(discriminant), qb));  // without cancellation
        for (const double k : {q / qa, qc / q}) {
          const Vector3 x = a + k * b;
          if (x.allFinite()) offer(x[0], x[1], x[2]);
        }
      }
    }
  }
  // Positions (nearly) on a line: (c_major, R, k) are linear, the distance from the line follows from k.
  m.col(1).setConstant(-1.0);
  const Eigen::ColPivHouseholderQR<Columns> qr(m);
  if (qr.rank() == 3) {
    const Vector3 x = qr.solve(power);  // (c_major, k, R)
    if (const double square = x[1] + x[2] * x[2] - x[0] * x[0]; square >= 0.0) {
      offer(x[0], std::sqrt(square), x[2]);
      offer(x[0], -std::sqrt(square), x[2]);
    }
  }
  return best.get();
}

double baseline(std::span<const Sighting> sightings) {
  double largest = 0.0;
  for (std::size_t i = 0; i < sightings.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      largest = std::max(largest, (sightings[i].position - sightings[j].position).squaredNorm());
  return std::sqrt(largest);
}

double separating_baseline(double range, double sigma) {
  return std::sqrt(12.0 * std::sqrt(6.0) * sigma * range);
}

}  // namespace noctule::sensors
