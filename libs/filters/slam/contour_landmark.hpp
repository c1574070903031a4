#pragma once
/// Walls, cylinders and points as landmarks of one particle: Kalman filters of their parameters, conditioned on the
/// particle's path, fed by single echoes. Errors of linearisation stay small because a wall's line is kept about an
/// anchor near the place it was first heard from.
#include <cstdint>
#include <limits>

#include "core/estimate.hpp"
#include "core/features.hpp"
#include "core/gaussian.hpp"
#include "core/state_archive.hpp"
#include "filters/noise/noise_residual.hpp"
#include "filters/slam/parameters.hpp"
#include "models/noise_mixture.hpp"

namespace noctule::filters {

/// One echo as a particle places it, map frame.
struct PlacedEcho {
  Vector2 sensor;                 ///< where it was heard [m]
  Vector2 axis;                   ///< direction of the cone's axis, unit vector
  double gate_cosine = 0.0;       ///< landmarks in directions farther from the axis cannot have made it
  double range = 0.0;             ///< [m]
  double range_variance = 0.0;    ///< [m^2]
  double bearing_variance = 0.0;  ///< of the true direction about the axis [rad^2]
  /// Squared normalised innovation beyond which no landmark, however certain, explains it better than clutter does.
  double gate2 = std::numeric_limits<double>::infinity();
  /// Of the range, in units of its nominal sd; none: Gaussian with the nominal variance.
  const models::NoiseMixture<1>* noise = nullptr;
};

/// What became of an echo that a landmark took in.
struct AssimilatedEcho {
  double nis = 0.0;           ///< squared normalised innovation under the nominal noise, 2 degrees of freedom
  NoiseResidual<1> residual;  ///< of the range, in units of its nominal sd; only where PlacedEcho::noise is given
  double noise = 1.0;         ///< variance of the range that the gain was made of, in units of the nominal one
};

/// Echo of a hypothesis with D parameters as a sensor should hear it, with derivatives by the parameters
/// (models/ultrasonic.hpp, with the direction as a unit vector).
template <int D>
struct PredictedEcho {
  double range;                ///< [m]
  Vector2 direction;           ///< unit vector
  VectorD<D> range_slope;      ///< d range / d parameters
  VectorD<D> direction_slope;  ///< d direction [rad] / d parameters
};

/// A wall (rho, theta) about `anchor`: rho is the signed distance from the anchor.
struct WallHypothesis {
  static constexpr int kSize = 2;
  Vector2 anchor = Vector2::Zero();  ///< map [m]
  Vector2 mean = Vector2::Zero();
  Matrix2 covariance = Matrix2::Zero();
  Vector2 normal = Vector2::UnitX();  ///< of the mean

  [[nodiscard]] bool in_view(const PlacedEcho& e) const {
    return normal.dot(e.axis) >= e.gate_cosine && mean[0] > normal.dot(e.sensor - anchor);
  }
  [[nodiscard]] PredictedEcho<2> predict(const Vector2& sensor) const {
    const Vector2 p = sensor - anchor;
    return {mean[0] - normal.dot(p), normal, {1.0, normal.y() * p.x() - normal.x() * p.y()}, {0.0, 1.0}};
  }
  void refresh() {
    mean[1] = wrap(mean[1]);
    normal << std::cos(mean[1]), std::sin(mean[1]);
  }
};

/// A cylinder (x, y, radius), map frame; a point is one whose radius is known to be 0.
struct CircleHypothesis {
  static constexpr int kSize = 3;
  Vector3 mean = Vector3::Zero();
  Matrix3 covariance = Matrix3::Zero();

  [[nodiscard]] bool in_view(const PlacedEcho& e) const {
    const Vector2 d = mean.head<2>() - e.sensor;
    const double length = d.norm();
    return d.dot(e.axis) >= e.gate_cosine * length && length > mean[2];
  }
  [[nodiscard]] PredictedEcho<3> predict(const Vector2& sensor) const {
    const Vector2 d = mean.head<2>() - sensor;
    const double scale = 1.0 / std::max(d.norm(), kNearest);
    const Vector2 u = scale * d;
    return {d.dot(u) - mean[2], u, {u.x(), u.y(), -1.0}, {-scale * u.y(), scale * u.x(), 0.0}};
  }
  void refresh() {}

 private:
  static constexpr double kNearest = 1e-6;  // [m]; a sensor on the centre hears no direction
};

/// A landmark heard by ultrasound. One or two hypotheses live side by side until the echoes have decided.
class ContourLandmark {
 public:
  /// \param feature of the extractor, in base_link
  /// \param base pose of the particle in the map
  /// \param stop number of the present stop
  /// The feature gives type and linearisation point only; the prior is as wide as the parameters say.
  ContourLandmark(const ContourFeature& feature, const Pose2& base, std::int64_t id, int stop,
                  const ContourLandmarkParameters& parameters);

  /// Log density of the echo's range and direction given everything this landmark has heard, per metre and radian;
  /// -inf when it is out of view, or so far off (PlacedEcho::gate2) that clutter explains the echo better. While the
  /// type is open, the mixture of both.
  [[nodiscard]] double log_likelihood(const PlacedEcho& echo) const {
    return in_view(echo) ? log_likelihood_in_view(echo) : -std::numeric_limits<double>::infinity();
  }

  /// Takes in an echo that this landmark explains better than clutter does. While the type is open, each hypothesis
  /// takes it unless clutter explains it better than that hypothesis, and the type is decided when it can be.
  /// \return of the better hypothesis
  AssimilatedEcho assimilate(const PlacedEcho& echo, double log_clutter, int stop,
                             const ContourLandmarkParameters& parameters);

  /// Whether an echo of this landmark is expected within `separation` [m] of the given one, in view.
  [[nodiscard]] bool expects_near(const PlacedEcho& echo, double separation) const;

  /// Old enough to be judged, and seen too rarely.
  [[nodiscard]] bool failed(int stop, const ContourLandmarkParameters& parameters) const;

  /// Map frame, walls with rho >= 0. A cylinder thinner than 4 cm is called a point; an undecided one is given as
  /// cylinder (x, y, radius).
  [[nodiscard]] LandmarkEstimate estimate() const;

  [[nodiscard]] LandmarkKind kind() const { return kind_; }

  /// f(hypothesis) of what the landmark is, or while that is open, of what is likelier.
  template <class F>
  decltype(auto) with_likelier(const F& f) const {
    const bool wall = kind_ == LandmarkKind::wall || (kind_ == LandmarkKind::undecided && log_ratio_ > 0.0);
    return wall ? f(wall_) : f(circle_);
  }

  /// To be read into.
  ContourLandmark() : id_(0), born_at_(0) {}
  void transfer(StateArchive& archive) {
    archive(id_, kind_, wall_.anchor, wall_.mean, wall_.covariance, wall_.normal, circle_.mean, circle_.covariance,
            log_ratio_, observations_, born_at_, seen_at_, stops_seen_);
  }

 private:
  /// Of any hypothesis.
  [[nodiscard]] bool in_view(const PlacedEcho& echo) const {
    if (kind_ == LandmarkKind::wall) return wall_.in_view(echo);
    return circle_.in_view(echo) || (kind_ == LandmarkKind::undecided && wall_.in_view(echo));
  }
  [[nodiscard]] double log_likelihood_in_view(const PlacedEcho& echo) const;

  std::int64_t id_;
  LandmarkKind kind_ = LandmarkKind::undecided;
  WallHypothesis wall_;
  CircleHypothesis circle_;
  double log_ratio_ = 0.0;  ///< log likelihood of the wall over that of the circle, of all echoes so far
  int observations_ = 0;
  int born_at_;
  int seen_at_ = -1;  ///< latest stop
  int stops_seen_ = 0;
};

}  // namespace noctule::filters
