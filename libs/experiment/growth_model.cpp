#include "experiment/growth_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "config/config.hpp"
#include "core/error.hpp"
#include "filters/scalar_grid.hpp"
#include "models/growth_model.hpp"

namespace noctule::experiment {
namespace {

using models::GrowthModel;
using particle::Improvement;

constexpr std::pair<const char*, Improvement> kParticleFilters[] = {
    {"pf", Improvement::none},
    {"pso_pf", Improvement::pso},
    {"bat_pf", Improvement::bat},
    {"apf", Improvement::apf},
    {"resample_move", Improvement::resample_move},
    {"apf_resample_move", Improvement::apf_resample_move}};

/// What every filter is fed, and the truth.
struct GrowthRun {
  std::vector<double> states, measurements;  ///< after each step
};

GrowthModel model_of(const GrowthModelParameters& p) {
  return {std::sqrt(p.process_variance), std::sqrt(p.measurement_variance), std::sqrt(p.initial_variance)};
}

GrowthRun simulate(const GrowthModel& model, int steps, std::uint64_t seed) {
  Rng start(seed, stream_id("growth_model.start")), process(seed, stream_id("growth_model.process")),
      measurement(seed, stream_id("growth_model.measurement"));
  GrowthRun stream;
  double x = model.initial_deviation * start.normal();
  for (int step = 1; step <= steps; ++step) {
    model.motion(step)(&x, &x);
    x += model.process_sd * process.normal();
    stream.states.push_back(x);
    stream.measurements.push_back(model.expected_measurement(x) + model.measurement_sd * measurement.normal());
  }
  return stream;
}

struct GrowthTrack {
  std::vector<double> means;
  std::vector<double> effective, distinct;  ///< of particle filters: sample size, and share of distinct states
  double seconds = 0.0;
};

/// The exact posterior mean, or the prediction without measurements.
GrowthTrack grid_filter(const GrowthModel& model, const GrowthRun& stream, bool measures) {
  const double begin = cpu_seconds();
  // Beyond +-60 nothing comes with these variances: the drift halves what is large.
  filters::ScalarGrid grid(-60.0, 60.0, 1201);
  grid.set_normal(0.0, model.initial_deviation);
  std::vector<double> images(grid.points().size()), log_likelihoods(images.size());
  GrowthTrack result;
  for (std::size_t t = 0; t < stream.measurements.size(); ++t) {
    const auto motion = model.motion(static_cast<int>(t) + 1);
    for (std::size_t i = 0; i < images.size(); ++i) motion(&grid.points()[i], &images[i]);
    grid.predict(images, model.process_sd);
    if (measures) {
      for (std::size_t i = 0; i < images.size(); ++i) {
        log_likelihoods[i] = model.log_likelihood(&grid.points()[i], stream.measurements[t]);
      }
      grid.update(log_likelihoods);
    }
    result.means.push_back(grid.mean());
  }
  result.seconds = cpu_seconds() - begin;
  return result;
}

double distinct_share(std::span<double> states) {
  std::ranges::sort(states);
  const auto rest = std::ranges::unique(states);
  return static_cast<double>(rest.begin() - states.begin()) / static_cast<double>(states.size());
}

GrowthTrack particle_filter(const GrowthModel& model, const particle::StateFilterParameters& parameters,
                            const GrowthRun& stream, std::uint64_t seed) {
  const std::size_t steps = stream.measurements.size();
  const auto n = static_cast<std::size_t>(parameters.particles);
  GrowthTrack result{std::vector<double>(steps), std::vector<double>(steps), {}};
  std::vector<double> clouds(steps * n);  // looked at when the clock stands
  const double begin = cpu_seconds();
  particle::StateFilter<GrowthModel> filter(model, parameters, seed);
  for (std::size_t t = 0; t < steps; ++t) {
    filter.update(stream.measurements[t]);
    result.means[t] = filter.mean()[0];
    result.effective[t] = filter.effective_sample_size();
    std::copy_n(filter.states().values, n, clouds.begin() + static_cast<std::ptrdiff_t>(t * n));
  }
  result.seconds = cpu_seconds() - begin;
  for (std::size_t t = 0; t < steps; ++t)
    result.distinct.push_back(distinct_share(std::span(clouds).subspan(t * n, n)));
  return result;
}

bool is_particle_filter(const std::string& name) {
  return std::ranges::any_of(kParticleFilters, [&](const auto& filter) { return name == filter.first; });
}

Improvement improvement_of(const std::string& name) {
  return std::ranges::find_if(kParticleFilters, [&](const auto& filter) { return name == filter.first; })->second;
}

/// \throws InputError for keys that belong to another filter
GrowthFilterParameters parameters_of(const FilterSpec& spec) {
  const auto p = config::load<GrowthFilterParameters>(effective_config(spec));
  const Improvement i = improvement_of(spec.name);
  const auto refuse_unless = [&](bool sound, const char* group, const char* owners) {
    if (!sound) throw InputError("filter '" + spec.name + "': " + group + ": belongs to " + owners + " only");
  };
  const bool both = i == Improvement::apf_resample_move;
  refuse_unless(!p.swarm || i == Improvement::pso || i == Improvement::bat, "swarm", "pso_pf and bat_pf");
  refuse_unless(!p.apf || i == Improvement::apf || both, "apf", "apf and apf_resample_move");
  refuse_unless(!p.moves || i == Improvement::resample_move || both, "moves", "resample_move and apf_resample_move");
  return p;
}

GrowthTrack run_filter(const GrowthModel& truth, const FilterSpec& spec, const GrowthRun& stream, std::uint64_t seed) {
  if (!is_particle_filter(spec.name)) return grid_filter(truth, stream, spec.name == "oracle");
  const GrowthFilterParameters p = parameters_of(spec);
  GrowthModel model = truth;
  if (p.filter_q == FilterQ::one) model.process_sd = 1.0;
  return particle_filter(model,
                         {.particles = p.particles,
                          .resampling = p.resampling,
                          .improvement = improvement_of(spec.name),
                          .swarm = p.swarm.value_or(particle::SwarmParameters{}),
                          .apf = p.apf.value_or(particle::ApfParameters{}),
                          .moves = p.moves.value_or(particle::ResampleMoveParameters{})},
                         stream, seed);
}

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

FilterRun measured(const GrowthTrack& result, const GrowthRun& stream) {
  Series errors{"absolute_error", "1", {}, {}};
  double squares = 0.0;
  for (std::size_t t = 0; t < stream.states.size(); ++t) {
    const double error = result.means[t] - stream.states[t];
    squares += error * error;
    errors.time.push_back(static_cast<double>(t + 1));
    errors.values.push_back(std::abs(error));
  }
  const auto steps = static_cast<double>(stream.states.size());
  FilterRun run{.figures = {{"state_rmse", std::sqrt(squares / steps), "1"}},
                .timings = {{"cpu_per_step", result.seconds / steps, "s"}},
                .series = {std::move(errors)},
                .diverged = !std::isfinite(squares)};
  if (!result.effective.empty()) {
    run.figures.push_back({"distinct_fraction", mean_of(result.distinct), "1"});
    run.figures.push_back({"ess", mean_of(result.effective), "1"});
  }
  return run;
}

}  // namespace

GrowthModelRuns::GrowthModelRuns(const ScenarioSpec& spec)
    : parameters_(config::load<GrowthModelParameters>(spec.config)) {}

std::vector<std::string> GrowthModelRuns::filters() const {
  std::vector<std::string> names;
  for (const auto& filter : kParticleFilters) names.emplace_back(filter.first);
  names.insert(names.end(), {"oracle", "dead_reckoning"});
  return names;
}

std::vector<std::string> GrowthModelRuns::metrics() const {
  return {"state_rmse", "distinct_fraction", "ess", "absolute_error"};
}

void GrowthModelRuns::check(const FilterSpec& filter) const {
  if (is_particle_filter(filter.name)) static_cast<void>(parameters_of(filter));
}

std::vector<FilterRun> GrowthModelRuns::run(std::uint64_t seed, std::span<const FilterSpec> filters) const {
  const GrowthModel model = model_of(parameters_);
  const GrowthRun stream = simulate(model, parameters_.steps, seed);
  std::vector<FilterRun> runs;
  for (const FilterSpec& spec : filters) runs.push_back(measured(run_filter(model, spec, stream, seed), stream));
  return runs;
}

}  // namespace noctule::experiment
