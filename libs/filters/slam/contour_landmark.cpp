#include "filters/slam/contour_landmark.hpp"

#include <algorithm>
#include <cmath>

#include "core/limits.hpp"
#include "core/log_weights.hpp"
#include "filters/slam/directions.hpp"

namespace noctule::filters {
namespace {

/// Log of 1 / (2 pi), the top of a Gaussian of two numbers of unit variance.
const double kLogTop = -std::log(kTwoPi);

/// Range part of the innovation of an echo.
template <class Hypothesis>
struct RangeInnovation {
  PredictedEcho<Hypothesis::kSize> predicted;
  double value;
  VectorD<Hypothesis::kSize> cross;  // covariance of the parameters with the predicted range
  double variance;

  RangeInnovation(const Hypothesis& h, const PlacedEcho& e)
      : predicted(h.predict(e.sensor)),
        value(e.range - predicted.range),
        cross(h.covariance * predicted.range_slope),
        variance(predicted.range_slope.dot(cross) + e.range_variance) {}
};

/// The whole innovation (range, direction) with its covariance S, 2 x 2 and written out: this is the innermost of all
/// loops.
template <class Hypothesis>
struct EchoInnovation {
  RangeInnovation<Hypothesis> range;
  double direction;
  VectorD<Hypothesis::kSize> cross;  // covariance of the parameters with the predicted direction
  double covariance, variance;       // S of range and direction, and of direction
  double determinant;

  EchoInnovation(const Hypothesis& h, const PlacedEcho& e) : range(h, e) {
    const auto& slope = range.predicted.direction_slope;
    direction = angle_between(range.predicted.direction, e.axis);
    cross = h.covariance * slope;
    covariance = slope.dot(range.cross);
    variance = slope.dot(cross) + e.bearing_variance;
    determinant = range.variance * variance - covariance * covariance;
  }
  /// Innovation' S^-1 innovation.
  [[nodiscard]] double distance2() const {
    return (variance * range.value * range.value - 2.0 * covariance * range.value * direction +
            range.variance * direction * direction) /
           determinant;
  }
};

/// Whether the echo may be likelier than clutter, as far as the range tells: saves most echoes their arc tangent.
template <class Hypothesis>
bool may_explain(const Hypothesis& h, const PlacedEcho& e) {
  if (!h.in_view(e)) return false;
  const RangeInnovation<Hypothesis> i(h, e);
  return i.value * i.value <= e.gate2 * i.variance;
}

/// The range given the direction, in units of its nominal sd: where a learned noise is looked up.
struct ScaledRange {
  VectorD<1> value;  // innovation
  MatrixD<1> extra;  // its variance without the noise
  template <class Hypothesis>
  ScaledRange(const EchoInnovation<Hypothesis>& i, const PlacedEcho& e) {
    const double slope = i.covariance / i.variance;
    value[0] = (i.range.value - slope * i.direction) / std::sqrt(e.range_variance);
    extra(0, 0) = std::max((i.range.variance - slope * i.covariance) / e.range_variance - 1.0, 0.0);
  }
};

/// Apart, so that the loop of a filter with fixed noise stays small.
template <class Hypothesis>
[[gnu::noinline]] double log_density_learned(const EchoInnovation<Hypothesis>& i, const PlacedEcho& e) {
  const ScaledRange range(i, e);
  return e.noise->log_density(range.value, range.extra) -
         0.5 * (i.direction * i.direction / i.variance + std::log(kTwoPi * i.variance * e.range_variance));
}

template <class Hypothesis>
double log_density(const Hypothesis& h, const PlacedEcho& e) {
  if (!h.in_view(e)) return -kInf;
  const EchoInnovation<Hypothesis> i(h, e);
  if (e.noise != nullptr) return log_density_learned(i, e);
  return kLogTop - 0.5 * (i.distance2() + std::log(i.determinant));
}

/// Puts into the innovation of the range what the learned noise says of this very echo: its bias and variance.
/// \return with the moments of the range's residual after the update: with y = S^-1 innovation, the residual is bias +
/// R y and the predicted range keeps the variance R - R S^-1 R
template <class Hypothesis>
[[gnu::noinline]] AssimilatedEcho make_innovation_effective(EchoInnovation<Hypothesis>& i, const PlacedEcho& e) {
  AssimilatedEcho result;
  result.nis = i.distance2();
  const ScaledRange range(i, e);
  const auto noise = e.noise->effective(range.value, range.extra);
  result.noise = noise.covariance(0, 0);
  const double sd = std::sqrt(e.range_variance), variance = result.noise * e.range_variance;
  i.range.value -= noise.bias[0] * sd;
  i.range.variance += variance - e.range_variance;
  i.determinant = i.range.variance * i.variance - i.covariance * i.covariance;
  const double y = (i.variance * i.range.value - i.covariance * i.direction) / i.determinant;
  const double residual = noise.bias[0] + variance * y / sd;
  result.residual.mean[0] = residual;
  result.residual.second_moment(0, 0) =
      residual * residual + result.noise * (1.0 - variance * i.variance / i.determinant);
  return result;
}

/// Kalman update, P -= P H' S^-1 H P: with noises as large as these the result is far from indefinite.
template <class Hypothesis>
AssimilatedEcho update(Hypothesis& h, const PlacedEcho& e) {
  EchoInnovation<Hypothesis> i(h, e);
  AssimilatedEcho result;
  result.nis = i.distance2();
  if (e.noise != nullptr) result = make_innovation_effective(i, e);
  using Gain = VectorD<Hypothesis::kSize>;
  const Gain by_range = (i.variance * i.range.cross - i.covariance * i.cross) / i.determinant;
  const Gain by_direction = (i.range.variance * i.cross - i.covariance * i.range.cross) / i.determinant;
  h.mean += i.range.value * by_range + i.direction * by_direction;
  h.covariance -= by_range * i.range.cross.transpose() + by_direction * i.cross.transpose();
  symmetrise(h.covariance);
  h.refresh();
  return result;
}

template <class Hypothesis>
bool expects(const Hypothesis& h, const PlacedEcho& e, double separation) {
  return h.in_view(e) && std::abs(e.range - h.predict(e.sensor).range) < separation;
}

WallHypothesis start_wall(const ContourFeature& f, const Vector2& surface, const Pose2& base,
                          const ContourLandmarkParameters& p) {
  WallHypothesis h;
  h.anchor = base.position();
  const double rho = f.has_wall ? f.wall.rho : surface.norm();
  const double theta = f.has_wall ? f.wall.theta : std::atan2(surface.y(), surface.x());
  h.mean << rho, theta + base.yaw;
  h.covariance.diagonal() << p.range_sd * p.range_sd, p.direction_sd * p.direction_sd;
  h.refresh();
  return h;
}

CircleHypothesis start_circle(const ContourFeature& f, const Vector2& surface, const Pose2& base,
                              const ContourLandmarkParameters& p) {
  double radius = p.radius, radius_sd = p.radius_sd;
  if (f.type == ContourType::point) {
    radius = 0.0;
    radius_sd = p.point_radius_sd;
  } else if (f.type == ContourType::arc && f.has_circle && f.circle_covariance(2, 2) < radius_sd * radius_sd) {
    radius = std::max(f.circle.radius, 0.0);
  }
  // The surface is known along and across the line of sight; the centre lies one radius behind it.
  const Vector2 across = Pose2{0.0, 0.0, base.yaw} * Vector2(-surface.y(), surface.x());
  const Vector2 along = Vector2(across.y(), -across.x()) / across.norm();
  CircleHypothesis h;
  h.mean << base * surface + radius * along, radius;
  const double range_variance = p.range_sd * p.range_sd, radius_variance = radius_sd * radius_sd;
  h.covariance.topLeftCorner<2, 2>() = (range_variance + radius_variance) * along * along.transpose() +
                                       p.direction_sd * p.direction_sd * across * across.transpose();
  h.covariance.topRightCorner<2, 1>() = radius_variance * along;
  h.covariance.bottomLeftCorner<1, 2>() = radius_variance * along.transpose();
  h.covariance(2, 2) = radius_variance;
  return h;
}

}  // namespace

ContourLandmark::ContourLandmark(const ContourFeature& feature, const Pose2& base, std::int64_t id, int stop,
                                 const ContourLandmarkParameters& parameters)
    : id_(id), born_at_(stop) {
  // A surface nearer than this has no direction.
  const Vector2 surface = feature.surface.norm() > 1e-3 ? feature.surface : Vector2(1e-3, 0.0);
  wall_ = start_wall(feature, surface, base, parameters);
  circle_ = start_circle(feature, surface, base, parameters);
  if (feature.type == ContourType::wall) kind_ = LandmarkKind::wall;
  if (feature.type == ContourType::arc) kind_ = LandmarkKind::cylinder;
  if (feature.type == ContourType::point) kind_ = LandmarkKind::point;
}

double ContourLandmark::log_likelihood_in_view(const PlacedEcho& echo) const {
  if (kind_ == LandmarkKind::wall) return may_explain(wall_, echo) ? log_density(wall_, echo) : -kInf;
  if (kind_ != LandmarkKind::undecided) return may_explain(circle_, echo) ? log_density(circle_, echo) : -kInf;
  if (!may_explain(wall_, echo) && !may_explain(circle_, echo)) return -kInf;
  // Odds of the two types given what was heard so far, equal at first.
  return log_add_exp(log_ratio_ + log_density(wall_, echo), log_density(circle_, echo)) - log_add_exp(log_ratio_, 0.0);
}

AssimilatedEcho ContourLandmark::assimilate(const PlacedEcho& echo, double log_clutter, int stop,
                                            const ContourLandmarkParameters& parameters) {
  ++observations_;
  if (seen_at_ != stop) ++stops_seen_;
  seen_at_ = stop;
  if (kind_ == LandmarkKind::wall) return update(wall_, echo);
  if (kind_ != LandmarkKind::undecided) return update(circle_, echo);

  const double wall = log_density(wall_, echo), circle = log_density(circle_, echo);
  AssimilatedEcho result;
  if (wall > log_clutter) result = update(wall_, echo);
  if (circle > log_clutter) {
    const AssimilatedEcho by_circle = update(circle_, echo);
    if (circle >= wall) result = by_circle;
  }
  log_ratio_ += std::max(wall, log_clutter) - std::max(circle, log_clutter);
  if (stops_seen_ >= parameters.decide_stops && std::abs(log_ratio_) >= parameters.decide_log_ratio) {
    kind_ = log_ratio_ > 0.0 ? LandmarkKind::wall : LandmarkKind::cylinder;
  }
  return result;
}

bool ContourLandmark::expects_near(const PlacedEcho& echo, double separation) const {
  return (kind_ != LandmarkKind::wall && expects(circle_, echo, separation)) ||
         ((kind_ == LandmarkKind::wall || kind_ == LandmarkKind::undecided) && expects(wall_, echo, separation));
}

bool ContourLandmark::failed(int stop, const ContourLandmarkParameters& parameters) const {
  return stop - born_at_ >= parameters.trial_stops && stops_seen_ < parameters.confirm_stops;
}

LandmarkEstimate ContourLandmark::estimate() const {
  LandmarkEstimate e;
  e.id = id_;
  e.kind = kind_;
  e.observations = observations_;
  if (kind_ == LandmarkKind::wall) {
    const Wall about_anchor{wall_.mean[0], wall_.mean[1]};
    Wall w{about_anchor.rho + wall_.normal.dot(wall_.anchor), about_anchor.theta};
    Matrix2 j;
    j << 1.0, w.tangent().dot(wall_.anchor), 0.0, 1.0;
    if (w.rho < 0.0) j.row(0) *= -1.0;
    w = normalised(w);
    e.parameters << w.rho, w.theta, 0.0;
    e.covariance.topLeftCorner<2, 2>() = j * wall_.covariance * j.transpose();
    return e;
  }
  constexpr double thinnest_cylinder = 0.04;
  if (kind_ == LandmarkKind::cylinder && circle_.mean[2] < thinnest_cylinder) e.kind = LandmarkKind::point;
  if (e.kind == LandmarkKind::point) {
    e.parameters << circle_.mean.head<2>(), 0.0;
    e.covariance.topLeftCorner<2, 2>() = circle_.covariance.topLeftCorner<2, 2>();
  } else {
    e.parameters << circle_.mean.head<2>(), std::max(circle_.mean[2], 0.0);
    e.covariance = circle_.covariance;
  }
  return e;
}

}  // namespace noctule::filters
