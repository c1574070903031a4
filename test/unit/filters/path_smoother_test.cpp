/// Smoothing of a filter's path: the linear algebra against dense matrices, exactness without noise, and that it gains
/// what it promises and knows how well it did.
#include "filters/slam/path_smoother.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/chi2.hpp"
#include "core/error.hpp"
#include "filters/slam/arrow_system.hpp"
#include "unit/filters/recording.hpp"

namespace noctule::filters {
namespace {

using test::Drive;

TEST(ArrowSystem, SolvesAndInvertsLikeTheDenseMatrix) {
  constexpr std::size_t poses = 6;
  constexpr Eigen::Index border = 5, n = 3 * poses + border;
  Rng rng(1);
  ArrowSystem system(poses, border);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  // Equations between neighbours and between a pose and the border.
  const auto random = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&](auto, auto) { return rng.normal(); }));
  };
  for (std::size_t k = 0; k < poses; ++k) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(8, n);
    j.middleCols(row, 3).topRows(4) = random(4, 3);
    if (k + 1 < poses) j.middleCols(row + 3, 3).topRows(4) = random(4, 3);
    j.middleCols(row, 3).bottomRows(4) = random(4, 3);
    j.rightCols(border).bottomRows(4) = random(4, border);
    dense += j.transpose() * j;
    gradient += j.transpose() * random(8, 1);
  }
  for (std::size_t k = 0; k < poses; ++k) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    system.diagonal(k) = dense.block<3, 3>(row, row);
    if (k + 1 < poses) system.coupling(k) = dense.block<3, 3>(row, row + 3);
    system.border(k) = dense.block(row, 3 * poses, 3, border);
    system.gradient(k) = gradient.segment<3>(row);
  }
  system.corner() = dense.bottomRightCorner(border, border);
  system.corner_gradient() = gradient.tail(border);

  Eigen::MatrixXd damped = dense;
  damped.diagonal() *= 1.1;
  const Eigen::VectorXd expected = -damped.ldlt().solve(gradient);
  const auto step = system.solve(0.1);
  EXPECT_LT((step.poses - expected.head(3 * poses)).norm(), 1e-10);
  EXPECT_LT((step.border - expected.tail(border)).norm(), 1e-10);
  const Eigen::MatrixXd inverse = dense.inverse();
  const auto covariance = system.covariance();
  for (std::size_t k = 0; k < poses; ++k) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    EXPECT_LT((covariance.poses[k] - inverse.block<3, 3>(row, row)).norm(), 1e-10 * inverse.norm()) << k;
  }
  EXPECT_LT((covariance.border - inverse.bottomRightCorner(border, border)).norm(), 1e-10 * inverse.norm());
}

ParticleSlamParameters smoothing(int particles) {
  auto p = test::with_particles(particles);
  p.smooth_path = SmoothPath::all;
  return p;
}

TEST(PathSmoother, TakesNoSightings) {
  ParticleSlam filter(smoothing(1), 1);
  const LandmarkDetections sightings{{1, 0}, {}, {{.range = 1.0, .covariance = Matrix2::Identity(), .id = 3}}};
  EXPECT_THROW(filter.update(sightings), InputError);
}

TEST(PathSmoother, LeavesAnExactPathAlone) {
  Drive drive;
  drive.ranger.exact = true;
  drive.odometry_covariance.diagonal() << 1e-12, 1e-12, 1e-12;
  const auto path = test::arc_path(20, 0.1, 0.05);
  ParticleSlam filter(smoothing(1), 1);
  test::play(test::record(test::corner_scene(), path, drive, 1), filter);
  const auto poses = filter.path().poses;
  ASSERT_EQ(poses.size(), path.size());
  for (std::size_t k = 0; k < path.size(); ++k) EXPECT_LT(difference(poses[k].pose, path[k]).norm(), 1e-4) << k;
}

/// Runs of a filter through the corner; sums squared position errors of its path, and NEES of the smoothed one.
struct Outcome {
  double squared = 0.0, nees = 0.0;
  int poses = 0;
};
Outcome run(const ParticleSlamParameters& parameters, int runs, double noise = 1.0) {
  Outcome outcome;
  const auto path = test::arc_path(30, 0.1, 0.15);
  for (int r = 0; r < runs; ++r) {
    auto drive = test::noisy_drive();
    drive.ranger.noise = {.base = 0.003 * noise, .relative = 0.005 * noise};
    ParticleSlam filter(parameters, 1);
    test::play(test::record(test::corner_scene(), path, drive, 100 + static_cast<std::uint64_t>(r)), filter);
    const auto poses = filter.path().poses;
    for (std::size_t k = 0; k < path.size(); ++k) {
      outcome.squared += (poses[k].pose.position() - path[k].position()).squaredNorm();
    }
    outcome.poses += static_cast<int>(path.size());
    if (const auto smooth = filter.smoothed()) {
      EXPECT_TRUE(smooth->converged) << r;
      outcome.nees += mahalanobis2<3>(difference(poses.back().pose, path.back()), smooth->covariances.back());
    }
  }
  return outcome;
}

TEST(PathSmoother, MendsWhatFewParticlesLack) {
  auto filtered = smoothing(20);
  filtered.smooth_path = SmoothPath::none;
  const Outcome before = run(filtered, 10), after = run(smoothing(20), 10);
  EXPECT_LT(after.squared, 0.7 * before.squared);
}

TEST(PathSmoother, HardlyDependsOnTheNumberOfParticles) {
  const Outcome few = run(smoothing(20), 10), many = run(smoothing(200), 10);
  EXPECT_NEAR(few.squared / many.squared, 1.0, 0.02);
}

TEST(PathSmoother, KnowsHowWellItDid) {
  // NEES of the last pose, 3 numbers, over 40 runs: 99.9 % bounds of the chi-square mean.
  constexpr int runs = 40;
  auto p = smoothing(50);
  p.echo.clutter_fraction = 1e-6;  // the scene has none
  const double mean = run(p, runs).nees / runs;
  EXPECT_GT(mean, chi2_quantile(0.0005, 3 * runs) / runs);
  EXPECT_LT(mean, chi2_quantile(0.9995, 3 * runs) / runs);
  // A filter told a third of the noise must be found out.
  EXPECT_GT(run(p, 10, 3.0).nees / 10, chi2_quantile(0.9995, 30) / 10);
}

TEST(LearnedNoise, KeepsTheNominalNoiseAndHidesNoDivergence) {
  // Told the truth, the filter believes it within 8 % (poses that no particle has count as noise: with 50 particles
  // it would be 14 %); told a quarter, it finds out, and the innovations under the
  // nominal noise, which are what estimate.nis is made of, still show it.
  const auto path = test::arc_path(80, 0.1, 0.15);
  const auto play = [&](double noise, std::uint64_t seed) {
    auto drive = test::noisy_drive();
    drive.ranger.noise = {.base = 0.003 * noise, .relative = 0.005 * noise};
    auto p = test::with_particles(500);
    p.noise = VbNoiseParameters{};
    ParticleSlam filter(p, 1);
    const auto r = test::record(test::corner_scene(), path, drive, seed);
    Vector2 sums = Vector2::Zero();  // of variance and NIS
    for (std::size_t i = 0; i < path.size(); ++i) {
      filter.predict(r.odometry[i]);
      filter.update(r.heard[i].scan, r.features[i]);
      const SlamEstimate e = filter.estimate();
      if (i >= 20) sums += Vector2(e.noise_scale * e.noise_scale, e.nis) / 60.0;
    }
    return sums;
  };
  Vector2 nominal = Vector2::Zero(), loud = Vector2::Zero();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    nominal += play(1.0, seed) / 3.0;
    loud += play(4.0, seed) / 3.0;
  }
  EXPECT_NEAR(nominal[0], 1.0, 0.08);
  EXPECT_NEAR(loud[0], 14.0, 4.0);  // the narrow component keeps the smallest residuals: somewhat low
  EXPECT_LT(nominal[1], 1.5);
  EXPECT_GT(loud[1], 5.0);
}

}  // namespace
}  // namespace noctule::filters
