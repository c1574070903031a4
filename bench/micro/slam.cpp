/// Cost of the particle SLAM filter per echo and particle, beside a plain loop of range-bearing EKF updates.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "core/rng.hpp"
#include "filters/slam/particle_slam.hpp"

namespace {

using namespace noctule;

/// A heptagon of walls with two cylinders and a rod inside: ten objects. The robot goes round between them; half of
/// its 60 pings a stop are heard.
struct Room {
  std::vector<Wall> walls;
  std::vector<Cylinder> cylinders{{{0.3, 0.2}, 0.11}, {{-0.4, -0.3}, 0.14}, {{0.2, -0.5}, 0.0}};
  Room() {
    for (int k = 0; k < 7; ++k) walls.push_back({2.0, wrap(0.3 + kTwoPi * k / 7)});
  }
  [[nodiscard]] std::size_t objects() const { return walls.size() + cylinders.size(); }
  [[nodiscard]] double distance(std::size_t k, const Vector2& p) const {
    return k < walls.size() ? walls[k].distance(p) : cylinders[k - walls.size()].distance(p);
  }
  [[nodiscard]] double direction(std::size_t k, const Vector2& p) const {
    if (k < walls.size()) return walls[k].theta;
    const Vector2 d = cylinders[k - walls.size()].centre - p;
    return std::atan2(d.y(), d.x());
  }
};

struct Stop {
  Odometry odometry;
  UltrasonicScan scan;
  ContourFeatures features;
};

std::vector<Stop> drive_round(int stops) {
  const Room room;
  Rng rng(1);
  const models::RangeNoise noise;
  std::vector<Stop> result;
  Odometry step;
  step.increment = {0.12, 0.0, 0.1};
  step.covariance.diagonal() << 2e-5, 1e-5, 7e-4;
  Pose2 base{0.0, -1.2, 0.0};
  for (int s = 0; s < stops; ++s) {
    Stop stop;
    if (s > 0) stop.odometry = step;
    base = base * stop.odometry.increment;
    stop.scan.stamp = stop.features.stamp = {s, s};
    stop.scan.half_angle = radians(15.0);
    std::vector<ContourFeature> feature_of(room.objects());
    for (int b = 0; b < 60; ++b) {
      UltrasonicBeam beam{.sensor_in_base = {0.0, 0.0, wrap(kTwoPi * b / 60)}, .range = 0.0, .echo = Echo::none};
      std::size_t object = 0;
      for (std::size_t k = 0; k < room.objects(); ++k) {
        const double off = wrap(room.direction(k, base.position()) - base.yaw - beam.sensor_in_base.yaw);
        const double range = room.distance(k, base.position());
        if (std::abs(off) > stop.scan.half_angle || (beam.echo == Echo::hit && range > beam.range)) continue;
        beam.range = range;
        beam.echo = Echo::hit;
        object = k;
      }
      if (beam.echo == Echo::hit) {
        beam.range += rng.normal(0.0, noise.sd(beam.range));
        feature_of[object].readings.push_back({s, b});
      }
      stop.scan.beams.push_back(beam);
    }
    for (std::size_t k = 0; k < room.objects(); ++k) {
      ContourFeature& f = feature_of[k];
      if (f.readings.empty()) continue;
      f.type = k < room.walls.size() ? ContourType::wall : ContourType::arc;
      const double direction = room.direction(k, base.position()) - base.yaw;
      f.surface = room.distance(k, base.position()) * Vector2(std::cos(direction), std::sin(direction));
      stop.features.features.push_back(f);
    }
    result.push_back(std::move(stop));
  }
  return result;
}

/// Whole runs of 60 stops: motion, association, updates, weights, resampling, estimate. CPU time is that of all
/// threads.
void run_filter(benchmark::State& state, filters::ParticleSlamParameters parameters) {
  const auto stops = drive_round(60);
  double echoes = 0.0;
  for (const Stop& stop : stops) {
    for (const auto& beam : stop.scan.beams) echoes += beam.echo == Echo::hit;
  }
  parameters.particles = static_cast<int>(state.range(0));
  parameters.threads = static_cast<int>(state.range(1));
  std::size_t landmarks = 0;
  for (auto _ : state) {
    filters::ParticleSlam filter(parameters, 1, {0.0, -1.2, 0.0});
    for (const Stop& stop : stops) {
      filter.predict(stop.odometry);
      filter.update(stop.scan, stop.features);
    }
    landmarks = filter.map().landmarks.size();
    benchmark::DoNotOptimize(filter.estimate());
  }
  state.counters["per_echo_and_particle"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * echoes * parameters.particles,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["landmarks"] = static_cast<double>(landmarks);
}

void particle_slam(benchmark::State& state) {
  run_filter(state, {});
}
BENCHMARK(particle_slam)
    ->ArgNames({"particles", "threads"})
    ->Args({20, 1})
    ->Args({100, 1})
    ->Args({100, 2})
    ->Args({1000, 1})
    ->Args({1000, 2})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// The same, learning the noise.
void particle_slam_learning(benchmark::State& state) {
  run_filter(state, filters::VbParticleSlamParameters());
}
BENCHMARK(particle_slam_learning)
    ->ArgNames({"particles", "threads"})
    ->Args({20, 1})
    ->Args({100, 1})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// Smoothing the path of so many stops once.
void path_smoothing(benchmark::State& state) {
  filters::ParticleSlamParameters parameters;
  parameters.particles = 20;
  parameters.smooth_path = filters::SmoothPath::all;
  filters::ParticleSlam filter(parameters, 1, {0.0, -1.2, 0.0});
  for (const Stop& stop : drive_round(static_cast<int>(state.range(0)))) {
    filter.predict(stop.odometry);
    filter.update(stop.scan, stop.features);
  }
  for (auto _ : state) benchmark::DoNotOptimize(filter.smoothed());
}
BENCHMARK(path_smoothing)->ArgName("stops")->Arg(60)->Arg(600)->Unit(benchmark::kMillisecond);

/// The reference: predicted range and bearing, 2 x 2 innovation covariance by hand, gain, update and log likelihood of
/// `range(0)` particles times 10 landmarks; no particles, no association.
void plain_ekf(benchmark::State& state) {
  struct Landmark {
    double x, y, p00, p01, p11;
  };
  constexpr double r00 = 0.01, r11 = 1e-3;
  const auto n = static_cast<std::size_t>(state.range(0)) * 10;
  Rng rng(1);
  std::vector<Landmark> start(n);
  for (auto& l : start) l = {rng.uniform(1, 5), rng.uniform(1, 5), 0.01, 0.001, 0.02};
  std::vector<Landmark> map = start;
  double log_weight = 0.0;
  for (auto _ : state) {
    for (Landmark& l : map) {
      const double q = l.x * l.x + l.y * l.y, r = std::sqrt(q);
      const double h00 = l.x / r, h01 = l.y / r, h10 = -l.y / q, h11 = l.x / q;
      const double v0 = 4.0 - r, v1 = wrap(0.7 - std::atan2(l.y, l.x));
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
      log_weight -= 0.5 * (v0 * v0 * i00 + 2.0 * v0 * v1 * i01 + v1 * v1 * i11 + std::log(d));
    }
    benchmark::DoNotOptimize(log_weight);
    benchmark::ClobberMemory();
  }
  state.counters["per_update"] = benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(n),
                                                    benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(plain_ekf)->Arg(100)->Arg(1000);

}  // namespace
