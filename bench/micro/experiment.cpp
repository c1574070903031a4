/// What the experiment bench itself costs: a scenario whose filters take no time, so that all time is the bench's.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>

#include "config/config.hpp"
#include "core/rng.hpp"
#include "experiment/comparison.hpp"
#include "experiment/report.hpp"
#include "experiment/runner.hpp"

namespace noctule::experiment {
namespace {

constexpr const char* kExperiment = R"(
name: nothing
last_seed: 200
scenarios: [{name: nothing, kind: nothing}]
filters: [{name: a, parameters: {N: [20, 30, 50, 100]}}, {name: b, parameters: {N: [20, 30, 50, 100]}}]
)";

/// Six figures, a timing and a curve of 100 steps a run.
class Nothing : public Scenario {
 public:
  [[nodiscard]] std::vector<std::string> filters() const override { return {"a", "b"}; }
  [[nodiscard]] std::vector<std::string> metrics() const override {
    return {"e0", "e1", "e2", "e3", "e4", "e5", "curve"};
  }
  void check(const FilterSpec&) const override {}
  [[nodiscard]] std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec> filters) const override {
    Rng rng(seed);
    FilterRun run;
    for (const std::string& name : metrics()) run.figures.push_back({name, rng.normal(), "m"});
    run.figures.pop_back();
    run.timings = {{"cpu_per_step", 1e-3, "s"}};
    run.series = {{"curve", "m", std::vector<double>(100), std::vector<double>(100)}};
    for (std::size_t i = 0; i < 100; ++i) {
      run.series[0].time[i] = 0.1 * static_cast<double>(i);
      run.series[0].values[i] = rng.normal();
    }
    return std::vector<FilterRun>(filters.size(), run);
  }
};

std::filesystem::path folder() {
  return std::filesystem::temp_directory_path() / ("noctule_bench_experiment_" + std::to_string(getpid()));
}

Plan plan() {
  return make_plan(config::parse<Experiment>(kExperiment),
                   [](const ScenarioSpec&) { return std::make_unique<Nothing>(); });
}

/// Runner, parts and tables, a run of one filter over one seed.
void BM_Run(benchmark::State& state) {
  const Plan what = plan();
  for (auto _ : state) {
    std::filesystem::remove_all(folder());
    run(what, {.directory = folder()}, [](const Progress&) { return true; });
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(what.runs()));
}
BENCHMARK(BM_Run)->Unit(benchmark::kMillisecond);

/// The report of these 1600 runs.
void BM_Report(benchmark::State& state) {
  run(plan(), {.directory = folder()}, [](const Progress&) { return true; });
  for (auto _ : state) write_report(folder());
  std::filesystem::remove_all(folder());
}
BENCHMARK(BM_Report)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace noctule::experiment
