#include "experiment/recorded_landmarks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "config/config.hpp"
#include "core/error.hpp"
#include "core/rng.hpp"
#include "experiment/plan.hpp"
#include "experiment/rfs_scene.hpp"
#include "unit/datasets/files.hpp"

namespace noctule::experiment {
namespace {

using datasets::TemporaryFolder;

/// A recording in the form of MR.CLAM: a robot on a circle of 1 m among six landmarks, with noise in its odometry.
void write_recording(const TemporaryFolder& folder) {
  const std::vector<Vector2> landmarks{{2.0, 0.0}, {0.0, 2.5}, {-2.0, 1.0}, {-1.0, -2.0}, {1.5, -1.5}, {0.2, 0.1}};
  std::ostringstream barcodes, places, odometry, sightings, truth;
  for (auto* out : {&barcodes, &places, &odometry, &sightings, &truth}) out->precision(12);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    barcodes << i + 6 << ' ' << 10 * i + 5 << '\n';
    places << i + 6 << ' ' << landmarks[i].x() << ' ' << landmarks[i].y() << " 0.001 0.001\n";
  }
  Pose2 pose{1.0, 0.0, 0.5 * kPi};
  for (int k = 0; k <= 600; ++k) {
    Rng rng(3, stream_id("recording"), static_cast<std::uint64_t>(k));
    const double t = 0.1 * k, turn = 0.2;
    odometry << t << ' ' << 0.2 * (1.0 + rng.normal(0.0, 0.05)) << ' ' << turn * 1.1 + rng.normal(0.0, 0.05) << '\n';
    truth << t << ' ' << pose.x << ' ' << pose.y << ' ' << pose.yaw << '\n';
    for (std::size_t i = 0; k % 10 == 5 && i < landmarks.size(); ++i) {
      const Vector2 d = inverse(pose) * landmarks[i];
      sightings << t << ' ' << 10 * i + 5 << ' ' << d.norm() + rng.normal(0.0, 0.05) << ' '
                << std::atan2(d.y(), d.x()) + rng.normal(0.0, 0.02) << '\n';
    }
    pose = pose * Pose2{0.02, 0.0002, 0.02};
  }
  folder.write("Barcodes.dat", barcodes.str());
  folder.write("Landmark_Groundtruth.dat", places.str());
  folder.write("Robot1_Odometry.dat", odometry.str());
  folder.write("Robot1_Measurement.dat", sightings.str());
  folder.write("Robot1_Groundtruth.dat", truth.str());
}

Experiment experiment(const std::string& scenario, const std::string& filters) {
  return config::parse<Experiment>("name: test\nlast_seed: 2\nscenarios: [" + scenario + "]\nfilters: [" + filters +
                                   "]\n");
}
std::string recorded(const TemporaryFolder& folder, bool known_ids) {
  return "{name: r, kind: recorded_landmarks, config: {source: {type: mrclam, path: " + folder.path().string() +
         ", known_ids: " + (known_ids ? "true" : "false") + "}}}";
}

double figure_of(const FilterRun& run, const std::string& name) {
  for (const eval::Metric& m : run.figures) {
    if (m.name == name) return m.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

TEST(RecordedLandmarks, FiltersLieBetweenDeadReckoningAndTheLimits) {
  const TemporaryFolder folder;
  write_recording(folder);
  for (const bool known : {true, false}) {
    const Plan plan = make_plan(
        experiment(recorded(folder, known),
                   "{name: pf, config: {particles: 50}}, {name: dead_reckoning}, {name: known_map}, {name: smoother}"));
    const auto runs = plan.scenarios[0].scenario->run(1, plan.scenarios[0].filters);
    ASSERT_EQ(runs.size(), 4u);
    EXPECT_LT(figure_of(runs[0], "position_rmse"), 0.5 * figure_of(runs[1], "position_rmse"));
    EXPECT_LT(figure_of(runs[2], "position_rmse"), figure_of(runs[0], "position_rmse"));
    EXPECT_LT(figure_of(runs[3], "position_rmse"), 0.05);
    EXPECT_EQ(figure_of(runs[3], "landmarks_found"), 6.0);
    EXPECT_LT(figure_of(runs[3], "landmark_rmse"), 0.05);
    EXPECT_LE(figure_of(runs[1], "position_rmse"), figure_of(runs[1], "position_rmse_unaligned"));
    EXPECT_FALSE(runs[0].diverged);
    for (const FilterRun& run : runs) {
      ASSERT_EQ(run.series.size(), 1u);
      EXPECT_EQ(run.series[0].time, runs[0].series[0].time);
    }
  }
}

TEST(RecordedLandmarks, OnlyTheSeedOfAFilterChangesItsFigures) {
  const TemporaryFolder folder;
  write_recording(folder);
  const Plan plan =
      make_plan(experiment(recorded(folder, false), "{name: pf, config: {particles: 10}}, {name: known_map}"));
  const Scenario& scenario = *plan.scenarios[0].scenario;
  const auto a = scenario.run(1, plan.scenarios[0].filters), b = scenario.run(2, plan.scenarios[0].filters),
             again = scenario.run(1, plan.scenarios[0].filters);
  EXPECT_EQ(figure_of(a[0], "position_rmse"), figure_of(again[0], "position_rmse"));
  EXPECT_NE(figure_of(a[0], "position_rmse"), figure_of(b[0], "position_rmse"));
  EXPECT_EQ(figure_of(a[1], "position_rmse"), figure_of(b[1], "position_rmse"));
}

TEST(RecordedLandmarks, AnAbsentRecordingIsRefusedBeforeTheFirstRun) {
  const TemporaryFolder folder;
  const std::string text = datasets::refusal([&] {
    static_cast<void>(make_plan(experiment(
        "{name: r, kind: recorded_landmarks, config: {source: {type: victoria_park, path: /nowhere/at/all}}}",
        "{name: pf}")));
  });
  EXPECT_NE(text.find("scenario 'r': source.path: expected the folder of a recording, got '/nowhere/at/all'"),
            std::string::npos)
      << text;
}

TEST(RfsScene, ScenesBelongToTheirSeedAndTheOracleIsTheLimit) {
  const Plan plan = make_plan(
      experiment("{name: s, kind: rfs_scene, config: {scans: 40}}", "{name: gnn}, {name: oracle, role: limit}"));
  const Scenario& scenario = *plan.scenarios[0].scenario;
  double gnn = 0.0, oracle = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto runs = scenario.run(seed, plan.scenarios[0].filters);
    gnn += figure_of(runs[0], "ospa_settled");
    oracle += figure_of(runs[1], "ospa_settled");
    EXPECT_EQ(figure_of(runs[1], "cardinality_mae_settled"), 0.0);
    EXPECT_NEAR(figure_of(runs[0], "ospa"),
                figure_of(runs[0], "ospa_localisation") + figure_of(runs[0], "ospa_cardinality"), 1e-9);
    if (seed > 1) continue;
    EXPECT_EQ(figure_of(runs[0], "ospa"), figure_of(scenario.run(1, plan.scenarios[0].filters)[0], "ospa"));
    EXPECT_NE(figure_of(runs[0], "ospa"), figure_of(scenario.run(2, plan.scenarios[0].filters)[0], "ospa"));
  }
  EXPECT_LT(oracle, gnn);
  EXPECT_LT(oracle / 10.0, 10.0 * std::sqrt(0.5 * kPi));  // better than the measurements themselves
}

TEST(RfsScene, WithoutNoiseMissesAndClutterEveryObjectIsWhereItIs) {
  const Plan plan = make_plan(experiment(
      "{name: s, kind: rfs_scene, config: {scans: 30, moving: false, detection: 1, clutter: 0, position_sd_m: 1e-6}}",
      "{name: gnn}"));
  const auto runs = plan.scenarios[0].scenario->run(1, plan.scenarios[0].filters);
  EXPECT_LT(figure_of(runs[0], "ospa_settled"), 1e-5);
  EXPECT_NEAR(figure_of(runs[0], "ospa_cardinality"), 100.0 * 3.0 / 30.0, 1e-9);  // not confirmed in three scans
}

}  // namespace
}  // namespace noctule::experiment
