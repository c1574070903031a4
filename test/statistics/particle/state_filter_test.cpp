/// Filters of any state against closed forms: Kalman's mean and variance, the growth model's known error, kernels that
/// keep two moments, shells and bins that keep expectations.
#include "particle/state_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "core/chi2.hpp"

namespace noctule::particle {
namespace {

/// x' = 0.9 x + u, z = x + v: Kalman's filter is exact.
struct Linear {
  static constexpr int kDimension = 1;
  static constexpr std::uint32_t kAngles = 0;
  using Measurement = double;
  static auto motion(int) {
    return [](const double* x, double* mean) { *mean = 0.9 * *x; };
  }
  static std::array<double, 1> noise_sd() { return {1.0}; }
  static std::array<double, 1> initial_mean() { return {0.0}; }
  static std::array<double, 1> initial_sd() { return {2.0}; }
  static double log_likelihood(const double* x, double z) { return -0.5 * (z - *x) * (z - *x) / 0.25; }
};

struct Bias {
  double mean = 0.0;      ///< of the difference from Kalman's, in its sd
  double variance = 0.0;  ///< of the set that goes on, over Kalman's
};

Bias against_kalman(const StateFilterParameters& parameters) {
  Bias bias;
  constexpr int runs = 8, steps = 20;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    StateFilter<Linear> filter({}, parameters, seed);
    Rng world(seed, stream_id("world"));
    double x = 2.0 * world.normal(), mean = 0.0, variance = 4.0;
    for (int step = 0; step < steps; ++step) {
      x = 0.9 * x + world.normal();
      const double z = x + 0.5 * world.normal();
      mean *= 0.9;
      variance = 0.81 * variance + 1.0;
      const double gain = variance / (variance + 0.25);
      mean += gain * (z - mean);
      variance *= 1.0 - gain;
      filter.update(z);
      bias.mean += (filter.mean()[0] - mean) / std::sqrt(variance) / (runs * steps);
      bias.variance += Spread(filter.states()).covariance(0, 0) / variance / (runs * steps);
    }
  }
  return bias;
}

class AgainstKalman : public testing::TestWithParam<Resampling> {};

TEST_P(AgainstKalman, MeanAndVarianceAreThoseOfTheExactPosterior) {
  const Bias bias = against_kalman({.particles = 2000, .resampling = GetParam()});
  EXPECT_NEAR(bias.mean, 0.0, 0.01);
  if (make_resampler(GetParam())->equal_weights()) {  // else the states without their weights are another set
    EXPECT_NEAR(bias.variance, 1.0, 0.03);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, AgainstKalman,
                         testing::Values(Resampling::systematic, Resampling::ssp, Resampling::branching,
                                         Resampling::optimal, Resampling::reallocation, Resampling::partial,
                                         Resampling::rejection, Resampling::regularised));

/// Neighbour optimisation is no sampling scheme: points that the measurement had ruled out come back at the edge of the
/// posterior with weight 1/N each. Means stay; the set that goes on is wider, here by 2.8 times the variance.
TEST(Improvements, ResampleMoveKeepsThePosteriorAndApfWidensIt) {
  StateFilterParameters parameters{.particles = 2000, .improvement = Improvement::resample_move};
  const Bias moved = against_kalman(parameters);
  EXPECT_NEAR(moved.mean, 0.0, 0.01);
  EXPECT_NEAR(moved.variance, 1.0, 0.03);
  parameters.improvement = Improvement::apf;
  const Bias apf = against_kalman(parameters);
  EXPECT_NEAR(apf.mean, 0.0, 0.05);
  EXPECT_GT(apf.variance, 2.0);
  EXPECT_LT(apf.variance, 3.5);
}

TEST(StateFilter, CollapseMakesWeightsEqualAndIsCounted) {
  StateFilter<Linear> filter({}, {.particles = 10}, 1);
  filter.update(1e200);
  EXPECT_EQ(filter.collapses(), 1);
  EXPECT_TRUE(std::isfinite(filter.mean()[0]));
  EXPECT_NEAR(filter.effective_sample_size(), 10.0, 1e-9);
  EXPECT_THROW(StateFilter<Linear>({}, {.particles = 0}, 1), std::invalid_argument);
}

std::vector<double> pose_cloud(std::size_t n, std::vector<double>& weights) {
  Rng rng(5);
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    const double e = rng.normal();
    values.insert(values.end(), {2.0 * e, e + rng.normal(), wrap(kPi + 0.2 * rng.normal() + 0.1 * e)});
    weights.push_back(std::exp(rng.normal()));
  }
  return values;
}

TEST(Regularise, KeepsMeanAndCovariance) {
  std::vector<double> weights;
  const std::size_t n = 20000;
  const std::vector<double> values = pose_cloud(n, weights);
  const States states{values.data(), n, 3, 0b100};
  const Spread before(states, weights);
  std::vector<std::uint32_t> counts(n), ancestors(n);
  Rng rng(6);
  make_resampler(Resampling::regularised)->offspring(weights, n, rng, counts);
  place_in_slots(counts, ancestors);
  std::vector<double> moved;
  for (const std::uint32_t a : ancestors) moved.insert(moved.end(), states[a], states[a] + 3);
  const MutableStates after{moved.data(), n, 3, 0b100};
  regularise(before, after, rng);
  const Spread spread(after);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(wrap(spread.mean(k) - before.mean(k)), 0.0, 0.03 * std::sqrt(before.covariance(k, k)));
    for (int l = 0; l < 3; ++l) {
      const double scale = std::sqrt(before.covariance(k, k) * before.covariance(l, l));
      EXPECT_NEAR(spread.covariance(k, l), before.covariance(k, l), 0.03 * scale);
    }
  }
  std::set<double> distinct;
  for (std::size_t i = 0; i < n; ++i) distinct.insert(after[i][0]);
  EXPECT_EQ(distinct.size(), n);
}

TEST(ErrorEllipse, IsUnbiasedAndGivesEveryShellItsShare) {
  std::vector<double> weights;
  const std::vector<double> values = pose_cloud(30, weights);
  const States states{values.data(), 30, 3, 0b100};
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  const Spread spread(states, weights);
  std::vector<double> mean(30, 0.0), squares(30, 0.0);
  std::vector<std::uint32_t> counts(30);
  constexpr int draws = 8000;
  const double inner_bound = chi2_quantile(0.5, 3);
  for (int k = 0; k < draws; ++k) {
    Rng rng(7, 0, static_cast<std::uint64_t>(k));
    error_ellipse_offspring(states, weights, 30, rng, counts);
    ASSERT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), 30u);
    double inner = 0.0, inner_mass = 0.0;
    for (std::size_t i = 0; i < 30; ++i) {
      mean[i] += counts[i] / static_cast<double>(draws);
      squares[i] += counts[i] * counts[i] / static_cast<double>(draws);
      double y[3];
      spread.whiten(states[i], y);
      if (y[0] * y[0] + y[1] * y[1] + y[2] * y[2] > inner_bound) continue;
      inner += counts[i];
      inner_mass += 30.0 * weights[i] / total;
    }
    ASSERT_LT(std::abs(inner - inner_mass), 1.0 + 1e-9);
  }
  for (std::size_t i = 0; i < 30; ++i) {
    const double sd = std::sqrt((squares[i] - mean[i] * mean[i]) / draws);
    EXPECT_LT(std::abs(mean[i] - 30.0 * weights[i] / total), 4.0 * sd + 1e-9) << i;
  }
}

TEST(Kld, AsksForAsManyParticlesAsFoxSays) {
  const KldParameters parameters;
  EXPECT_EQ(kld_size(1, parameters), parameters.least);
  // n with P(chi2_{k-1} <= 2 n error) = 99 % (eq. 4), which eq. 7 approximates.
  for (const std::size_t k : {3u, 10u, 60u, 150u}) {
    const double exact = chi2_quantile(0.99, static_cast<double>(k - 1)) / (2.0 * parameters.error);
    EXPECT_NEAR(kld_size(k, parameters), exact, 1.0 + 0.01 * exact) << k;
  }
  EXPECT_EQ(kld_size(100000, parameters), parameters.most);
}

TEST(Kld, ANarrowSetNeedsFewerAndExpectationsStay) {
  Rng rng(8);
  const std::size_t n = 500;
  std::vector<double> values(n), weights(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = rng.normal(), weights[i] = 0.1 + rng.uniform();
  const States states{values.data(), n, 1, 0};
  std::vector<std::uint32_t> counts(n);
  const auto drawn = [&](double bin) {
    const std::uint32_t size = kld_offspring(states, weights, std::vector<double>{bin}, {}, rng, counts);
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), size);
    return size;
  };
  EXPECT_LT(drawn(5.0), drawn(0.05));
  EXPECT_LE(drawn(0.001), 2000u);
  EXPECT_THROW(drawn(0.0), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::particle
