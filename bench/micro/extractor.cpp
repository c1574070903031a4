/// The ultrasonic extractor, from one closed form to a whole scan, beside a plain reference: the same triple fitted as
/// wall, point and cylinder with dynamic matrices, independent noise and nothing else.
#include <benchmark/benchmark.h>

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "models/ultrasonic.hpp"
#include "sensors/ultrasonic/three_position.hpp"
#include "statistics/sensors/scene.hpp"

namespace {

using namespace noctule;
using namespace noctule::sensors;

/// Noisy sightings of a wall or a cylinder along a straight metre, with drifting odometry.
std::vector<Sighting> sightings(int n, bool wall) {
  Rng rng(1);
  const scene::Object object = scene::place(wall ? scene::Kind::wall : scene::Kind::cylinder, 1.0, radians(10.0), rng);
  const double step = 1.0 / (n - 1);
  const FrameChange change({{step, 0.0, 0.0}, models::OdometryNoise{}.straight(step)});
  std::vector<Sighting> s;
  for (int i = 0; i < n; ++i) {
    for (Sighting& old : s) change.apply(old);
    const auto echo = object.echo({-0.5 + step * i, 0.0});
    Sighting& latest = s.emplace_back();
    latest.range = echo.range + 0.005 * rng.normal();
    latest.range_variance = 0.005 * 0.005;
    latest.direction = wrap(echo.direction + 0.05 * rng.normal());
    latest.direction_variance = 0.05 * 0.05;
  }
  return s;
}

void closed_forms(benchmark::State& state) {
  const auto s = sightings(3, state.range(0) == 0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(tangent_wall(s));
    benchmark::DoNotOptimize(point_at_ranges(s));
    benchmark::DoNotOptimize(apollonius(s, 0.6));
  }
}
BENCHMARK(closed_forms)->ArgName("cylinder")->Arg(0)->Arg(1);

/// Wall, point and cylinder fitted from the closed forms, with covariances, and the decision: n sightings.
void fit_and_decide(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const auto s = sightings(n, state.range(1) == 0);
  const DecisionParameters parameters;
  for (auto _ : state) benchmark::DoNotOptimize(decide(fit_surfaces(s, parameters), n, parameters));
}
BENCHMARK(fit_and_decide)->ArgNames({"n", "cylinder"})->Args({3, 0})->Args({3, 1})->Args({12, 0})->Args({12, 1});

/// The same, going on from the fits before the latest sighting.
void refit_and_decide(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const auto s = sightings(n, state.range(1) == 0);
  const DecisionParameters parameters;
  const SurfaceFits before = fit_surfaces(std::span(s).first(s.size() - 1), parameters);
  for (auto _ : state) benchmark::DoNotOptimize(decide(fit_surfaces(s, parameters, before), n, parameters));
}
BENCHMARK(refit_and_decide)->ArgNames({"n", "cylinder"})->Args({3, 0})->Args({12, 0})->Args({12, 1});

template <int D, class Predict>
Eigen::VectorXd plain_fit(const std::vector<Sighting>& s, Eigen::VectorXd x, const Predict& predict) {
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::MatrixXd j(2 * s.size(), D);
    Eigen::VectorXd e(2 * s.size());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      const auto echo = predict(s[i].position, x);
      const double wr = 1.0 / std::sqrt(s[i].range_variance), wd = 1.0 / std::sqrt(s[i].direction_variance);
      e[row] = wr * (s[i].range - echo.range);
      e[row + 1] = wd * wrap(s[i].direction - echo.direction);
      j.row(row) = wr * echo.range_by_feature.template head<D>();
      j.row(row + 1) = wd * echo.direction_by_feature.template head<D>();
    }
    x += (j.transpose() * j).ldlt().solve(j.transpose() * e);
    if (iteration == 3) benchmark::DoNotOptimize((j.transpose() * j).inverse().eval());
  }
  return x;
}

void plain_reference(benchmark::State& state) {
  const auto s = sightings(static_cast<int>(state.range(0)), true);
  const Sighting& first = s.front();
  const Vector2 point = first.position + first.range * Vector2(std::cos(first.direction), std::sin(first.direction));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        plain_fit<2>(s, Vector2(first.range, first.direction), [](const Vector2& p, const auto& x) {
          return models::predict_echo(p, Wall{x[0], x[1]});
        }));
    benchmark::DoNotOptimize(plain_fit<2>(s, point, [](const Vector2& p, const auto& x) {
      return models::predict_echo(p, Cylinder{x, 0.0});
    }));
    benchmark::DoNotOptimize(plain_fit<3>(s, Vector3(point.x(), point.y(), 0.0), [](const Vector2& p, const auto& x) {
      return models::predict_echo(p, Cylinder{x.template head<2>(), x[2]});
    }));
  }
}
BENCHMARK(plain_reference)->ArgName("n")->Arg(3)->Arg(12);

/// A stepper's scan of 60 pings between two walls, window full.
void scan(benchmark::State& state) {
  Rng rng(1);
  const scene::Object left = scene::place(scene::Kind::wall, 1.0, 0.0, rng);
  const scene::Object right{scene::Kind::wall, {1.2, -0.5 * kPi}, {}};
  std::vector<MovedScan> scans;
  for (int k = 0; k < 512; ++k) {
    const Pose2 base{0.12 * k, 0.0, 0.0};
    UltrasonicScan s = scene::scan(left, base, {}, k, rng);
    const UltrasonicScan other = scene::scan(right, base, {}, k, rng);
    for (std::size_t i = 0; i < s.beams.size(); ++i)
      if (s.beams[i].echo != Echo::hit) s.beams[i] = other.beams[i];
    scans.push_back({{{0.12, 0.0, 0.0}, models::OdometryNoise{}.straight(0.12)}, std::move(s)});
  }
  UltrasonicExtractor extractor({});
  std::int64_t seq = 0;
  for (auto _ : state) {
    MovedScan& m = scans[static_cast<std::size_t>(seq) % scans.size()];
    ++seq;
    m.scan.stamp = {seq, seq};
    extractor.predict({{seq, seq}, m.motion.mean, m.motion.covariance});
    benchmark::DoNotOptimize(extractor.update(m.scan));
  }
}
BENCHMARK(scan);

}  // namespace
