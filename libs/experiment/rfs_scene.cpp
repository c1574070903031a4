#include "experiment/rfs_scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "config/config.hpp"
#include "core/error.hpp"
#include "core/rng.hpp"
#include "eval/track_distance.hpp"
#include "experiment/slam_filters.hpp"
#include "filters/rfs/gnn_tracker.hpp"
#include "smoothing/kalman.hpp"

namespace noctule::experiment {
namespace {

using filters::ObjectEstimate;
using models::Vector4;

constexpr eval::SetDistanceParameters kDistance{.order = 1.0, .cutoff = 100.0};
constexpr std::size_t kSettled = 10;        // scans
constexpr std::int64_t kWindow = 10;        // scans of OSPA(2)
constexpr std::uint64_t kAttempts = 10000;  // to place one object

struct Measurement {
  Vector2 position;
  int object = -1;  ///< -1: false alarm
};

struct Scene {
  std::vector<std::vector<Vector4>> states;            ///< of each object at each scan
  std::vector<std::vector<Measurement>> measurements;  ///< of each scan, in random order
};

Vector2 position(const Vector4& state) {
  return {state[0], state[2]};
}

std::vector<Vector4> draw_way(const RfsSceneParameters& p, Rng rng) {
  Vector4 state = Vector4::Zero();
  state[0] = rng.uniform(-p.start_half_side, p.start_half_side);
  state[2] = rng.uniform(-p.start_half_side, p.start_half_side);
  const models::ConstantVelocity motion{p.period, p.acceleration_sd};
  if (p.moving) {
    const double speed = rng.uniform(p.least_speed, p.greatest_speed), course = rng.uniform(-kPi, kPi);
    state[1] = speed * std::cos(course);
    state[3] = speed * std::sin(course);
  }
  std::vector<Vector4> states{state};
  while (std::ssize(states) < p.scans) {
    state = motion.transition() * state;
    if (p.moving) {
      const Vector2 acceleration(rng.normal(0.0, p.acceleration_sd), rng.normal(0.0, p.acceleration_sd));
      state += motion.by_acceleration() * acceleration;
    }
    states.push_back(state);
  }
  return states;
}

/// Ways are drawn until one stays in the square and begins far enough from the others.
std::vector<std::vector<Vector4>> draw_objects(const RfsSceneParameters& p, std::uint64_t seed) {
  std::vector<std::vector<Vector4>> objects;
  for (int i = 0; i < p.objects; ++i) {
    for (std::uint64_t attempt = 0;; ++attempt) {
      if (attempt == kAttempts)
        throw InputError("objects: expected room for all, got none for number " + std::to_string(i + 1) +
                         " after 10000 attempts");
      auto way = draw_way(p, Rng(seed, stream_id("rfs.object"), attempt, static_cast<std::uint32_t>(i)));
      const bool inside =
          std::ranges::all_of(way, [&](const Vector4& s) { return position(s).cwiseAbs().maxCoeff() <= p.half_side; });
      const bool apart = std::ranges::all_of(objects, [&](const auto& other) {
        return (position(other.front()) - position(way.front())).norm() >= p.separation;
      });
      if (!inside || !apart) continue;
      objects.push_back(std::move(way));
      break;
    }
  }
  return objects;
}

/// Knuth's product of uniform numbers, in pieces that do not underflow.
int poisson(double mean, Rng& rng) {
  int count = 0;
  for (double left = mean; left > 0.0; left -= 100.0) {
    const double limit = std::exp(-std::min(left, 100.0));
    for (double product = rng.uniform(); product > limit; product *= rng.uniform()) ++count;
  }
  return count;
}

Scene draw_scene(const RfsSceneParameters& p, std::uint64_t seed) {
  Scene scene{draw_objects(p, seed), {}};
  for (int k = 0; k < p.scans; ++k) {
    const auto step = static_cast<std::uint64_t>(k);
    std::vector<Measurement> scan;
    for (int i = 0; i < p.objects; ++i) {
      Rng rng(seed, stream_id("rfs.detection"), step, static_cast<std::uint32_t>(i));
      if (rng.uniform() >= p.detection) continue;
      const Vector2 error(rng.normal(0.0, p.position_sd), rng.normal(0.0, p.position_sd));
      scan.push_back({position(scene.states[static_cast<std::size_t>(i)][step]) + error, i});
    }
    Rng rng(seed, stream_id("rfs.clutter"), step);
    for (int i = poisson(p.clutter, rng); i > 0; --i) {
      const double x = rng.uniform(-p.half_side, p.half_side);
      scan.push_back({{x, rng.uniform(-p.half_side, p.half_side)}, -1});
    }
    for (std::size_t i = scan.size(); i > 1; --i) std::swap(scan[i - 1], scan[rng.index(i)]);
    scene.measurements.push_back(std::move(scan));
  }
  return scene;
}

/// Estimates after each scan.
using Estimates = std::vector<std::vector<ObjectEstimate>>;

Estimates run_filter(filters::MultiObjectFilter& filter, const Scene& scene) {
  Estimates estimates;
  std::vector<Vector2> positions;
  for (const auto& scan : scene.measurements) {
    positions.clear();
    for (const Measurement& m : scan) positions.push_back(m.position);
    filter.update(positions);
    estimates.push_back(filter.objects());
  }
  return estimates;
}

/// Each object from its first measurement on. \param corrected by the measurements after the first
Estimates follow_known(const filters::ObjectModel& model, const Scene& scene, bool corrected) {
  std::map<int, smoothing::KalmanSmoother<4>> kalman;
  const models::ConstantVelocity motion = model.motion();
  const Matrix2 r = model.position_sd * model.position_sd * Matrix2::Identity();
  Estimates estimates;
  for (const auto& scan : scene.measurements) {
    for (auto& [object, filter] : kalman) filter.predict(motion.transition(), motion.noise());
    for (const Measurement& m : scan) {
      if (m.object < 0) continue;
      if (const auto known = kalman.find(m.object); known != kalman.end()) {
        if (corrected) known->second.update<2>(m.position, models::ConstantVelocity::position(), r);
      } else {
        const ObjectEstimate first = model.first_seen(m.object, m.position);
        kalman.emplace(m.object, smoothing::KalmanSmoother<4>({first.state, first.covariance}));
      }
    }
    estimates.emplace_back();
    for (const auto& [object, filter] : kalman) {
      estimates.back().push_back({object, filter.estimate().mean, filter.estimate().covariance});
    }
  }
  return estimates;
}

std::vector<eval::Track> tracks_of(const Estimates& estimates) {
  std::map<std::int64_t, eval::Track> tracks;
  for (std::size_t k = 0; k < estimates.size(); ++k) {
    for (const ObjectEstimate& o : estimates[k]) {
      tracks[o.label].push_back({static_cast<std::int64_t>(k), o.position()});
    }
  }
  std::vector<eval::Track> list;
  for (auto& [label, track] : tracks) list.push_back(std::move(track));
  return list;
}

double mean_from(const std::vector<double>& values, std::size_t first) {
  if (values.size() <= first) return std::nan("");
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(first), values.end(), 0.0) /
         static_cast<double>(values.size() - first);
}

FilterRun judge(const Estimates& estimates, const Scene& scene, double period) {
  std::vector<eval::Track> truth;
  for (const auto& states : scene.states) {
    truth.emplace_back();
    for (std::size_t k = 0; k < states.size(); ++k) {
      truth.back().push_back({static_cast<std::int64_t>(k), position(states[k])});
    }
  }
  const std::vector<eval::Track> tracks = tracks_of(estimates);
  std::vector<double> total, localisation, cardinality, gospa, over_tracks, error, count, time;
  for (std::size_t k = 0; k < estimates.size(); ++k) {
    std::vector<Vector2> estimated, real;
    for (const ObjectEstimate& o : estimates[k]) estimated.push_back(o.position());
    for (const auto& states : scene.states) real.push_back(position(states[k]));
    const eval::Ospa ospa = eval::ospa(estimated, real, kDistance);
    total.push_back(ospa.total);
    localisation.push_back(ospa.localisation);
    cardinality.push_back(ospa.cardinality);
    gospa.push_back(eval::gospa(estimated, real, kDistance).total);
    const auto now = static_cast<std::int64_t>(k);
    if (now + 1 >= kWindow)
      over_tracks.push_back(eval::ospa2(tracks, truth, {now + 1 - kWindow, now}, kDistance).total);
    count.push_back(static_cast<double>(estimated.size()));
    error.push_back(std::abs(count.back() - static_cast<double>(real.size())));
    time.push_back(static_cast<double>(k) * period);
  }
  FilterRun run;
  run.figures = {{"ospa", mean_from(total, 0), "m"},
                 {"ospa_localisation", mean_from(localisation, 0), "m"},
                 {"ospa_cardinality", mean_from(cardinality, 0), "m"},
                 {"ospa_settled", mean_from(total, kSettled), "m"},
                 {"ospa2", mean_from(over_tracks, 0), "m"},
                 {"gospa", mean_from(gospa, 0), "m"},
                 {"cardinality_mae", mean_from(error, 0), "1"},
                 {"cardinality_mae_settled", mean_from(error, kSettled), "1"}};
  run.series = {{"ospa_over_time", "m", time, total}, {"cardinality_over_time", "1", time, count}};
  return run;
}

}  // namespace

RfsScene::RfsScene(const ScenarioSpec& spec) : parameters_(config::load<RfsSceneParameters>(spec.config)) {}

std::vector<std::string> RfsScene::filters() const {
  return {"gnn", kOracle, kDeadReckoning};
}

std::vector<std::string> RfsScene::metrics() const {
  return {"ospa",  "ospa_localisation", "ospa_cardinality",        "ospa_settled",   "ospa2",
          "gospa", "cardinality_mae",   "cardinality_mae_settled", "ospa_over_time", "cardinality_over_time"};
}

void RfsScene::check(const FilterSpec& filter) const {
  if (filter.name == "gnn") static_cast<void>(config::load<filters::GnnTrackerParameters>(effective_config(filter)));
  if (filter.name == kOracle || filter.name == kDeadReckoning)
    static_cast<void>(config::load<filters::ObjectModel>(effective_config(filter)));
}

std::vector<FilterRun> RfsScene::run(std::uint64_t seed, std::span<const FilterSpec> filters) const {
  const Scene scene = draw_scene(parameters_, seed);
  std::vector<FilterRun> runs;
  for (const FilterSpec& spec : filters) {
    reset_peak_memory();
    const double begin = cpu_seconds();
    Estimates estimates;
    if (spec.name == kOracle || spec.name == kDeadReckoning) {
      estimates = follow_known(config::load<filters::ObjectModel>(effective_config(spec)), scene, spec.name == kOracle);
    } else {
      filters::GnnTracker tracker(config::load<filters::GnnTrackerParameters>(effective_config(spec)));
      estimates = run_filter(tracker, scene);
    }
    const double filter_time = cpu_seconds() - begin;
    runs.push_back(judge(estimates, scene, parameters_.period));
    runs.back().timings = {{"cpu_per_scan", filter_time / static_cast<double>(scene.measurements.size()), "s"},
                           {"peak_memory", peak_memory(), "B"}};
  }
  return runs;
}

}  // namespace noctule::experiment
