#include "filters/slam/path_smoother.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/limits.hpp"
#include "core/log_weights.hpp"
#include "filters/slam/arrow_system.hpp"
#include "filters/slam/directions.hpp"

namespace noctule::filters {
/// One smoothing on its way.
class SmoothingProblem {
 public:
  SmoothingProblem(const PathSmoother& smoother, std::span<const Pose2> path, const LandmarkMap& map)
      : s_(smoother), state_{{path.begin(), path.end()}, landmarks_of(map)}, system_(path.size(), border_) {}

  SmoothedPath run() {
    SmoothedPath result;
    double cost = linearise(state_);
    double damping = 1e-4;
    while (result.iterations < s_.parameters_.max_iterations && !result.converged) {
      ++result.iterations;
      const State trial = moved(system_.solve(damping));
      const double trial_cost = cost_of(trial);
      if (trial_cost <= cost) {
        result.converged = cost - trial_cost <= s_.parameters_.tolerance;
        state_ = trial;
        cost = linearise(state_);
        damping = std::max(damping / 10.0, 1e-9);
      } else {
        result.converged = damping > 1e6;  // no step improves it
        damping *= 10.0;
      }
    }
    const ArrowSystem::Covariance covariance = system_.covariance();
    result.poses = state_.poses;
    result.covariances = covariance.poses;
    for (const Landmark& l : state_.landmarks) result.map.landmarks.push_back(estimate_of(l, covariance.border));
    return result;
  }

 private:
  /// A wall (rho, theta) about the origin, or a circle (x, y, radius), map frame.
  struct Landmark {
    LandmarkEstimate filtered;  ///< what the filter said
    bool wall;
    Vector3 mean, prior, prior_precision;
    Eigen::Index column;  ///< of its first parameter in the border
    Vector2 normal;       ///< of a wall
    int echoes = 0;

    [[nodiscard]] Eigen::Index size() const { return wall ? 2 : 3; }
    void refresh() {
      if (wall) normal << std::cos(mean[1]), std::sin(mean[1]);
    }
  };

  /// Prediction of an echo with what is needed for its Jacobians.
  struct Prediction {
    double range;
    Vector2 direction;
    double distance;  ///< to a circle's centre; walls: infinite
  };

  static Prediction echo_of(const Landmark& l, const Vector2& sensor) {
    if (l.wall) return {l.mean[0] - l.normal.dot(sensor), l.normal, kInf};
    const Vector2 d = l.mean.head<2>() - sensor;
    const double distance = std::max(d.norm(), 1e-6);
    return {distance - l.mean[2], d / distance, distance};
  }

  struct State {
    std::vector<Pose2> poses;
    std::vector<Landmark> landmarks;
  };

  std::vector<Landmark> landmarks_of(const LandmarkMap& map) {
    std::vector<Landmark> result;
    border_ = 0;
    for (const LandmarkEstimate& e : map.landmarks) {
      if (e.kind == LandmarkKind::undecided) continue;
      Landmark l{.filtered = e,
                 .wall = e.kind == LandmarkKind::wall,
                 .mean = e.parameters,
                 .prior = e.parameters,
                 // Of a landmark that no echo determines any more.
                 .prior_precision = Vector3::Constant(1.0 / (kWidePrior * kWidePrior)),
                 .column = border_,
                 .normal = Vector2::UnitX()};
      if (e.kind == LandmarkKind::point) l.prior_precision[2] = 1.0 / (s_.point_radius_sd_ * s_.point_radius_sd_);
      l.refresh();
      border_ += l.size();
      result.push_back(l);
    }
    return result;
  }

  [[nodiscard]] State moved(const ArrowSystem::Step& step) const {
    State next = state_;
    for (std::size_t k = 0; k < next.poses.size(); ++k) {
      const Vector3 d = step.poses.segment<3>(3 * static_cast<Eigen::Index>(k));
      Pose2& p = next.poses[k];
      p = {p.x + d[0], p.y + d[1], wrap(p.yaw + d[2])};
    }
    for (Landmark& l : next.landmarks) {
      l.mean.head(l.size()) += step.border.segment(l.column, l.size());
      l.refresh();
    }
    return next;
  }

  double cost_of(State state) {
    return evaluate(
        state, [](auto&&...) {}, [](auto&&...) {}, [](auto&&...) {});
  }

  /// Negative log likelihood up to a constant.
  template <class OnMotion, class OnEcho, class OnPrior>
  double evaluate(State& state, OnMotion on_motion, OnEcho on_echo, OnPrior on_prior) const {
    double cost = 0.0;
    std::size_t begin = 0;
    for (std::size_t k = 0; k < state.poses.size(); ++k) {
      const PathSmoother::Node& node = s_.nodes_[k];
      const Pose2& from = k > 0 ? state.poses[k - 1] : s_.start_;
      const Vector3 error = difference(between(from, state.poses[k]), node.increment);
      cost += 0.5 * error.dot(node.information * error);
      on_motion(k, from, error, node);
      const double c = std::cos(state.poses[k].yaw), s = std::sin(state.poses[k].yaw);
      Matrix2 rotation;
      rotation << c, -s, s, c;
      for (std::size_t i = begin; i < node.echoes_end; ++i) {
        cost += judge(state, k, rotation, s_.echoes_[i], node, on_echo);
      }
      begin = node.echoes_end;
    }
    for (const Landmark& l : state.landmarks) {
      const Vector3 d = l.mean - l.prior;
      cost += 0.5 * d.head(l.size()).cwiseAbs2().dot(l.prior_precision.head(l.size()));
      on_prior(l, d);
    }
    return cost;
  }

  template <class OnEcho>
  double judge(State& state, std::size_t k, const Matrix2& rotation, const PathSmoother::SensedEcho& echo,
               const PathSmoother::Node& node, OnEcho on_echo) const {
    const Vector2 lever = rotation * echo.sensor, sensor = state.poses[k].position() + lever,
                  axis = rotation * echo.axis;
    const models::NoiseMixture<1>& noise = s_.noises_[node.noise];
    const double gate_cosine = std::cos(std::min(4.0 * node.bearing_sd, kPi));
    const double log_top = -std::log(echo.sd * node.bearing_sd * std::sqrt(kTwoPi));
    const double log_clutter = s_.echo_.log_clutter();
    Landmark* best = nullptr;
    double log_best = log_clutter - 10.0;  // what is left out changes the likelihood by less than 1e-4
    Prediction predicted{};
    for (Landmark& l : state.landmarks) {
      const Prediction p = echo_of(l, sensor);
      if (p.direction.dot(axis) < gate_cosine || p.range <= 0.0) continue;
      const double e = (echo.range - p.range) / echo.sd;
      if (std::abs(e) > 200.0) continue;
      const double bearing = angle_between(p.direction, axis) / node.bearing_sd;
      const double log_density = noise.log_density(VectorD<1>(e)) - 0.5 * bearing * bearing + log_top;
      if (log_density <= log_best) continue;
      log_best = log_density;
      best = &l;
      predicted = p;
    }
    if (best == nullptr) return -log_clutter;
    const double log_sum = log_add_exp(log_best, log_clutter);
    on_echo(k, *best, predicted, axis, lever, echo, node, std::exp(log_best - log_sum));
    return -log_sum;
  }

  /// Fills the system at `state`. \return the cost
  double linearise(State& state) {
    system_.set_zero();
    for (Landmark& l : state.landmarks) l.echoes = 0;
    return evaluate(
        state,
        [&](std::size_t k, const Pose2& from, const Vector3& error, const PathSmoother::Node& node) {
          add_motion(k, from, state.poses[k], error, node.information);
        },
        [&](std::size_t k, Landmark& l, const Prediction& p, const Vector2& axis, const Vector2& lever,
            const PathSmoother::SensedEcho& echo, const PathSmoother::Node& node,
            double probability) { add_echo(k, l, p, axis, lever, echo, node, probability); },
        [&](const Landmark& l, const Vector3& d) {
          for (Eigen::Index i = 0; i < l.size(); ++i) {
            system_.corner()(l.column + i, l.column + i) += l.prior_precision[i];
            system_.corner_gradient()[l.column + i] += l.prior_precision[i] * d[i];
          }
        });
  }

  void add_motion(std::size_t k, const Pose2& from, const Pose2& to, const Vector3& error, const Matrix3& information) {
    const double c = std::cos(from.yaw), s = std::sin(from.yaw);
    const Vector2 d = to.position() - from.position();
    Matrix3 by_from, by_to;
    by_to << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
    by_from = -by_to;
    by_from.topRightCorner<2, 1>() << -s * d.x() + c * d.y(), -c * d.x() - s * d.y();
    const Matrix3 weighted = by_to.transpose() * information;
    system_.diagonal(k) += weighted * by_to;
    system_.gradient(k) += weighted * error;
    if (k == 0) return;  // the start is known
    system_.diagonal(k - 1) += by_from.transpose() * information * by_from;
    system_.gradient(k - 1) += by_from.transpose() * information * error;
    system_.coupling(k - 1) += by_from.transpose() * information * by_to;
  }

  /// Range and direction of an echo; `probability` that it is no clutter.
  void add_echo(std::size_t k, Landmark& l, const Prediction& p, const Vector2& axis, const Vector2& lever,
                const PathSmoother::SensedEcho& echo, const PathSmoother::Node& node, double probability) {
    ++l.echoes;
    const Vector2& u = p.direction;
    const auto noise = s_.noises_[node.noise].reweighted(VectorD<1>((echo.range - p.range) / echo.sd));
    const double range_error = p.range - echo.range + noise.bias[0] * echo.sd;
    const Vector2 turned(-lever.y(), lever.x());
    // Range: predicted - heard. Turning the base moves the sensor by `turned`.
    Vector3 by_pose(-u.x(), -u.y(), -u.dot(turned)), by_landmark;
    if (l.wall) {
      const Vector2 sensor = state_.poses[k].position() + lever;
      by_landmark << 1.0, l.normal.y() * sensor.x() - l.normal.x() * sensor.y(), 0.0;
    } else {
      by_landmark << u.x(), u.y(), -1.0;
    }
    accumulate(k, l, by_pose, by_landmark, range_error, probability / (noise.covariance(0, 0) * echo.sd * echo.sd));
    // Direction: predicted - axis.
    const double direction_error = -angle_between(u, axis);
    if (l.wall) {
      by_pose << 0.0, 0.0, -1.0;
      by_landmark << 0.0, 1.0, 0.0;
    } else {
      const Vector2 across(-u.y() / p.distance, u.x() / p.distance);  // d direction / d centre
      by_pose << -across.x(), -across.y(), -across.dot(turned) - 1.0;
      by_landmark << across.x(), across.y(), 0.0;
    }
    accumulate(k, l, by_pose, by_landmark, direction_error, probability / (node.bearing_sd * node.bearing_sd));
  }

  void accumulate(std::size_t k, const Landmark& l, const Vector3& by_pose, const Vector3& by_landmark, double error,
                  double precision) {
    system_.diagonal(k) += precision * by_pose * by_pose.transpose();
    system_.gradient(k) += precision * error * by_pose;
    const Eigen::Index n = l.size();
    system_.border(k).middleCols(l.column, n) += precision * by_pose * by_landmark.head(n).transpose();
    system_.corner().block(l.column, l.column, n, n) +=
        precision * by_landmark.head(n) * by_landmark.head(n).transpose();
    system_.corner_gradient().segment(l.column, n) += precision * error * by_landmark.head(n);
  }

  [[nodiscard]] LandmarkEstimate estimate_of(const Landmark& l, const Eigen::MatrixXd& covariance) const {
    LandmarkEstimate e = l.filtered;
    e.observations = l.echoes;
    e.covariance.setZero();
    e.covariance.topLeftCorner(l.size(), l.size()) = covariance.block(l.column, l.column, l.size(), l.size());
    e.parameters = l.mean;
    if (l.wall) {
      Wall w{l.mean[0], l.mean[1]};
      if (w.rho < 0.0) {
        e.covariance.row(0) *= -1.0;
        e.covariance.col(0) *= -1.0;
      }
      w = normalised(w);
      e.parameters << w.rho, w.theta, 0.0;
    } else if (e.kind == LandmarkKind::point) {
      e.parameters[2] = 0.0;
      e.covariance.row(2).setZero();
      e.covariance.col(2).setZero();
    } else {
      e.parameters[2] = std::max(e.parameters[2], 0.0);
    }
    return e;
  }

  static constexpr double kWidePrior = 10.0;  // [m] or [rad]

  const PathSmoother& s_;
  Eigen::Index border_ = 0;
  State state_;
  ArrowSystem system_;
};

PathSmoother::PathSmoother(const PathSmootherParameters& smoother, const EchoParameters& echo, double point_radius_sd,
                           const Pose2& start)
    : parameters_(smoother), echo_(echo), point_radius_sd_(point_radius_sd), start_(start) {}

void PathSmoother::transfer(StateArchive& archive) {
  archive.each(nodes_, Node{},
               [&](Node& n) { archive(n.increment, n.information, n.echoes_end, n.noise, n.bearing_sd); });
  archive.each(echoes_, SensedEcho{}, [&](SensedEcho& e) { archive(e.sensor, e.axis, e.range, e.sd); });
  archive.each(noises_, models::NoiseMixture<1>{}, [&](models::NoiseMixture<1>& n) { archive(n); });
}

void PathSmoother::add_node(const PoseGaussian& motion) {
  // Odometry made from two controls has a covariance of rank 2, and a robot at rest none at all.
  Matrix3 covariance = motion.covariance;
  const double position = parameters_.position_floor, heading = parameters_.heading_floor;
  covariance.diagonal() += Vector3(position * position, position * position, heading * heading);
  nodes_.push_back({.increment = motion.mean,
                    .information = covariance.inverse(),
                    .echoes_end = echoes_.size(),
                    .noise = 0,
                    .bearing_sd = 1.0});
}

void PathSmoother::add(const UltrasonicScan& scan, const models::NoiseMixture<1>& noise) {
  for (const UltrasonicBeam& beam : scan.beams) {
    if (beam.echo != Echo::hit) continue;
    const Pose2& sensor = beam.sensor_in_base;
    echoes_.push_back({.sensor = sensor.position(),
                       .axis = {std::cos(sensor.yaw), std::sin(sensor.yaw)},
                       .range = beam.range,
                       .sd = echo_.range_noise.sd(beam.range)});
  }
  Node& node = nodes_.back();
  node.echoes_end = echoes_.size();
  node.noise = noises_.size();
  node.bearing_sd = echo_.bearing_sd_per_half_angle * scan.half_angle;
  noises_.push_back(noise);
}

SmoothedPath PathSmoother::smooth(std::span<const Pose2> path, const LandmarkMap& map) const {
  if (path.size() != nodes_.size()) throw std::logic_error("a path to smooth needs a pose per observation");
  if (path.empty()) return {};
  SmoothedPath result = SmoothingProblem(*this, path, map).run();
  result.map.stamp = map.stamp;
  return result;
}

}  // namespace noctule::filters
