/// Learned noise of sightings and neighbour optimisation in the landmark filters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "filters/slam/fastslam.hpp"
#include "filters/slam/make_slam_filter.hpp"
#include "filters/slam/particle_kernel.hpp"
#include "unit/filters/landmark_world.hpp"

namespace noctule::filters {
namespace {

using test::drive;
using test::feed;
using test::small_web;

Sighting sighting(double range, double bearing, const Matrix2& covariance) {
  Sighting z;
  z.range = range;
  z.bearing = bearing;
  z.rr = covariance(0, 0);
  z.rb = covariance(0, 1);
  z.bb = covariance(1, 1);
  return z;
}

Matrix2 skewed() {
  Matrix2 r;
  r << 0.04, 0.002, 0.002, 0.0009;
  return r;
}

/// A posterior of overwhelming certainty at the nominal noise.
SightingVbNoiseParameters certain() {
  SightingVbNoiseParameters p;
  p.nu = 1e7;
  p.learning.memory = 1e9;
  p.learning.keep_at_most = 0.999999;
  return p;
}

TEST(SightingNoise, JudgesAsTheStatedGaussianWhereThatIsCertain) {
  SightingNoise learned(certain(), 1);
  ASSERT_TRUE(learned.learns());
  std::vector<Sighting> sightings{sighting(5.0, 0.3, skewed())};
  learned.begin(sightings);
  const Sighting& z = sightings[0];
  EXPECT_NEAR(z.rr, 0.04, 1e-6);
  EXPECT_NEAR(z.rb, 0.002, 1e-7);
  EXPECT_NEAR(z.bb, 0.0009, 1e-7);
  Matrix2 p;
  p << 0.02, -0.001, -0.001, 0.0005;
  const Innovation v{0.3, -0.05, 1.0, 0.0, 0.2};
  const auto judged = learned.judge(z, v, {p(0, 0), p(0, 1), p(1, 1)});
  const Vector2 e(v.range, v.bearing);
  EXPECT_NEAR(judged.log_density, log_gaussian<2>(e, cholesky<2>(p + skewed())), 1e-4);
  EXPECT_NEAR(judged.nis, mahalanobis2<2>(e, p + skewed()), 1e-9);
  EXPECT_NEAR(judged.noise.rr, 0.04, 1e-6);
  EXPECT_NEAR(judged.noise.rb, 0.002, 1e-7);
  EXPECT_NEAR(judged.noise.bb, 0.0009, 1e-7);
  EXPECT_NEAR(judged.range, 0.0, 1e-12);
  EXPECT_NEAR(judged.bearing, 0.0, 1e-12);
}

TEST(SightingNoise, BelievesLessOfWhatIsFarOff) {
  SightingNoise learned(SightingVbNoiseParameters{}, 1);
  std::vector<Sighting> sightings{sighting(5.0, 0.0, skewed())};
  learned.begin(sightings);
  double last = 0.0;
  for (const double off : {0.0, 0.5, 1.0, 3.0}) {
    const auto judged = learned.judge(sightings[0], {off, 0.0, 1.0, 0.0, 0.2}, {0.01, 0.0, 0.0001});
    EXPECT_GT(judged.noise.rr, last);
    last = judged.noise.rr;
  }
  EXPECT_GT(last, 5 * 0.04);
}

/// Sightings whose noise is `factor` times what they state.
std::vector<test::LandmarkScanStep> misjudged(double factor, double duration, std::uint64_t seed) {
  auto world = small_web();
  world.range_sd *= factor;
  world.bearing_sd *= factor;
  auto run = drive(world, duration, seed);
  for (auto& step : run) {
    for (auto& d : step.detections.detections) d.covariance /= factor * factor;
  }
  return run;
}

template <class Parameters>
double mean_scale(double factor) {
  double sum = 0.0;
  int n = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Parameters p;
    p.particles = 50;
    p.noise = SightingVbNoiseParameters{};
    const auto filter = make_slam_filter(p, seed, {});
    int scan = 0;
    for (const auto& step : misjudged(factor, 60.0, seed)) {
      feed(*filter, step);
      if (++scan <= 100) continue;
      sum += filter->estimate().noise_scale * filter->estimate().noise_scale;
      ++n;
    }
  }
  return sum / n;
}

TEST(SightingNoise, FiltersFindTheVarianceThatIsTrue) {
  for (const double factor : {1.0, 4.0}) {
    const double expected = factor * factor;
    const double within = factor == 1.0 ? 0.08 : 0.2;
    EXPECT_NEAR(mean_scale<FastSlam1Parameters>(factor) / expected, 1.0, within) << factor;
    EXPECT_NEAR(mean_scale<FastSlam2Parameters>(factor) / expected, 1.0, within) << factor;
    EXPECT_NEAR(mean_scale<UFastSlamParameters>(factor) / expected, 1.0, within) << factor;
  }
}

TEST(SightingNoise, TheErrorAgainstTheStatedNoiseStaysVisible) {
  FastSlam2Parameters p;
  p.noise = SightingVbNoiseParameters{};
  FastSlam2 filter(p, 1);
  double nis = 0.0;
  const auto run = misjudged(4.0, 60.0, 1);
  for (const auto& step : run) {
    feed(filter, step);
    nis += filter.estimate().nis / static_cast<double>(run.size());
  }
  EXPECT_GT(nis, 4.0);
}

TEST(SightingNoise, DoesNotDependOnThreads) {
  for (const Optimisation optimise : {Optimisation::none, Optimisation::apf}) {
    FastSlam2Parameters p;
    p.particles = 40;
    p.optimise = optimise;
    p.noise = SightingVbNoiseParameters{};
    FastSlam2 one(p, 3);
    p.threads = 3;
    FastSlam2 three(p, 3);
    for (const auto& step : misjudged(2.0, 20.0, 2)) {
      feed(one, step);
      feed(three, step);
    }
    EXPECT_EQ(one.estimate().pose, three.estimate().pose);
    EXPECT_EQ(one.estimate().noise_scale, three.estimate().noise_scale);
  }
}

/// A path ends where the map was last written from: the pose that the particle goes on with.
TEST(NeighbourOptimisation, PathsMapsAndEstimatesStayOneTrack) {
  const auto world = small_web();
  const auto run = drive(world, 60.0, 4);
  for (SlamFilterParameters p :
       std::vector<SlamFilterParameters>{FastSlam1Parameters{}, FastSlam2Parameters{}, UFastSlamParameters{}}) {
    for (const bool known : {true, false}) {
      std::visit(
          [](auto& q) {
            if constexpr (requires { q.optimise; }) {
              q.particles = 30;
              q.optimise = Optimisation::apf;
            }
          },
          p);
      const auto filter = make_slam_filter(p, 2, {});
      bool resampled = false;
      double error = 0.0;
      for (auto step : run) {
        if (!known) {
          for (auto& d : step.detections.detections) d.id = -1;
        }
        feed(*filter, step);
        resampled |= filter->estimate().resampled;
        error = (filter->estimate().pose.position() - step.truth.position()).norm();
        EXPECT_LT((filter->path().poses.back().pose.position() - step.truth.position()).norm(), 3.0);
      }
      EXPECT_TRUE(resampled);
      EXPECT_LT(error, 2.0) << kSlamFilterNames[p.index()] << known;
      EXPECT_EQ(filter->path().poses.size(), run.size());
      for (const auto& m : filter->map().landmarks) EXPECT_TRUE(m.parameters.allFinite());
    }
  }
}

TEST(NeighbourOptimisation, IsRefusedWhereASwarmMovesTheParticles) {
  PsoUFastSlamParameters p;
  p.optimise = Optimisation::apf;
  EXPECT_THROW(make_slam_filter(p, 1, {}), InputError);
}

TEST(WeightPower, ParticlesLiveLonger) {
  const auto run = drive(small_web(), 60.0, 5);
  double ess[2] = {0.0, 0.0};
  for (int k = 0; k < 2; ++k) {
    FastSlam2Parameters p;
    p.weight_power = k == 0 ? 1.0 : 0.1;
    FastSlam2 filter(p, 1);
    for (const auto& step : run) {
      feed(filter, step);
      ess[k] += filter.estimate().effective_sample_size;
    }
  }
  EXPECT_GT(ess[1], ess[0]);
}

}  // namespace
}  // namespace noctule::filters
