#include "sensors/camera/target_motion.hpp"

#include <cmath>

#include "core/unscented.hpp"

namespace noctule::sensors {
namespace {

TargetMeasurement measured(const TargetState& state, double width_at_1) {
  return {state[0], state[1], width_at_1 * std::exp(state[4])};
}

MatrixD<3> noise_of(const TargetMeasurement& sd) {
  return sd.cwiseAbs2().asDiagonal();
}

}  // namespace

TargetState TargetMotion::predict(const TargetState& s) const {
  return {s[0] + s[2], s[1] + s[3], damping * s[2], damping * s[3], s[4]};
}

TargetState TargetMotion::noise_sd() const {
  return {place_sd, place_sd, speed_sd, speed_sd, scale_sd};
}

TargetState TargetMotion::draw(const TargetState& before, Rng& rng) const {
  TargetState state = predict(before);
  const TargetState sd = noise_sd();
  for (int k = 0; k < 5; ++k) state[k] += sd[k] * rng.normal();
  return state;
}

double TargetMotion::log_density(const TargetState& state, const TargetState& before) const {
  const TargetState error = state - predict(before), sd = noise_sd();
  double sum = 0.0;
  for (int k = 0; k < 5; ++k) sum += log_gaussian(error[k], sd[k] * sd[k]);
  return sum;
}

TargetGaussian extended_update(const TargetMotion& motion, const TargetState& before, double width_at_1,
                               const TargetMeasurement& measurement, const TargetMeasurement& sd) {
  TargetGaussian g{motion.predict(before), motion.noise_sd().cwiseAbs2().asDiagonal()};
  const TargetMeasurement expected = measured(g.mean, width_at_1);
  Eigen::Matrix<double, 3, 5> h = Eigen::Matrix<double, 3, 5>::Zero();
  h(0, 0) = h(1, 1) = 1.0;
  h(2, 4) = expected[2];
  joseph_update<5, 3>(g.mean, g.covariance, measurement - expected, h, noise_of(sd));
  return g;
}

TargetGaussian unscented_update(const TargetMotion& motion, const TargetState& before, double width_at_1,
                                const TargetMeasurement& measurement, const TargetMeasurement& sd) {
  const UnscentedWeights w(5, {});
  const MatrixD<5> root = motion.noise_sd().asDiagonal();
  const auto points = sigma_points<5>(motion.predict(before), root, w.spread);
  std::array<TargetMeasurement, 11> images;
  for (std::size_t i = 0; i < points.size(); ++i) images[i] = measured(points[i], width_at_1);
  TargetMeasurement mean;
  MatrixD<3> s;
  unscented_moments<3>(images, w, mean, s);
  s += noise_of(sd);
  Eigen::Matrix<double, 5, 3> cross = Eigen::Matrix<double, 5, 3>::Zero();  // the centre is the mean
  for (std::size_t i = 1; i < points.size(); ++i)
    cross += w.other * (points[i] - points[0]) * (images[i] - mean).transpose();
  const Eigen::Matrix<double, 5, 3> gain = cholesky<3>(s).solve(cross.transpose()).transpose();
  TargetGaussian g{points[0] + gain * (measurement - mean), root * root - gain * s * gain.transpose()};
  symmetrise(g.covariance);
  return g;
}

}  // namespace noctule::sensors
