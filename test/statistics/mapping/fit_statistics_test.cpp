/// Covariances and biases of the fits to points, against Monte Carlo.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "core/chi2.hpp"
#include "core/rng.hpp"
#include "mapping/circle_fit.hpp"
#include "mapping/rho_theta.hpp"

namespace noctule::mapping {
namespace {

TEST(FitLineStatistics, CovarianceMatchesMonteCarlo) {
  constexpr int runs = 4000;
  const Wall truth{1.2, 0.8};
  const Matrix2 round = 1e-4 * Matrix2::Identity();
  Matrix2 flat;
  flat << 9e-4, 2e-4, 2e-4, 1e-4;
  Matrix2 sample = Matrix2::Zero(), predicted = Matrix2::Zero();
  double nees = 0.0;
  for (int run = 0; run < runs; ++run) {
    Rng rng(1, stream_id("test.fit_line"), static_cast<std::uint64_t>(run));
    std::vector<PointWithCovariance> points;
    for (int i = 0; i < 20; ++i) {
      const Matrix2 c = i % 2 == 0 ? round : flat;
      const Matrix2 root = c.llt().matrixL();
      const Vector2 p = foot(truth) + (0.3 + 0.1 * i) * truth.tangent();
      points.push_back({p + root * Vector2(rng.normal(), rng.normal()), c});
    }
    const auto fit = fit_line(points);
    ASSERT_TRUE(fit);
    const Vector2 e(fit->wall.rho - truth.rho, wrap(fit->wall.theta - truth.theta));
    sample += e * e.transpose() / runs;
    predicted += fit->covariance / runs;
    nees += e.dot(fit->covariance.inverse() * e) / runs;
  }
  EXPECT_NEAR(sample(0, 0) / predicted(0, 0), 1.0, 0.1);
  EXPECT_NEAR(sample(0, 1) / predicted(0, 1), 1.0, 0.1);
  EXPECT_NEAR(sample(1, 1) / predicted(1, 1), 1.0, 0.1);
  const Interval bounds = nees_bounds(2, runs, 0.999);
  EXPECT_GT(nees, bounds.low);
  EXPECT_LT(nees, bounds.high);
}

/// Errors of the radius [cm] over many noisy arcs of R = 10.63 cm, sigma = 0.3 cm, 24 points.
struct RadiusErrors {
  double kasa_bias = 0.0, taubin_bias = 0.0, geometric_bias = 0.0, geometric_rms = 0.0, geometric_sd = 0.0;
};
RadiusErrors radius_errors(double view) {
  constexpr int runs = 3000;
  const Cylinder truth{{60.0, 60.0}, 10.63};
  RadiusErrors errors;
  for (int run = 0; run < runs; ++run) {
    Rng rng(2, stream_id("test.fit_circle"), static_cast<std::uint64_t>(run));
    std::vector<Vector2> points;
    std::vector<PointWithCovariance> uncertain;
    for (int i = 0; i < 24; ++i) {
      const double a = rng.uniform(0.0, view);
      points.push_back(truth.centre + truth.radius * Vector2(std::cos(a), std::sin(a)) +
                       0.3 * Vector2(rng.normal(), rng.normal()));
      uncertain.push_back({points.back(), 0.09 * Matrix2::Identity()});
    }
    const auto geometric = fit_circle(uncertain);
    if (!geometric) continue;
    const double e = geometric->circle.radius - truth.radius;
    errors.kasa_bias += (kasa_circle(points)->radius - truth.radius) / runs;
    errors.taubin_bias += (taubin_circle(points)->radius - truth.radius) / runs;
    errors.geometric_bias += e / runs;
    errors.geometric_rms += e * e / runs;
    errors.geometric_sd += geometric->covariance(2, 2) / runs;
  }
  errors.geometric_rms = std::sqrt(errors.geometric_rms);
  errors.geometric_sd = std::sqrt(errors.geometric_sd);
  return errors;
}

TEST(CircleFitStatistics, KasaShrinksShortArcsAndTheOthersDoNot) {
  const RadiusErrors full = radius_errors(kTwoPi), half = radius_errors(kPi), quarter = radius_errors(kPi / 2.0);
  EXPECT_NEAR(full.geometric_rms, 0.064, 0.006);
  EXPECT_NEAR(half.geometric_rms, 0.155, 0.02);
  EXPECT_NEAR(quarter.geometric_rms, 0.70, 0.1);
  EXPECT_NEAR(quarter.kasa_bias, -0.82, 0.1);
  EXPECT_LT(std::abs(quarter.taubin_bias), 0.1);
  EXPECT_LT(std::abs(quarter.geometric_bias), 0.1);
  EXPECT_NEAR(half.geometric_sd / half.geometric_rms, 1.0, 0.1);
  EXPECT_NEAR(full.geometric_sd / full.geometric_rms, 1.0, 0.1);
}

}  // namespace
}  // namespace noctule::mapping
