/// Cost of the landmark filters per particle and landmark, beside a plain loop of range-bearing EKF updates; time and
/// memory against the number of particles and the size of the map.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "core/rng.hpp"
#include "filters/slam/fastslam.hpp"
#include "filters/slam/ufastslam.hpp"
#include "particle/parallel.hpp"

namespace {

using namespace noctule;

constexpr int kSeen = 10;  ///< landmarks a cycle

/// A robot that hardly moves and sees ten landmarks at a time, those next to each other in a map that comes round again
/// and again: by the second lap all are known.
struct Lap {
  std::vector<LandmarkDetections> scans;
  Odometry step;

  explicit Lap(int map) {
    step.covariance.diagonal() << 1e-3, 1e-3, 1e-4;
    Rng rng(1);
    std::vector<LandmarkDetection> all;
    for (int k = 0; k < map; ++k) {
      all.push_back({.range = rng.uniform(2.0, 30.0),
                     .bearing = rng.uniform(-1.2, 1.2),
                     .covariance = Vector2(0.04, 1e-3).asDiagonal(),
                     .id = k});
    }
    for (std::size_t first = 0; first + kSeen <= all.size(); first += kSeen) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
      scans.emplace_back().detections.assign(begin, begin + kSeen);
    }
  }

  template <class Filter>
  void cycle(Filter& filter, std::int64_t seq, int predictions = 1) {
    LandmarkDetections& scan = scans[static_cast<std::size_t>(seq) % scans.size()];
    scan.stamp = {seq * 100000, seq};
    for (int k = 0; k < predictions; ++k) filter.predict(step);
    filter.update(scan);
  }
};

void report(benchmark::State& state, const char* name, double count) {
  state.counters[name] = benchmark::Counter(static_cast<double>(state.iterations()) * count,
                                            benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// The reference, as a careful programmer writes it: 2 x 2 innovation covariance by hand, gain, update and log
/// likelihood of 10 landmarks of each particle, out of maps of M. No motion, no weights, no resampling.
void plain_ekf(benchmark::State& state) {
  struct Landmark {
    double x, y, p00, p01, p11;
  };
  struct Particle {
    double x, y, yaw, log_weight;
  };
  constexpr double r00 = 0.04, r11 = 1e-3;
  const auto n = static_cast<std::size_t>(state.range(0)), m = static_cast<std::size_t>(state.range(1));
  Rng rng(1);
  std::vector<Landmark> map(n * m);
  std::vector<Particle> particles(n);
  for (auto& l : map) l = {rng.uniform(2, 20), rng.uniform(-10, 10), 0.1, 0.01, 0.1};
  for (auto& p : particles) p = {rng.normal(0.0, 0.01), rng.normal(0.0, 0.01), rng.normal(0.0, 0.01), 0.0};
  std::vector<double> range(m), bearing(m);
  for (std::size_t k = 0; k < m; ++k) {
    range[k] = std::hypot(map[k].x, map[k].y);
    bearing[k] = std::atan2(map[k].y, map[k].x);
  }
  std::size_t first = 0;
  for (auto _ : state) {
    for (std::size_t i = 0; i < n; ++i) {
      Particle& p = particles[i];
      for (std::size_t k = first; k < first + kSeen; ++k) {
        Landmark& l = map[i * m + k];
        const double dx = l.x - p.x, dy = l.y - p.y, q = dx * dx + dy * dy, r = std::sqrt(q);
        const double h00 = dx / r, h01 = dy / r, h10 = -dy / q, h11 = dx / q;
        const double v0 = range[k] - r, v1 = wrap(bearing[k] - std::atan2(dy, dx) + p.yaw);
        const double a00 = l.p00 * h00 + l.p01 * h01, a10 = l.p01 * h00 + l.p11 * h01;
        const double a01 = l.p00 * h10 + l.p01 * h11, a11 = l.p01 * h10 + l.p11 * h11;
        const double s00 = h00 * a00 + h01 * a10 + r00, s01 = h00 * a01 + h01 * a11, s11 = h10 * a01 + h11 * a11 + r11;
        const double d = s00 * s11 - s01 * s01, i00 = s11 / d, i01 = -s01 / d, i11 = s00 / d;
        const double k00 = a00 * i00 + a01 * i01, k01 = a00 * i01 + a01 * i11;
        const double k10 = a10 * i00 + a11 * i01, k11 = a10 * i01 + a11 * i11;
        l.x += k00 * v0 + k01 * v1;
        l.y += k10 * v0 + k11 * v1;
        l.p00 -= k00 * a00 + k01 * a01;
        l.p01 -= k00 * a10 + k01 * a11;
        l.p11 -= k10 * a10 + k11 * a11;
        p.log_weight -= 0.5 * (v0 * v0 * i00 + 2.0 * v0 * v1 * i01 + v1 * v1 * i11 + std::log(d)) + std::log(kTwoPi);
      }
    }
    first = first + 2 * kSeen <= m ? first + kSeen : 0;
    benchmark::DoNotOptimize(particles.data());
    benchmark::ClobberMemory();
  }
  report(state, "per_landmark", static_cast<double>(n) * kSeen);
}

/// One prediction and ten known landmarks a cycle; resampling (whenever weights differ) and estimate included.
template <class Filter, class Parameters>
void cycles(benchmark::State& state, Parameters parameters) {
  parameters.particles = static_cast<int>(state.range(0));
  parameters.threads = static_cast<int>(state.range(2));
  parameters.resample_below = 1.0;
  Lap lap(static_cast<int>(state.range(1)));
  Filter filter(parameters, 1);
  std::int64_t seq = 0;
  for (std::size_t k = 0; k < 2 * lap.scans.size() + 2; ++k) lap.cycle(filter, seq++);
  double resampled = 0.0, distinct = 0.0;
  for (auto _ : state) {
    lap.cycle(filter, seq++);
    resampled += filter.estimate().resampled;
    distinct += filter.estimate().distinct_particles;
  }
  report(state, "per_landmark", static_cast<double>(parameters.particles) * kSeen);
  state.counters["map_bytes"] = static_cast<double>(filter.map_bytes()) / parameters.particles;
  state.counters["resampled"] = resampled / static_cast<double>(state.iterations());
  state.counters["survivors"] = distinct / static_cast<double>(state.iterations()) / parameters.particles;
}

void fastslam1(benchmark::State& state) {
  cycles<filters::FastSlam1>(state, filters::FastSlam1Parameters{});
}
void fastslam1_flat(benchmark::State& state) {
  filters::FastSlam1Parameters p;
  p.storage = filters::MapStorage::flat;
  cycles<filters::FastSlam1>(state, p);
}
void fastslam1_shared(benchmark::State& state) {
  filters::FastSlam1Parameters p;
  p.storage = filters::MapStorage::shared;
  cycles<filters::FastSlam1>(state, p);
}
void fastslam2(benchmark::State& state) {
  cycles<filters::FastSlam2>(state, filters::FastSlam2Parameters{});
}
void ufastslam(benchmark::State& state) {
  cycles<filters::UFastSlam>(state, filters::UFastSlamParameters{});
}

/// Eight predictions and 1.05 landmarks a cycle, as on Bailey's web map.
template <class Filter, class Parameters>
void web_cycles(benchmark::State& state, Parameters parameters) {
  parameters.particles = static_cast<int>(state.range(0));
  parameters.threads = 1;
  Lap lap(200);
  for (auto& scan : lap.scans) scan.detections.resize(1);
  lap.scans[0].detections.push_back(lap.scans[1].detections[0]);
  Filter filter(parameters, 1);
  std::int64_t seq = 0;
  for (int k = 0; k < 100; ++k) lap.cycle(filter, seq++, 8);
  double resampled = 0.0;
  for (auto _ : state) {
    lap.cycle(filter, seq++, 8);
    resampled += filter.estimate().resampled;
  }
  report(state, "per_particle", static_cast<double>(parameters.particles));
  state.counters["resampled"] = resampled / static_cast<double>(state.iterations());
}
void web_fastslam1(benchmark::State& state) {
  web_cycles<filters::FastSlam1>(state, filters::FastSlam1Parameters{});
}
void web_fastslam2(benchmark::State& state) {
  web_cycles<filters::FastSlam2>(state, filters::FastSlam2Parameters{});
}

void with_sizes(benchmark::internal::Benchmark* b, const std::vector<std::int64_t>& particles,
                const std::vector<std::int64_t>& maps) {
  b->ArgNames({"particles", "map", "threads"})->ArgsProduct({particles, maps, {1}});
}
void sizes(benchmark::internal::Benchmark* b) {
  with_sizes(b, {100, 1000}, {10, 100, 1000});
}

BENCHMARK(plain_ekf)->ArgNames({"particles", "map"})->ArgsProduct({{100, 1000}, {10, 100, 1000}});
BENCHMARK(fastslam1)->Apply(sizes);
BENCHMARK(fastslam2)->Apply(sizes);
BENCHMARK(ufastslam)->Apply(sizes);
BENCHMARK(web_fastslam1)->ArgName("particles")->Arg(20)->Arg(100)->Arg(1000);
BENCHMARK(web_fastslam2)->ArgName("particles")->Arg(20)->Arg(100)->Arg(1000);
/// What the same cores give a loop that is arithmetic alone, over as many particles: the limit of any scaling.
void plain_threads(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  std::vector<double> sums(n);
  for (auto _ : state) {
    particle::for_blocks(n, static_cast<int>(state.range(1)), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        double x = 1.0 + 1e-3 * static_cast<double>(i);
        for (int k = 0; k < 60; ++k) x = 0.5 * (x + 2.0 / x);
        sums[i] = x;
      }
    });
    benchmark::DoNotOptimize(sums.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(plain_threads)->ArgNames({"particles", "threads"})->ArgsProduct({{500, 1000}, {1, 2}})->UseRealTime();
/// The second core.
BENCHMARK(fastslam1)
    ->Name("threads")
    ->ArgNames({"particles", "map", "threads"})
    ->ArgsProduct({{500, 1000}, {100}, {1, 2}})
    ->UseRealTime();
/// Which storage wins, and what a cycle and a particle's map cost as maps and particles grow.
BENCHMARK(fastslam1_flat)->Apply([](auto* b) { with_sizes(b, {100}, {20, 40, 80, 160, 320, 640}); });
BENCHMARK(fastslam1_shared)->Apply([](auto* b) { with_sizes(b, {100}, {20, 40, 80, 160, 320, 640}); });
BENCHMARK(fastslam1)->Name("growth_in_map")->Apply([](auto* b) { with_sizes(b, {100}, {10, 100, 1000, 10000}); });
BENCHMARK(fastslam1)->Name("growth_in_particles")->Apply([](auto* b) {
  with_sizes(b, {10, 100, 1000, 10000}, {1000});
});

}  // namespace
