#include "smoothing/fix_smoother.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/limits.hpp"
#include "smoothing/kalman.hpp"

namespace noctule::smoothing {
namespace {

constexpr int kIterations = 40;
constexpr double kStill = 1e-6;  // [m, rad]

using State = Gaussian<3>;

/// One pass, linearised about a path, or where that is empty about the estimates so far. Headings are not wrapped, so
/// that they can be averaged.
std::vector<State> pass(const State& start, std::span<const PoseGaussian> motions,
                        std::span<const std::optional<Vector2>> fixes, const Matrix2& r,
                        const std::vector<Vector3>& path) {
  const Eigen::Matrix<double, 2, 3> h = Eigen::Matrix<double, 2, 3>::Identity();
  KalmanSmoother<3> smoother(start);
  for (std::size_t k = 0; k < fixes.size(); ++k) {
    if (k > 0) {
      const Vector3 about = path.empty() ? smoother.estimate().mean : path[k - 1];
      const Pose2 at{about.x(), about.y(), about.z()};
      const PoseGaussian& motion = motions[k - 1];
      const Pose2 moved = at * motion.mean;
      const Matrix3 f = compose_jacobian_left(at, motion.mean), g = compose_jacobian_right(at);
      const Vector3 to(moved.x, moved.y, at.yaw + motion.mean.yaw);
      smoother.predict(f, g * motion.covariance * g.transpose(), to - f * about);
    }
    if (fixes[k]) smoother.update<2>(*fixes[k], h, r);
  }
  return smoother.smoothed();
}

}  // namespace

std::vector<PoseGaussian> smooth_fixes(const PoseGaussian& start, std::span<const PoseGaussian> motions,
                                       std::span<const std::optional<Vector2>> fixes, const Matrix2& fix_covariance) {
  if (motions.size() + 1 != fixes.size()) {
    throw std::invalid_argument("smooth_fixes: expected one motion fewer than times, got " +
                                std::to_string(motions.size()) + " and " + std::to_string(fixes.size()));
  }
  std::vector<Vector3> path;
  std::vector<State> states;
  for (int i = 0; i < kIterations; ++i) {
    states = pass({start.mean.vector(), start.covariance}, motions, fixes, fix_covariance, path);
    double step = 0.0;
    path.resize(states.size(), Vector3::Constant(kInf));
    for (std::size_t k = 0; k < path.size(); ++k) {
      step = std::max(step, (states[k].mean - path[k]).cwiseAbs().maxCoeff());
      path[k] = states[k].mean;
    }
    if (step < kStill) break;
  }
  std::vector<PoseGaussian> poses;
  for (const State& s : states) poses.push_back({{s.mean.x(), s.mean.y(), wrap(s.mean.z())}, s.covariance});
  return poses;
}

}  // namespace noctule::smoothing
