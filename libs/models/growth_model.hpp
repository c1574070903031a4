#pragma once
/// The univariate nonlinear growth model, the usual trial of particle filters (Gordon, Salmond, Smith 1993; paper 002,
/// eqs. 10 and 11): x_t = x/2 + 25 x / (1 + x^2) + 8 cos(1.2 (t - 1)) + u, z = x^2 / 20 + v. The sign of x is not
/// measured: its posterior often has two modes.
#include <array>
#include <cmath>
#include <cstdint>

namespace noctule::models {

struct GrowthModel {
  double process_sd = std::sqrt(10.0);
  double measurement_sd = 1.0;
  double initial_deviation = 1.0;  ///< of x_0, about 0

  static constexpr int kDimension = 1;
  static constexpr std::uint32_t kAngles = 0;
  using Measurement = double;

  /// What of the motion does not depend on time.
  [[nodiscard]] static double drift(double x) { return 0.5 * x + 25.0 * x / (1.0 + x * x); }
  [[nodiscard]] static double forcing(int step) { return 8.0 * std::cos(1.2 * (step - 1)); }
  [[nodiscard]] static double expected_measurement(double x) { return x * x / 20.0; }

  [[nodiscard]] static auto motion(int step) {
    return [shift = forcing(step)](const double* x, double* mean) { *mean = drift(*x) + shift; };
  }
  [[nodiscard]] std::array<double, 1> noise_sd() const { return {process_sd}; }
  [[nodiscard]] static std::array<double, 1> initial_mean() { return {0.0}; }
  [[nodiscard]] std::array<double, 1> initial_sd() const { return {initial_deviation}; }
  [[nodiscard]] double log_likelihood(const double* x, double z) const {
    const double e = (z - expected_measurement(*x)) / measurement_sd;
    return -0.5 * e * e;
  }
};

}  // namespace noctule::models
