#include <gtest/gtest.h>
#include <Eigen/LU>

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/assignment.hpp"
#include "core/chi2.hpp"
#include "core/contour.hpp"
#include "core/estimate.hpp"
#include "core/gaussian.hpp"
#include "core/limits.hpp"
#include "core/log_weights.hpp"
#include "core/parameters.hpp"
#include "core/pose2.hpp"
#include "core/rng.hpp"

namespace noctule {
namespace {

TEST(Philox, KnownAnswersOfRandom123) {
  using Block = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Rng, AddressDecidesTheNumbers) {
  Rng a(7, stream_id("sonar"), 3, 5), b(7, stream_id("sonar"), 3, 5), c(7, stream_id("sonar"), 3, 6);
  const double first = a.normal();
  EXPECT_EQ(first, b.normal());
  EXPECT_NE(first, c.normal());
}

TEST(Rng, MomentsOfNormalAndUniform) {
  constexpr int n = 200000;
  double mean = 0, square = 0, fourth = 0, uniform = 0;
  for (int i = 0; i < n; ++i) {
    Rng rng(11, 1, static_cast<std::uint64_t>(i), 2);
    const double z = rng.normal();
    mean += z;
    square += z * z;
    fourth += z * z * z * z;
    uniform += rng.uniform();
  }
  EXPECT_NEAR(mean / n, 0.0, 4 / std::sqrt(n));
  EXPECT_NEAR(square / n, 1.0, 4 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / n, 3.0, 4 * std::sqrt(96.0 / n));
  EXPECT_NEAR(uniform / n, 0.5, 4 * std::sqrt(1.0 / 12 / n));
}

TEST(LogWeights, SurviveExtremes) {
  std::vector<double> w{-1e5, -1e5 + std::log(3.0), -kInf};
  normalise_log_weights(w);
  EXPECT_NEAR(std::exp(w[0]), 0.25, 1e-10);
  EXPECT_NEAR(std::exp(w[1]), 0.75, 1e-10);
  EXPECT_NEAR(effective_sample_size(w), 1.0 / (0.0625 + 0.5625), 1e-10);
}

TEST(LogWeights, CollapseBecomesUniformAndIsReported) {
  std::vector<double> w{-kInf, -kInf};
  EXPECT_EQ(normalise_log_weights(w), -kInf);
  EXPECT_NEAR(effective_sample_size(w), 2.0, 1e-12);
  EXPECT_NEAR(perplexity(w), 2.0, 1e-12);
}

TEST(Chi2, TabulatedQuantiles) {
  EXPECT_NEAR(chi2_quantile(0.95, 2), 5.991464547, 1e-8);
  EXPECT_NEAR(chi2_quantile(0.99, 2), 9.210340372, 1e-8);
  EXPECT_NEAR(chi2_quantile(0.99, 1), 6.634896601, 1e-8);
  EXPECT_NEAR(chi2_quantile(0.95, 1), 3.841458821, 1e-8);
  EXPECT_THROW(static_cast<void>(chi2_quantile(1.0, 1)), std::domain_error);
}

TEST(Chi2, NeesBoundsOfTheLiterature) {  // Kim 2008: [2.19, 3.93] for 30 runs of dimension 3
  const Interval b = nees_bounds(3, 30);
  EXPECT_NEAR(b.low, 2.19, 0.005);
  EXPECT_NEAR(b.high, 3.94, 0.005);
}

TEST(Gaussian, JosephUpdateEqualsInformationForm) {
  MatrixD<3> p;
  p << 2, 0.3, 0.1, 0.3, 1, 0.2, 0.1, 0.2, 0.5;
  const MatrixD<3> prior = p;
  VectorD<3> m(1, 2, 3);
  const VectorD<3> prior_mean = m;
  Eigen::Matrix<double, 2, 3> h;
  h << 1, 0, 2, 0, 1, -1;
  const MatrixD<2> r = VectorD<2>(0.3, 0.7).asDiagonal();
  const VectorD<2> z(0.5, -0.2);
  joseph_update<3, 2>(m, p, z, h, r);
  const MatrixD<3> information = prior.inverse() + h.transpose() * r.inverse() * h;
  EXPECT_LT((p - information.inverse()).norm(), 1e-12);
  EXPECT_LT((m - prior_mean - information.inverse() * h.transpose() * r.inverse() * z).norm(), 1e-12);
}

TEST(Gaussian, SquareRootOfASingularCovariance) {
  const VectorD<3> v(1, 2, -1);
  const MatrixD<3> p = v * v.transpose();
  const MatrixD<3> a = square_root<3>(p);
  EXPECT_LT((a * a.transpose() - p).norm(), 1e-12);
}

TEST(SymmetricEigen, RebuildsTheMatrixFromOrderedValues) {
  const MatrixD<3> m{{4, 1, -2}, {1, 3, 0.5}, {-2, 0.5, 5}};
  const auto [values, vectors] = symmetric_eigen<3>(m);
  EXPECT_LE(values[0], values[1]);
  EXPECT_LE(values[1], values[2]);
  EXPECT_LT((vectors * values.asDiagonal() * vectors.transpose() - m).norm(), 1e-12);
  EXPECT_LT((vectors.transpose() * vectors - MatrixD<3>::Identity()).norm(), 1e-12);
}

TEST(Gaussian, NotPositiveDefiniteThrows) {
  const MatrixD<2> p = VectorD<2>(-1.0, 0.5).asDiagonal();
  EXPECT_THROW(static_cast<void>(cholesky<2>(p)), std::domain_error);
}

double brute_force(const Eigen::MatrixXd& cost, double free) {
  const int n = static_cast<int>(cost.rows()), m = static_cast<int>(cost.cols());
  std::vector<int> slots(static_cast<std::size_t>(n + m));
  std::iota(slots.begin(), slots.end(), 0);
  double best = kInf;
  do {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += slots[i] < m ? cost(i, slots[i]) : free;
    best = std::min(best, sum);
  } while (std::next_permutation(slots.begin(), slots.end()));
  return best;
}

TEST(Assignment, EqualsBruteForce) {
  Rng rng(3);
  for (int k = 0; k < 60; ++k) {
    const int n = 1 + static_cast<int>(rng.index(3)), m = 1 + static_cast<int>(rng.index(4));
    Eigen::MatrixXd cost(n, m);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < m; ++j) cost(i, j) = rng.uniform() < 0.2 ? kInf : rng.uniform(-2, 5);
    const double free = rng.uniform(0, 3);
    const auto result = assign(cost, free);
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += result[i] >= 0 ? cost(i, result[i]) : free;
    EXPECT_NEAR(sum, brute_force(cost, free), 1e-9);
  }
}

TEST(Wall, TransformKeepsDistances) {
  Rng rng(5);
  for (int i = 0; i < 200; ++i) {
    const Pose2 t{rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-kPi, kPi)};
    const Wall w{rng.uniform(-2, 2), rng.uniform(-kPi, kPi)};
    const Vector2 p(rng.uniform(-3, 3), rng.uniform(-3, 3));
    EXPECT_NEAR(transformed(t, w).distance(t * p), w.distance(p), 1e-12);
    EXPECT_GE(normalised(w).rho, 0.0);
    EXPECT_NEAR(std::abs(normalised(w).distance(p)), std::abs(w.distance(p)), 1e-12);
  }
}

}  // namespace
}  // namespace noctule
