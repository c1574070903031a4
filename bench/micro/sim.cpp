/// The simulated heptagon: time of a ping, of a run, and of its parts.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "config/config.hpp"
#include "sim/simulator.hpp"

namespace {

using namespace noctule;

const std::filesystem::path kConfig = std::filesystem::path(NOCTULE_SOURCE_DIR) / "config";

sim::WorldParameters world() {
  return config::load<sim::WorldParameters>(kConfig / "worlds/heptagon.yaml");
}
sim::RobotParameters robot(const char* name) {
  return config::load<sim::RobotParameters>(kConfig / "robots" / (std::string(name) + ".yaml"));
}

/// Geometry alone: all echoes of one ping.
void echoes(benchmark::State& state) {
  const sim::EchoScene scene{sim::RoomGeometry(world().room)};
  std::vector<sim::EchoPath> found;
  found.reserve(scene.size());
  int k = 0;
  for (auto _ : state) {
    const Pose2 sensor{1.2, 0.4, radians(6.0 * (k++ % 60))};
    found.clear();
    scene.find(sensor, sensor, radians(15), found);
    benchmark::DoNotOptimize(found.data());
  }
}
BENCHMARK(echoes);

/// Scans with hearing and noise; the time is that of one ping.
void ping(benchmark::State& state, const char* name, sim::Firing firing) {
  sim::SonarParameters parameters = robot(name).sonar;
  parameters.firing = firing;
  sim::Sonar sonar(parameters, sim::RoomGeometry(world().room), 1);
  const auto pings = static_cast<double>(parameters.beams().size());
  std::int64_t scan = 0;
  for (auto _ : state) benchmark::DoNotOptimize(sonar.scan({1.2, 0.4, 0.3}, scan++, 1.0));
  state.counters["per_ping"] =
      benchmark::Counter(pings, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(ping, stepper, "paper002", sim::Firing::one_by_one);
BENCHMARK_CAPTURE(ping, ring24, "ring24", sim::Firing::one_by_one);
BENCHMARK_CAPTURE(ping, ring24_in_parallel, "ring24", sim::Firing::parallel);

/// The whole pinned run, set-up included.
void run(benchmark::State& state) {
  const auto w = world();
  const auto r = robot("paper002");
  for (auto _ : state) {
    sim::Simulator simulator(w, r, 1);
    while (auto observation = simulator.next()) benchmark::DoNotOptimize(observation);
  }
}
BENCHMARK(run)->Unit(benchmark::kMillisecond);

}  // namespace
