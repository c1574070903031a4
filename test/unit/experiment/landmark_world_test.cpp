#include "experiment/landmark_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "config/config.hpp"
#include "core/chi2.hpp"
#include "core/limits.hpp"
#include "experiment/landmark_track.hpp"
#include "unit/experiment/fake_scenario.hpp"

namespace noctule::experiment {
namespace {

/// A square of 20 m, driven round once by a small vehicle, with landmarks within and without.
constexpr const char* kExperiment = R"(
name: square
first_seed: 1
last_seed: 4
scenarios:
  - name: square
    kind: landmark_world
    config:
      world:
        waypoints_m: [[20, 0], [20, 20], [0, 20], [0, 0]]
        landmarks_m: [[5, 5], [15, 5], [15, 15], [5, 15], [25, -5], [25, 25], [-5, 25], [-5, -5], [-90, -90]]
      vehicle: {speed_m_per_s: 1, wheelbase_m: 1, speed_sd_m_per_s: 0.2, steering_sd_deg: 4}
      sensor: {range_sd_m: 0.2, bearing_sd_deg: 2}
filters:
  - {name: pf, parameters: {N: [10, 50]}}
  - {name: smoother}
  - {name: known_pose}
  - {name: dead_reckoning}
)";

Plan plan_of(const std::vector<std::string>& assignments = {}) {
  return make_plan(config::parse<Experiment>(kExperiment, "square.yaml", assignments));
}
std::string refusal_of(const std::vector<std::string>& assignments) {
  return refusal([&] { static_cast<void>(plan_of(assignments)); });
}
void expect_says(const std::string& text, const std::string& what) {
  EXPECT_NE(text.find(what), std::string::npos) << "wanted: " << what << "\ngot: " << text;
}

std::vector<FilterRun> run_all(const Plan& plan, std::uint64_t seed) {
  return plan.scenarios[0].scenario->run(seed, plan.scenarios[0].filters);
}
double figure(const FilterRun& run, const std::string& name) {
  const auto at = std::ranges::find(run.figures, name, &eval::Metric::name);
  return at == run.figures.end() ? kNan : at->value;
}
const Series& series(const FilterRun& run, const std::string& name) {
  return *std::ranges::find(run.series, name, &Series::metric);
}

void expect_equal(const FilterRun& a, const FilterRun& b) {
  ASSERT_EQ(a.figures.size(), b.figures.size());
  for (std::size_t i = 0; i < a.figures.size(); ++i) {
    EXPECT_EQ(a.figures[i].name, b.figures[i].name);
    EXPECT_EQ(a.figures[i].value, b.figures[i].value) << a.figures[i].name;
  }
  ASSERT_EQ(a.series.size(), b.series.size());
  for (std::size_t i = 0; i < a.series.size(); ++i) EXPECT_EQ(a.series[i].time, b.series[i].time);
  EXPECT_EQ(a.diverged, b.diverged);
}

sim::LandmarkWorldParameters square() {
  sim::LandmarkWorldParameters p;
  p.world.waypoints = {{20, 0}, {20, 20}, {0, 20}, {0, 0}};
  p.world.landmarks = {{5, 5}, {15, 15}, {25, 25}, {-90, -90}};
  p.vehicle.speed = p.vehicle.wheelbase = 1.0;
  return p;
}

TEST(LandmarkWorld, AnOracleIsTheFilterToldOfTheTrueNoise) {
  const std::vector<std::string> filters{"filters[0].name=fastslam2", "filters[0].parameters={N: 20}",
                                         "filters[1].name=oracle", "filters[1].config={type: fastslam2}",
                                         "filters[1].parameters={N: 20}"};
  const auto nominal = run_all(plan_of(filters), 1);
  expect_equal(nominal[0], nominal[1]);
  auto changed = filters;
  changed.push_back("scenarios[0].config.sensor.outliers=0.2");
  const auto outliers = run_all(plan_of(changed), 1);
  EXPECT_NE(figure(outliers[0], "position_rmse"), figure(outliers[1], "position_rmse"));
  EXPECT_LT(figure(outliers[1], "nis_mean"), figure(outliers[0], "nis_mean"));
  auto nameless = filters;
  nameless[3] = "filters[1].config={particles: 10}";
  expect_says(refusal_of(nameless), "type");
}

TEST(LandmarkStream, InsidersKnowTheSameSightingsByNameAndNoise) {
  sim::LandmarkWorldParameters p = square();
  p.sensor.known_ids = false;
  p.sensor.clutter = 1.0;
  p.sensor.schedule = {{0.0, 2.0}};
  const LandmarkStream stream = record(std::make_shared<const sim::LandmarkScene>(p), 1, 5.0);
  std::size_t sightings = 0, clutter = 0;
  for (const LandmarkScan& scan : stream.scans) {
    EXPECT_EQ(scan.sightings.stamp, scan.informed.stamp);
    ASSERT_GE(scan.sightings.detections.size(), scan.informed.detections.size());
    clutter += scan.sightings.detections.size() - scan.informed.detections.size();
    for (std::size_t i = 0; i < scan.informed.detections.size(); ++i) {
      const LandmarkDetection &told = scan.sightings.detections[i], &known = scan.informed.detections[i];
      EXPECT_EQ(told.range, known.range);
      EXPECT_EQ(told.bearing, known.bearing);
      EXPECT_EQ(told.id, -1);
      EXPECT_GE(known.id, 0);
      EXPECT_NEAR(known.covariance(0, 0), 4.0 * told.covariance(0, 0), 1e-12);
      ++sightings;
    }
    EXPECT_EQ(scan.odometry.size(), 8u);
  }
  EXPECT_GT(sightings, stream.scans.size() / 2);
  EXPECT_NEAR(static_cast<double>(clutter), static_cast<double>(stream.scans.size()),
              4.0 * std::sqrt(static_cast<double>(stream.scans.size())));
  EXPECT_EQ(stream.seen.size(), 3u) << "nobody ever sees the one far away";
  EXPECT_NEAR(stream.path_length, 80.0, 4.0);
  EXPECT_EQ(stream.samples.back(), stream.scans.size() - 1);
  EXPECT_EQ(stream.samples[1], 25u);
}

TEST(LandmarkWorld, EveryFilterGetsTheSameStreamWhateverRunsBesideIt) {
  const Plan plan = plan_of();
  const std::vector<FilterRun> together = run_all(plan, 3);
  const std::vector<FilterSpec>& specs = plan.scenarios[0].filters;
  std::vector<FilterSpec> reversed(specs.rbegin(), specs.rend());
  const std::vector<FilterRun> backwards = plan.scenarios[0].scenario->run(3, reversed);
  for (std::size_t i = 0; i < specs.size(); ++i) {
    expect_equal(together[i], backwards[specs.size() - 1 - i]);
    expect_equal(together[i], plan.scenarios[0].scenario->run(3, {&specs[i], 1})[0]);
  }
}

TEST(LandmarkWorld, FiltersLieBetweenTheLimitAndDeadReckoning) {
  const Plan plan = plan_of();
  double filter = 0.0, limit = 0.0, odometry = 0.0, filter_map = 0.0, limit_map = 0.0, known_map = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const std::vector<FilterRun> runs = run_all(plan, seed);
    filter += figure(runs[1], "position_rmse");
    limit += figure(runs[2], "position_rmse");
    odometry += figure(runs[4], "position_rmse");
    filter_map += figure(runs[1], "landmark_rmse");
    limit_map += figure(runs[2], "landmark_rmse");
    known_map += figure(runs[3], "landmark_rmse");
    for (const FilterRun& run : runs) EXPECT_EQ(figure(run, "landmarks_missed"), 0.0);
  }
  EXPECT_LT(limit, filter);
  EXPECT_LT(filter, 0.5 * odometry);
  EXPECT_LT(known_map, limit_map);
  EXPECT_LT(limit_map, filter_map);
}

TEST(LandmarkWorld, TheLimitIsConsistentAndTheTruePathHasNoError) {
  const Plan plan = plan_of();
  double nees = 0.0;
  constexpr int kSeeds = 30;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const std::vector<FilterRun> runs = plan.scenarios[0].scenario->run(
        static_cast<std::uint64_t>(seed), std::span(plan.scenarios[0].filters).subspan(2, 2));
    nees += figure(runs[0], "nees_mean");
    EXPECT_EQ(figure(runs[1], "position_rmse"), 0.0);
    EXPECT_EQ(figure(runs[1], "final_position_error"), 0.0);
    EXPECT_FALSE(runs[1].diverged);
    EXPECT_TRUE(std::isnan(figure(runs[1], "nees_mean"))) << "a certain path has no covariance";
  }
  // Scans of a run are dependent: as if each run gave one value, which is wider than the truth.
  const Interval bounds = nees_bounds(3, kSeeds, 0.999);
  EXPECT_GT(nees / kSeeds, bounds.low);
  EXPECT_LT(nees / kSeeds, bounds.high);
}

TEST(LandmarkWorld, ListsEveryMetricAndCurvesAgreeWithFigures) {
  const Plan plan = plan_of();
  const std::vector<std::string> names = plan.scenarios[0].scenario->metrics();
  for (const FilterRun& run : run_all(plan, 2)) {
    for (const eval::Metric& m : run.figures) EXPECT_NE(std::ranges::find(names, m.name), names.end()) << m.name;
    for (const Series& s : run.series) {
      EXPECT_NE(std::ranges::find(names, s.metric), names.end()) << s.metric;
      EXPECT_EQ(s.time.size(), s.values.size());
      EXPECT_TRUE(std::ranges::is_sorted(s.time));
    }
    EXPECT_EQ(series(run, "position_error").values.back(), figure(run, "final_position_error"));
    EXPECT_LE(figure(run, "position_mean_error"), figure(run, "position_rmse"));
    for (const eval::Metric& m : run.timings) EXPECT_GT(m.value, 0.0) << m.name;
  }
  const FilterRun filter = run_all(plan, 2)[0];
  EXPECT_EQ(series(filter, "landmark_error").values.back(), figure(filter, "landmark_rmse"));
  EXPECT_EQ(series(filter, "distinct_ancestors").values.back(), figure(filter, "distinct_ancestors_end"));
  EXPECT_LE(figure(filter, "ess_mean"), 10.0);
}

TEST(LandmarkWorld, UnknownIdentitiesArePairedByPlace) {
  const Plan plan = plan_of({"scenarios[0].config.sensor.known_ids=false", "filters[0].parameters.N=100",
                             "scenarios[0].config.sensor.range_sd_m=0.05",
                             "scenarios[0].config.sensor.bearing_sd_deg=0.5", "scenarios[0].config.match_within_m=2"});
  const std::vector<FilterRun> runs = run_all(plan, 1);
  EXPECT_EQ(figure(runs[0], "landmarks_found"), 8.0);
  EXPECT_LT(figure(runs[0], "landmark_rmse"), 1.0);
  EXPECT_EQ(figure(runs[1], "landmarks_found"), 8.0);
  EXPECT_LT(figure(runs[0], "landmark_ospa"), 1.0);
  EXPECT_NEAR(figure(runs[2], "landmark_gospa"), 8.0 * figure(runs[2], "landmark_ospa"), 1e-9) << "no one too many";
}

TEST(LandmarkWorld, BadInputIsNamedBeforeTheFirstRun) {
  expect_says(refusal_of({"filters=[{name: pg}]"}), "no scenario can take 'pg'; square knows: pf");
  expect_says(refusal_of({"filters=[{name: pg}]"}), "dead_reckoning, known_pose, smoother");
  expect_says(refusal_of({"metrics=[position_rms]"}),
              "no scenario measures 'position_rms'; square knows: position_rmse");
  expect_says(refusal_of({"scenarios[0].config.world.scale=0.05"}),
              "scenario 'square': vehicle: expected steering that reaches way-point");
  expect_says(refusal_of({"scenarios[0].config.sensor.range_sd_m=-1"}),
              "range_sd_m: expected a number > 0 in m, got -1");
  expect_says(refusal_of({"scenarios[0].config.world.landmark_file=/nowhere.mat"}),
              "/nowhere.mat: expected a readable");
  expect_says(refusal_of({"filters[1].parameters.batch=0"}), "batch: expected an integer >= 1, got 0");
  expect_says(refusal_of({"filters[3].parameters.N=10"}), "filter 'dead_reckoning': expected no configuration");
  expect_says(refusal_of({"filters[0].parameters.N=0"}), "particles: expected an integer in [1, 1e+07], got 0");
}

}  // namespace
}  // namespace noctule::experiment
