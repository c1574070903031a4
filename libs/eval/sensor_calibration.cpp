#include "eval/sensor_calibration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "core/limits.hpp"
#include "eval/statistics.hpp"

namespace noctule::eval {
namespace {

constexpr int kPasses = 5;  // of estimates by the noise, and of the noise by what they leave

/// Equations y = A x + e.
struct Fit {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
  std::vector<bool> used;
  Eigen::VectorXd residuals;  ///< of all equations
};

Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& y, const std::vector<bool>& used,
                      Eigen::MatrixXd& inverse) {
  const Eigen::Index n = a.cols();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    if (!used[static_cast<std::size_t>(i)]) continue;
    normal += a.row(i).transpose() * a.row(i);
    right += a.row(i).transpose() * y[i];
  }
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(normal);
  const bool sound = ldlt.info() == Eigen::Success && ldlt.vectorD().minCoeff() > 0.0;
  inverse =
      sound ? Eigen::MatrixXd(ldlt.solve(Eigen::MatrixXd::Identity(n, n))) : Eigen::MatrixXd::Constant(n, n, kNan);
  return inverse * right;
}

/// Robust standard deviation about 0: 1.4826 times the median of the absolute values.
double robust_sd(const Eigen::VectorXd& residuals) {
  const Eigen::VectorXd absolute = residuals.cwiseAbs();
  return 1.4826 * quantile({absolute.data(), static_cast<std::size_t>(absolute.size())}, 0.5);
}

/// Least squares in units of the standard deviations `sd`, and twice more without the residuals above `outlier` robust
/// standard deviations.
Fit fit(const Eigen::MatrixXd& unscaled_a, const Eigen::VectorXd& unscaled_y, const Eigen::VectorXd& sd,
        double outlier) {
  const Eigen::MatrixXd a = sd.cwiseInverse().asDiagonal() * unscaled_a;
  const Eigen::VectorXd y = unscaled_y.cwiseQuotient(sd);
  Fit f{Eigen::VectorXd::Constant(a.cols(), kNan), Eigen::MatrixXd::Constant(a.cols(), a.cols(), kNan),
        std::vector<bool>(static_cast<std::size_t>(a.rows()), true), Eigen::VectorXd::Zero(a.rows())};
  if (a.rows() <= a.cols()) return f;
  Eigen::MatrixXd inverse;
  for (int pass = 0; pass < 3; ++pass) {
    f.x = solve(a, y, f.used, inverse);
    f.residuals = y - a * f.x;
    if (!f.residuals.allFinite() || pass == 2) break;
    const double limit = outlier * robust_sd(f.residuals);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      f.used[static_cast<std::size_t>(i)] = std::abs(f.residuals[i]) <= limit || limit == 0.0;
    }
  }
  double square = 0.0;
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    if (!f.used[static_cast<std::size_t>(i)]) continue;
    square += f.residuals[i] * f.residuals[i];
    ++count;
  }
  f.covariance = square / static_cast<double>(std::max<Eigen::Index>(1, count - a.cols())) * inverse;
  f.residuals = f.residuals.cwiseProduct(sd);
  return f;
}

Estimated estimated(const Fit& f, Eigen::Index i) {
  return {f.x[i], std::sqrt(f.covariance(i, i))};
}

/// Non-negative coefficients of y = x0 a0 + x1 a1, least squares in units of `sd`.
Vector2 fit_positive(const Eigen::MatrixXd& unscaled_a, const Eigen::VectorXd& unscaled_y, const Eigen::VectorXd& sd,
                     const std::vector<bool>& used) {
  const Eigen::MatrixXd a = sd.cwiseInverse().asDiagonal() * unscaled_a;
  const Eigen::VectorXd y = unscaled_y.cwiseQuotient(sd);
  Eigen::MatrixXd inverse;
  const Eigen::VectorXd x = solve(a, y, used, inverse);
  if (x.allFinite() && x.minCoeff() >= 0.0) return x;
  Vector2 best = Vector2::Zero();
  double least = kInf;
  for (int c = 0; c < 2; ++c) {  // on the boundary
    Vector2 candidate = Vector2::Zero();
    candidate[c] = std::max(0.0, solve(a.col(c), y, used, inverse)[0]);
    double cost = 0.0;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      if (used[static_cast<std::size_t>(i)]) cost += std::pow(y[i] - a.row(i).dot(candidate), 2.0);
    }
    if (cost < least) {
      least = cost;
      best = candidate;
    }
  }
  return best;
}

/// One window of motion.
struct MotionWindow {
  Vector2 way = Vector2::Zero();    ///< odometry's steps, each along the true heading
  Vector2 truth = Vector2::Zero();  ///< true displacement
  double length = 0.0;              ///< by odometry
  double turns = 0.0;               ///< the sum of their absolute values
  double turn = 0.0;                ///< by odometry
  double true_turn = 0.0;
};

std::vector<TimedPose> truth_of(std::span<const Observation> observations) {
  std::vector<TimedPose> truth;
  for (const Observation& o : observations) {
    if (const auto* g = std::get_if<GroundTruth>(&o)) truth.push_back({g->stamp.utime, g->base_in_map});
  }
  return truth;
}

std::vector<MotionWindow> windows_of(std::span<const Observation> observations, std::span<const TimedPose> truth,
                                     const SensorCalibrationParameters& p) {
  std::vector<MotionWindow> windows;
  MotionWindow now;
  std::optional<Pose2> begin, before;  // true poses
  std::int64_t begin_utime = 0;
  for (const Observation& observation : observations) {
    const auto* o = std::get_if<Odometry>(&observation);
    if (o == nullptr) continue;
    const auto pose = interpolate(truth, o->stamp.utime, p.max_gap);
    if (pose && before) {
      const double middle = before->yaw + 0.5 * wrap(pose->yaw - before->yaw), chord = o->increment.yaw * 0.5;
      // The step as seen in the middle of its turn: its own frame is half the turn behind.
      const Vector2 step = Pose2{0.0, 0.0, middle - chord} * o->increment.position();
      now.way += step;
      now.length += step.norm();
      now.turn += o->increment.yaw;
      now.turns += std::abs(o->increment.yaw);
      now.true_turn += wrap(pose->yaw - before->yaw);
      if (seconds(o->stamp.utime - begin_utime) >= p.window) {
        now.truth = pose->position() - begin->position();
        windows.push_back(now);
        begin.reset();
      }
    } else {
      begin.reset();
    }
    before = pose;
    if (!begin && pose) {
      begin = pose;
      begin_utime = o->stamp.utime;
      now = {};
    }
  }
  return windows;
}

/// Standard deviations by a model of two coefficients, none much below the others'.
Eigen::VectorXd stated_sds(const Eigen::VectorXd& sd) {
  const double mean = sd.size() > 0 ? sd.mean() : 1.0;
  return mean > 0.0 ? Eigen::VectorXd(sd.cwiseMax(0.05 * mean)) : Eigen::VectorXd(Eigen::VectorXd::Ones(sd.size()));
}

void calibrate_motion(const std::vector<MotionWindow>& windows, double outlier, SensorCalibration& c) {
  const auto n = static_cast<Eigen::Index>(windows.size());
  Eigen::MatrixXd way(n, 1), turn(n, 1), sizes(n, 2);
  Eigen::VectorXd along(n), true_turn(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const MotionWindow& w = windows[static_cast<std::size_t>(i)];
    const double length = w.way.norm();
    way(i, 0) = length;
    along[i] = length > 0.0 ? w.truth.dot(w.way) / length : 0.0;
    turn(i, 0) = w.turn;
    true_turn[i] = w.true_turn;
    sizes.row(i) << w.length, w.turns;
  }
  const Fit distances = fit(way, along, stated_sds(sizes.col(0).cwiseSqrt()), outlier);
  Fit turns = fit(turn, true_turn, Eigen::VectorXd::Ones(n), outlier);
  Vector2 heading(kNan, kNan);
  Eigen::VectorXd variances = Eigen::VectorXd::Ones(n);  // to which the sd of a square is proportional
  for (int pass = 0; pass < kPasses && n > 0; ++pass) {
    heading = fit_positive(sizes, turns.residuals.cwiseAbs2(), variances, turns.used);
    const Eigen::VectorXd sds = stated_sds((sizes * heading).cwiseSqrt());
    variances = sds.cwiseAbs2();
    turns = fit(turn, true_turn, sds, outlier);
  }
  c.distance_scale = estimated(distances, 0);
  c.turn_scale = estimated(turns, 0);
  c.windows = static_cast<int>(std::ranges::count(distances.used, true));
  c.outliers += static_cast<int>(windows.size()) - c.windows;
  Eigen::MatrixXd inverse;
  const double variance =
      n > 0 ? solve(sizes.col(0), distances.residuals.cwiseAbs2(), distances.used, inverse)[0] : kNan;
  c.along = std::isfinite(variance) ? std::sqrt(std::max(0.0, variance)) : kNan;
  c.drift = std::sqrt(heading[0]);
  c.turn = std::sqrt(heading[1]);
}

/// Sightings of known landmarks.
struct Sightings {
  std::vector<double> true_range, range, bearing_error;
};

void add_sightings(std::span<const Observation> observations, std::span<const TimedPose> truth,
                   std::span<const KnownLandmark> landmarks, double max_gap, Sightings& s) {
  for (const Observation& observation : observations) {
    const auto* message = std::get_if<LandmarkDetections>(&observation);
    if (message == nullptr) continue;
    const auto base = interpolate(truth, message->stamp.utime, max_gap);
    if (!base) continue;
    const Pose2 sensor = *base * message->sensor_in_base;
    for (const LandmarkDetection& d : message->detections) {
      const auto landmark = std::ranges::find(landmarks, d.id, &KnownLandmark::id);
      if (landmark == landmarks.end() || d.kind != DetectionKind::range_bearing) continue;
      const Vector2 v = landmark->position - sensor.position();
      s.true_range.push_back(v.norm());
      s.range.push_back(d.range);
      s.bearing_error.push_back(wrap(d.bearing - wrap(std::atan2(v.y(), v.x()) - sensor.yaw)));
    }
  }
}

void calibrate_sightings(const Sightings& sightings, double outlier, SensorCalibration& c) {
  const auto n = static_cast<Eigen::Index>(sightings.range.size());
  const Eigen::Map<const Eigen::VectorXd> r(sightings.true_range.data(), n), z(sightings.range.data(), n),
      b(sightings.bearing_error.data(), n);
  Eigen::MatrixXd a(n, 2);
  a << r, Eigen::VectorXd::Ones(n);
  const Fit bearings = fit(Eigen::MatrixXd::Ones(n, 1), b, Eigen::VectorXd::Ones(n), outlier);
  Fit ranges = fit(a, z, Eigen::VectorXd::Ones(n), outlier);
  Vector2 sd(kNan, kNan);
  // The mean absolute value of a normal number is sqrt(2 / pi) of its standard deviation.
  Eigen::VectorXd sds = Eigen::VectorXd::Ones(n);
  for (int pass = 0; pass < kPasses && n > 0; ++pass) {
    sd = fit_positive(a, std::sqrt(0.5 * kPi) * ranges.residuals.cwiseAbs(), sds, ranges.used);
    sds = stated_sds(a * sd);
    ranges = fit(a, z, sds, outlier);
  }
  c.range_scale = estimated(ranges, 0);
  c.range_bias = estimated(ranges, 1);
  c.range_correlation = ranges.covariance(0, 1) / (c.range_scale.sd * c.range_bias.sd);
  c.bearing_bias = estimated(bearings, 0);
  c.sightings = static_cast<int>(std::ranges::count(ranges.used, true));
  c.outliers += static_cast<int>(n) - c.sightings;
  c.range_relative = sd[0];
  c.range_base = sd[1];
  const auto used = std::ranges::count(bearings.used, true);
  c.bearing_sd = bearings.covariance.allFinite() ? c.bearing_bias.sd * std::sqrt(static_cast<double>(used)) : kNan;
}

}  // namespace

SensorCalibration calibrate_sensors(std::span<const std::vector<Observation>> runs,
                                    std::span<const KnownLandmark> landmarks, const SensorCalibrationParameters& p) {
  if (!(p.window > 0.0 && p.max_gap > 0.0 && p.outlier > 0.0)) {
    throw std::invalid_argument("calibrate_sensors: parameters must be positive");
  }
  std::vector<MotionWindow> windows;
  Sightings sightings;
  for (const std::vector<Observation>& run : runs) {
    const std::vector<TimedPose> truth = truth_of(run);
    std::ranges::copy(windows_of(run, truth, p), std::back_inserter(windows));
    add_sightings(run, truth, landmarks, p.max_gap, sightings);
  }
  SensorCalibration c;
  calibrate_motion(windows, p.outlier, c);
  calibrate_sightings(sightings, p.outlier, c);
  return c;
}

}  // namespace noctule::eval
