/// The point-mass filter against Kalman's, and by its invariants.
#include "filters/scalar_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "core/rng.hpp"

namespace noctule::filters {
namespace {

double variance(const ScalarGrid& grid) {
  double sum = 0.0;
  for (std::size_t i = 0; i < grid.points().size(); ++i) {
    sum += grid.masses()[i] * std::pow(grid.points()[i] - grid.mean(), 2);
  }
  return sum;
}

TEST(ScalarGrid, IsKalmansFilterOnALinearModel) {
  ScalarGrid grid(-20.0, 20.0, 401);
  grid.set_normal(1.0, 2.0);
  double mean = 1.0, expected_variance = 4.0;
  std::vector<double> images(401), log_likelihoods(401);
  Rng rng(1);
  for (int step = 0; step < 20; ++step) {
    for (std::size_t i = 0; i < images.size(); ++i) images[i] = 0.8 * grid.points()[i] + 0.37;
    const double before = grid.mean();
    grid.predict(images, 1.3);
    EXPECT_NEAR(grid.mean(), 0.8 * before + 0.37, 1e-9);
    mean = 0.8 * mean + 0.37;
    expected_variance = 0.64 * expected_variance + 1.69;
    EXPECT_NEAR(variance(grid), expected_variance, 2e-3);
    const double z = 2.0 * rng.normal();
    for (std::size_t i = 0; i < images.size(); ++i) log_likelihoods[i] = -0.5 * std::pow(z - grid.points()[i], 2) / 0.5;
    grid.update(log_likelihoods);
    const double gain = expected_variance / (expected_variance + 0.5);
    mean += gain * (z - mean);
    expected_variance *= 1.0 - gain;
    EXPECT_NEAR(grid.mean(), mean, 2e-3);
    EXPECT_NEAR(variance(grid), expected_variance, 2e-3);
  }
}

TEST(ScalarGrid, KeepsAllMassAndIgnoresImpossibleMeasurements) {
  ScalarGrid grid(0.0, 1.0, 11);
  grid.set_normal(0.5, 0.2);
  const std::vector<double> far(11, 9.0);
  grid.predict(far, 0.1);
  EXPECT_NEAR(std::accumulate(grid.masses().begin(), grid.masses().end(), 0.0), 1.0, 1e-12);
  EXPECT_GT(grid.mean(), 0.8);
  const double before = grid.mean();
  grid.update(std::vector<double>(11, -1e308));
  EXPECT_NEAR(grid.mean(), before, 1e-12);
  EXPECT_THROW(ScalarGrid(1.0, 1.0, 5), std::invalid_argument);
  EXPECT_THROW(ScalarGrid(0.0, 1.0, 1), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::filters
