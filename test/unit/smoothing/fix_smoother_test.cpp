#include "smoothing/fix_smoother.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/chi2.hpp"

namespace noctule::smoothing {
namespace {

struct Drive {
  std::vector<Pose2> truth{Pose2{}};
  std::vector<PoseGaussian> motions;
  std::vector<std::optional<Vector2>> fixes;
};

constexpr double kFixSd = 0.4;

/// An eight, with noise as stated and a fix at every second time.
Drive drive(std::uint64_t seed, double noise) {
  Drive d;
  Rng rng(seed, stream_id("fix_smoother_test"), 0);
  const Vector3 sd(0.05, 0.01, 0.02);
  for (int k = 0; k < 120; ++k) {
    const Pose2 step{0.5, 0.0, k < 60 ? 0.1 : -0.1};
    PoseGaussian motion{step, sd.cwiseAbs2().asDiagonal()};
    motion.mean.x += noise * rng.normal(0.0, sd.x());
    motion.mean.y += noise * rng.normal(0.0, sd.y());
    motion.mean.yaw += noise * rng.normal(0.0, sd.z());
    d.motions.push_back(motion);
    d.truth.push_back(d.truth.back() * step);
  }
  for (std::size_t k = 0; k < d.truth.size(); ++k) {
    d.fixes.push_back(k % 2 == 0
                          ? std::nullopt
                          : std::optional<Vector2>(d.truth[k].position() +
                                                   noise * Vector2(rng.normal(0.0, kFixSd), rng.normal(0.0, kFixSd))));
  }
  return d;
}

std::vector<PoseGaussian> smooth(const Drive& d, const Pose2& start) {
  return smooth_fixes({start, Vector3(1.0, 1.0, 0.3).cwiseAbs2().asDiagonal()}, d.motions, d.fixes,
                      kFixSd * kFixSd * Matrix2::Identity());
}

TEST(FixSmoother, ExactDataGiveTheTruePathFromAWrongStart) {
  const Drive d = drive(1, 0.0);
  PoseGaussian start{{0.8, -0.5, 0.4}, 1e6 * Matrix3::Identity()};  // nearly nothing is known
  const auto path = smooth_fixes(start, d.motions, d.fixes, kFixSd * kFixSd * Matrix2::Identity());
  for (std::size_t k = 0; k < path.size(); ++k) {
    EXPECT_LT((path[k].mean.position() - d.truth[k].position()).norm(), 1e-5);
    EXPECT_NEAR(wrap(path[k].mean.yaw - d.truth[k].yaw), 0.0, 1e-5);
  }
}

TEST(FixSmoother, CovarianceIsThatOfTheError) {
  constexpr int kRuns = 100;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const Drive d = drive(seed, 1.0);
    Rng rng(seed, stream_id("fix_smoother_test.start"), 0);
    const Pose2 start{rng.normal(0.0, 1.0), rng.normal(0.0, 1.0), rng.normal(0.0, 0.3)};
    const PoseGaussian middle = smooth(d, start)[60];
    const Pose2& truth = d.truth[60];
    const Vector3 error(middle.mean.x - truth.x, middle.mean.y - truth.y, wrap(middle.mean.yaw - truth.yaw));
    sum += mahalanobis2<3>(error, middle.covariance);
  }
  const Interval bounds = nees_bounds(3, kRuns, 0.999);
  EXPECT_GT(sum / kRuns, bounds.low);
  EXPECT_LT(sum / kRuns, bounds.high);
}

TEST(FixSmoother, RefusesMotionsThatDoNotFitTheTimes) {
  const std::vector<PoseGaussian> motions(3);
  const std::vector<std::optional<Vector2>> fixes(3);
  EXPECT_THROW(static_cast<void>(smooth_fixes({{}, Matrix3::Identity()}, motions, fixes, Matrix2::Identity())),
               std::invalid_argument);
}

}  // namespace
}  // namespace noctule::smoothing
