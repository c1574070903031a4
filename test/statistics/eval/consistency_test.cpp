/// The judge of consistency must pass a filter that is right and fail one that is not.
#include "eval/consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/gaussian.hpp"

namespace noctule::eval {
namespace {

/// A scalar random walk, filtered with a claimed measurement variance.
std::vector<std::vector<NormalisedSquare>> walk(double claimed) {
  std::vector<std::vector<NormalisedSquare>> runs(100);
  for (std::size_t run = 0; run < runs.size(); ++run) {
    Rng rng(17, 0, run);
    double truth = rng.normal();
    VectorD<1> mean = VectorD<1>::Zero();
    MatrixD<1> covariance = MatrixD<1>::Identity();
    for (int k = 0; k < 200; ++k) {
      truth += rng.normal(0.0, 0.5);
      covariance(0, 0) += 0.25;
      const VectorD<1> innovation(truth + rng.normal() - mean[0]);
      joseph_update<1, 1>(mean, covariance, innovation, MatrixD<1>::Identity(), claimed * MatrixD<1>::Identity());
      runs[run].push_back(normalised_square<1>(VectorD<1>(mean[0] - truth), covariance));
    }
  }
  return runs;
}

TEST(ConsistencyOverRuns, PassesTheRightFilterAndFailsTheWrongOne) {
  // 200 times, neighbours correlated over about 5: the share has a standard deviation near 0.035.
  const Consistency right = consistency(walk(1.0));
  EXPECT_GT(right.share_inside, 0.85);
  EXPECT_NEAR(right.mean, 1.0, 0.05);
  const Consistency overconfident = consistency(walk(0.5));
  EXPECT_LT(overconfident.share_inside, 0.5);
  EXPECT_GT(overconfident.share_above, 0.5);
  const Consistency underconfident = consistency(walk(2.0));
  EXPECT_LT(underconfident.share_inside, 0.5);
  EXPECT_GT(underconfident.share_below, 0.5);
}

}  // namespace
}  // namespace noctule::eval
