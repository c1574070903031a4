/// Cost of one step of a particle filter, ns a particle, plain and with each way to better the particles: a scalar
/// state (growth model) and a pose that sees two landmarks.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/angles.hpp"
#include "models/growth_model.hpp"
#include "particle/state_filter.hpp"

namespace {

using noctule::Rng;
using noctule::particle::Improvement;
using noctule::particle::StateFilter;
using noctule::particle::StateFilterParameters;

/// A vehicle on a circle that sees range and bearing of two landmarks, as filters of poses do.
struct Vehicle {
  static constexpr int kDimension = 3;
  static constexpr std::uint32_t kAngles = 0b100;
  using Measurement = std::array<double, 4>;  ///< range and bearing, twice
  static constexpr double kLandmarks[2][2] = {{12.0, 3.0}, {-4.0, 9.0}};

  static auto motion(int) {
    return [](const double* x, double* mean) {
      mean[0] = x[0] + 0.5 * std::cos(x[2]);
      mean[1] = x[1] + 0.5 * std::sin(x[2]);
      mean[2] = x[2] + 0.1;
    };
  }
  static std::array<double, 3> noise_sd() { return {0.1, 0.1, 0.03}; }
  static std::array<double, 3> initial_mean() { return {0.0, 0.0, 0.0}; }
  static std::array<double, 3> initial_sd() { return {0.1, 0.1, 0.03}; }
  static Measurement expected(const double* x) {
    Measurement z{};
    for (std::size_t k = 0; k < 2; ++k) {
      const double dx = kLandmarks[k][0] - x[0], dy = kLandmarks[k][1] - x[1];
      z[2 * k] = std::sqrt(dx * dx + dy * dy);
      z[2 * k + 1] = noctule::wrap(std::atan2(dy, dx) - x[2]);
    }
    return z;
  }
  static double log_likelihood(const double* x, const Measurement& z) {
    const Measurement e = expected(x);
    double sum = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double range = (z[2 * k] - e[2 * k]) / 0.1, bearing = noctule::wrap(z[2 * k + 1] - e[2 * k + 1]) / 0.03;
      sum += range * range + bearing * bearing;
    }
    return -0.5 * sum;
  }
};

std::vector<double> measurements(const noctule::models::GrowthModel& model) {
  Rng rng(1);
  std::vector<double> z;
  double x = rng.normal();
  for (int step = 1; step <= 200; ++step) {
    model.motion(step)(&x, &x);
    x += model.process_sd * rng.normal();
    z.push_back(model.expected_measurement(x) + model.measurement_sd * rng.normal());
  }
  return z;
}
std::vector<Vehicle::Measurement> measurements(const Vehicle& model) {
  Rng rng(1);
  std::vector<Vehicle::Measurement> z;
  double x[3] = {0.0, 0.0, 0.0};
  for (int step = 1; step <= 200; ++step) {
    double mean[3];
    model.motion(step)(x, mean);
    for (std::size_t k = 0; k < 3; ++k) x[k] = mean[k] + model.noise_sd()[k] * rng.normal();
    z.push_back(model.expected(x));
    for (std::size_t k = 0; k < 4; ++k) z.back()[k] += (k % 2 == 0 ? 0.1 : 0.03) * rng.normal();
  }
  return z;
}

template <class Model>
void step(benchmark::State& state, Improvement improvement) {
  StateFilterParameters parameters;
  parameters.particles = static_cast<int>(state.range(0));
  parameters.improvement = improvement;
  const Model model;
  const auto z = measurements(model);
  StateFilter<Model> filter(model, parameters, 1);
  std::size_t at = 0;
  for (auto _ : state) {
    filter.update(z[at]);
    benchmark::DoNotOptimize(filter.mean());
    if (++at == z.size()) {
      state.PauseTiming();
      filter = StateFilter<Model>(model, parameters, 1);
      at = 0;
      state.ResumeTiming();
    }
  }
  state.counters["per_particle"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(state.range(0)),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class Model>
int add(const std::string& name) {
  for (const auto& [way, improvement] :
       {std::pair("pf", Improvement::none), std::pair("apf", Improvement::apf), std::pair("pso_pf", Improvement::pso),
        std::pair("bat_pf", Improvement::bat), std::pair("resample_move", Improvement::resample_move)}) {
    const std::string title = name + "/" + way;
    benchmark::RegisterBenchmark(title.c_str(), step<Model>, improvement)->Arg(20)->Arg(100)->Arg(1000)->Arg(10000);
  }
  return 0;
}
const int kAdded = add<noctule::models::GrowthModel>("scalar") + add<Vehicle>("pose");

}  // namespace
