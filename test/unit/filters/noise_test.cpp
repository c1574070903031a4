/// Learned measurement noise: closed forms, bounds that must hold for ever, and what it follows how fast.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/pose2.hpp"
#include "filters/noise/noise_model.hpp"

namespace noctule::filters {
namespace {

VbNoiseParameters vb_with(int components, double sd_ratio = 4.0) {
  VbNoiseParameters p;
  p.learning.components = components;
  p.learning.sd_ratio = sd_ratio;
  p.beta = 20.0;
  return p;
}

/// Residuals of so many observations with noise of the given sd; one in ten five times as large, if wanted.
template <int D>
std::vector<NoiseResidual<D>> draw(int n, double sd, Rng& rng, bool outliers = false) {
  std::vector<NoiseResidual<D>> result(static_cast<std::size_t>(n));
  for (auto& r : result) {
    const double s = outliers && rng.uniform() < 0.1 ? 5.0 * sd : sd;
    for (int i = 0; i < D; ++i) r.mean[i] = rng.normal(0.0, s);
    r.second_moment = r.mean * r.mean.transpose();
  }
  return result;
}

template <int D>
void expect_closed_form() {
  const auto p = vb_with(1);
  Rng rng(D);
  auto residuals = draw<D>(7, 1.5, rng);
  residuals[3].second_moment += 0.3 * MatrixD<D>::Identity();  // of an uncertain prediction
  VbNoise<D> vb(p);
  vb.update(residuals, 3);

  VectorD<D> sum = VectorD<D>::Zero();
  MatrixD<D> squares = MatrixD<D>::Zero();
  for (const auto& r : residuals) {
    sum += r.mean;
    squares += r.second_moment;
  }
  const auto& c = vb.components()[0];
  EXPECT_NEAR(c.alpha, p.alpha + 7, 1e-12);
  EXPECT_NEAR(c.beta, p.beta + 7, 1e-12);
  EXPECT_NEAR(c.nu, p.nu + 7, 1e-12);
  EXPECT_LT((c.m - sum / (p.beta + 7)).norm(), 1e-12);
  const MatrixD<D> inverse_w = p.nu * MatrixD<D>::Identity() + squares - (p.beta + 7) * c.m * c.m.transpose();
  EXPECT_LT((c.inverse_w - inverse_w).norm(), 1e-12);

  // The predictive is Student's t: compare the density at a point with the textbook's formula.
  VectorD<D> v = VectorD<D>::Constant(0.8);
  const double dof = c.nu + 1 - D;
  const MatrixD<D> scale = inverse_w * (1 + c.beta) / (c.beta * dof);
  const double distance2 = mahalanobis2<D>(v - c.m, scale);
  const double expected = std::lgamma((dof + D) / 2) - std::lgamma(dof / 2) - 0.5 * D * std::log(dof * kPi) -
                          0.5 * std::log(models::small_determinant<D>(scale)) -
                          (dof + D) / 2 * std::log1p(distance2 / dof);
  EXPECT_NEAR(vb.mixture().log_density(v), expected, 1e-12);
}

TEST(VbNoise, OneComponentIsTheConjugatePosterior) {
  expect_closed_form<1>();
  expect_closed_form<2>();
}

template <int D>
void expect_bound_rises(int components, std::uint64_t seed) {
  Rng rng(seed);
  auto residuals = draw<D>(40, 2.0, rng, true);
  residuals[5].weight = 0.4;
  double last = -1e300;
  for (int iterations = 1; iterations <= 40; ++iterations) {
    VbNoise<D> vb(vb_with(components, 3.0));
    const double bound = vb.update(residuals, iterations);
    EXPECT_GE(bound, last - 1e-8) << iterations;
    last = bound;
  }
}

TEST(VbNoise, EvidenceBoundNeverFalls) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    expect_bound_rises<1>(1, seed);
    expect_bound_rises<1>(2, seed);
    expect_bound_rises<2>(2, seed);
    expect_bound_rises<2>(3, seed);
  }
}

TEST(VbNoise, PredictiveIntegratesToOne) {
  Rng rng(4);
  VbNoise<1> one(vb_with(2));
  one.update(draw<1>(30, 2.0, rng, true), 4);
  const auto p1 = one.mixture();
  double integral = 0.0;
  for (double x = -400.0; x <= 400.0; x += 0.05) integral += 0.05 * std::exp(p1.log_density(VectorD<1>(x)));
  EXPECT_NEAR(integral, 1.0, 1e-5);
  integral = 0.0;  // with an uncertain prediction too
  for (double x = -400.0; x <= 400.0; x += 0.05) {
    integral += 0.05 * std::exp(p1.log_density(VectorD<1>(x), MatrixD<1>(3.0)));
  }
  EXPECT_NEAR(integral, 1.0, 1e-5);

  VbNoise<2> two(vb_with(2));
  two.update(draw<2>(30, 1.0, rng), 4);
  const auto p2 = two.mixture();
  integral = 0.0;
  for (double x = -60.0; x <= 60.0; x += 0.25) {
    for (double y = -60.0; y <= 60.0; y += 0.25) {
      integral += 0.0625 * std::exp(p2.log_density(Vector2(x, y), Matrix2::Zero()));
    }
  }
  EXPECT_NEAR(integral, 1.0, 2e-3);
}

/// Mean variance that gains would be made of, over the residuals of a scan.
template <int D>
double effective_variance(const models::NoiseMixture<D>& noise, const std::vector<NoiseResidual<D>>& residuals) {
  double sum = 0.0;
  for (const auto& r : residuals) sum += noise.effective(r.mean).covariance.trace() / D;
  return sum / static_cast<double>(residuals.size());
}

/// A model after so many scans of 4 observations with noise of the given sd.
void hear(NoiseModel<2>& model, int scans, double sd, Rng& rng) {
  for (int scan = 0; scan < scans; ++scan) {
    model.begin(4);
    model.learn(draw<2>(4, sd, rng));
  }
}

TEST(NoiseModel, GainsKeepTheNoiseThatIsTrue) {
  for (const auto& [components, ratio] : {std::pair{1, 1.0}, {2, 4.0}, {3, 3.0}}) {
    NoiseModel<2> model(NoiseParameters{vb_with(components, ratio)});
    Rng rng(11);
    model.begin(4);
    EXPECT_LT(effective_variance(model.mixture(), draw<2>(4000, 1.0, rng)), 1.5) << components;
    for (const double sd : {1.0, 4.0}) {
      hear(model, 100, sd, rng);
      double mean = 0.0;
      for (int scan = 0; scan < 300; ++scan) {
        const auto residuals = draw<2>(4, sd, rng);
        model.begin(4);
        model.learn(residuals);
        mean += effective_variance(model.mixture(), residuals) / (300 * sd * sd);
      }
      if (sd == 1.0) {
        EXPECT_NEAR(mean, 1.0, 0.08) << components;
      } else if (components <= 2) {  // of three, the narrow ones keep the small residuals: 0.78
        EXPECT_NEAR(mean, 1.0, 0.2) << components;
      }
    }
  }
}

TEST(NoiseModel, FollowsAStep) {
  // Variance of the predictive distribution 20 scans after the sd went from 1 to 4.
  for (const int components : {1, 2}) {
    double mean = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      VbNoise<2> vb(vb_with(components));
      Rng rng(seed);
      for (int scan = 0; scan < 120; ++scan) {
        vb.forget(0.92);
        vb.update(draw<2>(4, scan < 100 ? 1.0 : 4.0, rng), 4);
      }
      double total = 0.0, variance = 0.0;
      for (const auto& c : vb.components()) {
        total += c.alpha;
        variance += c.alpha * (c.inverse_w.trace() / 2 / (c.nu - 3) * (1 + 1 / c.beta) + c.m.squaredNorm() / 2);
      }
      mean += variance / total / 20;
    }
    EXPECT_NEAR(mean, 16.0, 4.0) << components;
  }
}

TEST(NoiseModel, StaysBoundedWhenNothingIsHeardForEver) {
  Rng rng(13);
  const auto loud = draw<2>(50, 9.0, rng);
  NoiseModel<2> vb{NoiseParameters{vb_with(2)}}, em{NoiseParameters{EmNoiseParameters{}}};
  const NoiseModel<2> fresh{NoiseParameters{vb_with(2)}};
  vb.learn(loud);
  em.learn(loud);
  for (int scan = 0; scan < 1'000'000; ++scan) {
    vb.begin(0);
    em.begin(0);
  }
  for (const double x : {0.0, 1.0, 30.0}) {
    const Vector2 v(x, -x);
    EXPECT_NEAR(vb.mixture().log_density(v), fresh.mixture().log_density(v), 1e-9);
    EXPECT_TRUE(std::isfinite(em.mixture().log_density(v)));
    EXPECT_TRUE(em.mixture().effective(v).covariance.allFinite());
  }
}

TEST(NoiseModel, UnusedComponentsDoNotDrift) {
  VbNoise<1> vb(vb_with(3));
  Rng rng(14);
  for (int scan = 0; scan < 100'000; ++scan) {
    vb.forget(0.92);
    vb.update(draw<1>(2, 1.0, rng), 2);
  }
  for (std::size_t l = 0; l < 3; ++l) {
    const auto &c = vb.components()[l], &p = vb.prior()[l];
    EXPECT_GE(c.alpha, p.alpha - 1e-9);
    EXPECT_GE(c.beta, p.beta - 1e-9);
    EXPECT_GE(c.nu, p.nu - 1e-9);
    EXPECT_LE(c.nu, p.nu + 2.0 / 0.08 + 1e-9);
    EXPECT_GT(c.inverse_w(0, 0) / c.nu, 0.2 * p.inverse_w(0, 0) / p.nu);
    EXPECT_LT(c.inverse_w(0, 0) / c.nu, 3.0 * p.inverse_w(0, 0) / p.nu);
  }
}

TEST(NoiseModel, PredictsContaminatedNoiseThatSteps) {
  // Range and bearing with sd 0.1 m and 1 degree, x1, x4, x2 each for 200 scans of 4 sightings, one in ten five times
  // as far off: the fixed Gaussian reaches -19, the true density 1.52 per sighting.
  const double log_scale = -std::log(0.1 * radians(1.0));
  double vb_sum = 0.0, fixed_sum = 0.0;
  int n = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    auto p = vb_with(2);
    p.learning.memory = 40.0;  // keeps 0.9
    NoiseModel<2> vb{NoiseParameters{p}};
    const NoiseModel<2> fixed{NoiseParameters{}};
    Rng rng(seed);
    for (int scan = 0; scan < 600; ++scan) {
      const auto residuals = draw<2>(4, scan < 200 ? 1.0 : scan < 400 ? 4.0 : 2.0, rng, true);
      vb.begin(4);
      for (const auto& r : residuals) {
        vb_sum += vb.mixture().log_density(r.mean) + log_scale;
        fixed_sum += fixed.mixture().log_density(r.mean) + log_scale;
        ++n;
      }
      vb.learn(residuals);
    }
  }
  EXPECT_GT(vb_sum / n, 1.3);
  EXPECT_LT(vb_sum / n, 1.52);
  EXPECT_LT(fixed_sum / n, -10.0);
}

TEST(EmNoise, FindsAMixture) {
  Rng rng(15);
  std::vector<NoiseResidual<1>> residuals;
  for (int k = 0; k < 4000; ++k) {
    auto r = draw<1>(1, rng.uniform() < 0.8 ? 2.0 : 8.0, rng);
    residuals.push_back(r[0]);
  }
  EmNoise<1> em{EmNoiseParameters{}};
  em.update(residuals, 200);
  const auto noise = em.mixture();
  double error = 0.0;
  for (double x = -20.0; x <= 20.0; x += 0.5) {
    const double truth = std::log(0.8 * std::exp(log_gaussian(x, 4.0)) + 0.2 * std::exp(log_gaussian(x, 64.0)));
    error = std::max(error, std::abs(noise.log_density(VectorD<1>(x)) - truth));
  }
  EXPECT_LT(error, 0.25);
}

TEST(NoiseMixture, BoundHoldsForEveryPredictionAndResidual) {
  Rng rng(16);
  VbNoise<1> vb(vb_with(2));
  vb.update(draw<1>(20, 0.5, rng), 4);
  const auto noise = vb.mixture();
  for (int k = 0; k < 10000; ++k) {
    const double extra = std::exp(rng.uniform(-8.0, 8.0)), v = rng.normal(0.0, std::exp(rng.uniform(-2.0, 5.0)));
    EXPECT_LE(noise.log_density(VectorD<1>(v), MatrixD<1>(extra)),
              noise.log_density_bound(v * v / (1 + extra)) + 1e-12);
  }
}

}  // namespace
}  // namespace noctule::filters
