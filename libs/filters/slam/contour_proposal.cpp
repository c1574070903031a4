#include <algorithm>
#include <cmath>

#include "core/limits.hpp"
#include "filters/slam/contour_observation.hpp"
#include "filters/slam/directions.hpp"

namespace noctule::filters {
namespace {

/// An echo as seen from a whitened motion: predicted range of a hypothesis, and how it changes with the motion.
template <class Hypothesis>
struct EchoOfMotion {
  EchoOfMotion(const Hypothesis& h, const PlacedEcho& e, const Vector2& lever, const Matrix2& frame_before,
               const Matrix3& root)
      : predicted(h.predict(e.sensor)), innovation(e.range - predicted.range) {
    // The sensor moves with the base and turns about it; the range shrinks by what it moves toward the surface.
    const Vector2 n = predicted.direction, swing(-lever.y(), lever.x());
    Vector3 by_increment;
    by_increment << -(frame_before.transpose() * n), -n.dot(swing);
    by_motion = root.transpose() * by_increment;
  }
  PredictedEcho<Hypothesis::kSize> predicted;
  double innovation;  // [m]
  Vector3 by_motion;  // [m]
};

/// What is believed of the noise of a range, given its innovation and the variance it has without noise.
models::NoiseMixture<1>::Effective noise_of(const PlacedEcho& e, double innovation, double variance) {
  VectorD<1> v;
  MatrixD<1> extra;
  const double sd = std::sqrt(e.range_variance);
  v[0] = innovation / sd;
  extra(0, 0) = variance / e.range_variance;
  models::NoiseMixture<1>::Effective noise = e.noise->effective(v, extra);
  noise.bias *= sd;
  noise.covariance *= e.range_variance;
  return noise;
}

double log_density_of_range(const PlacedEcho& e, double innovation, double variance) {
  if (e.noise == nullptr) return log_gaussian(innovation, variance + e.range_variance);
  VectorD<1> v;
  MatrixD<1> extra;
  v[0] = innovation / std::sqrt(e.range_variance);
  extra(0, 0) = variance / e.range_variance;
  return e.noise->log_density(v, extra) - 0.5 * std::log(e.range_variance);
}

}  // namespace

DrawnPose ContourObservation::draw_pose(const Pose2& before, const WhitenedMotion& motion,
                                        const std::vector<ContourLandmark>& map, std::vector<std::int32_t>& assigned,
                                        Rng rng) const {
  const Frame start(before);
  Vector3 mean = Vector3::Zero();
  Matrix3 covariance = Matrix3::Identity();

  // Which landmark each echo is of, as the mean of the motion has it.
  assigned.assign(pings_.size(), -1);
  const Frame expected(motion.moved(before, mean));
  const double heading_variance = motion.root.row(2).squaredNorm();
  for (std::size_t i = 0; i < pings_.size(); ++i) {
    const PlacedEcho echo = place(expected, pings_[i]);
    const Vector2 lever = echo.sensor - expected.base.position();
    double best = log_clutter_;
    for (std::size_t k = 0; k < map.size(); ++k) {
      const double candidate = map[k].with_likelier([&](const auto& h) {
        if (!h.in_view(echo)) return -kInf;
        const EchoOfMotion e(h, echo, lever, start.rotation, motion.root);
        const double variance =
            e.by_motion.squaredNorm() + e.predicted.range_slope.dot(h.covariance * e.predicted.range_slope);
        return log_density_of_range(echo, e.innovation, variance) +
               log_gaussian(angle_between(e.predicted.direction, echo.axis), bearing_variance_ + heading_variance);
      });
      if (candidate <= best) continue;
      best = candidate;
      assigned[i] = static_cast<std::int32_t>(k);
    }
  }

  for (std::size_t k = 0; k < map.size(); ++k) {
    if (std::ranges::find(assigned, static_cast<std::int32_t>(k)) == assigned.end()) continue;
    map[k].with_likelier([&]<class Hypothesis>(Hypothesis h) {
      // Motion and landmark together: the landmark's error is common to all its echoes.
      constexpr int kSize = 3 + Hypothesis::kSize;
      MatrixD<kSize> joint = MatrixD<kSize>::Zero();
      joint.template topLeftCorner<3, 3>() = covariance;
      joint.template bottomRightCorner<Hypothesis::kSize, Hypothesis::kSize>() = h.covariance;
      for (std::size_t i = 0; i < pings_.size(); ++i) {
        if (assigned[i] != static_cast<std::int32_t>(k)) continue;
        const Frame frame(motion.moved(before, mean));
        const PlacedEcho echo = place(frame, pings_[i]);
        const EchoOfMotion e(h, echo, echo.sensor - frame.base.position(), start.rotation, motion.root);
        VectorD<kSize> slope;
        slope << e.by_motion, e.predicted.range_slope;
        const VectorD<kSize> cross = joint * slope;
        double innovation = e.innovation, variance = slope.dot(cross), noise = echo.range_variance;
        if (echo.noise != nullptr) {
          const auto effective = noise_of(echo, innovation, variance);
          innovation -= effective.bias[0];
          noise = effective.covariance(0, 0);
        }
        variance += noise;
        const VectorD<kSize> gain = cross / variance;
        mean += innovation * gain.template head<3>();
        h.mean += innovation * gain.template tail<Hypothesis::kSize>();
        h.refresh();
        joint -= gain * cross.transpose();
        symmetrise(joint);
      }
      covariance = joint.template topLeftCorner<3, 3>();
    });
  }

  const auto llt = cholesky<3>(covariance);
  const Vector3 n(rng.normal(), rng.normal(), rng.normal());
  const Vector3 u = mean + llt.matrixL() * n;
  const double log_determinant = llt.matrixLLT().diagonal().array().log().sum();
  return {motion.moved(before, u), 0.5 * (n.squaredNorm() - u.squaredNorm()) + log_determinant};
}

}  // namespace noctule::filters
