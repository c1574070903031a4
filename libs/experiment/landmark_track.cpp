#include "experiment/landmark_track.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/limits.hpp"
#include "eval/set_distance.hpp"
#include "eval/trajectory.hpp"
#include "experiment/experiment.hpp"

namespace noctule::experiment {
namespace {

double time_of(const LandmarkScan& scan) {
  return seconds(scan.sightings.stamp.utime);
}

void add_pose_figures(const LandmarkTrack& track, const LandmarkStream& stream, double segment, FilterRun& run) {
  std::vector<eval::PosePair> pairs;
  std::vector<double> nees;
  for (std::size_t i = 0; i < stream.scans.size(); ++i) {
    const SlamEstimate& e = track.estimates[i];
    const LandmarkScan& scan = stream.scans[i];
    pairs.push_back({scan.sightings.stamp.utime, e.pose, scan.truth});
    nees.push_back(eval::nees(e.pose, e.covariance, scan.truth));
  }
  const std::vector<double> errors = eval::position_errors(pairs);
  const double last = errors.empty() ? kNan : errors.back();
  const eval::PoseErrors pose = eval::pose_errors(pairs);
  run.figures.insert(run.figures.end(), {{"position_rmse", pose.position_rmse, "m"},
                                         {"position_mean_error", pose.position_mean, "m"},
                                         {"heading_rmse", pose.heading_rmse, "rad"},
                                         {"final_position_error", last, "m"}});
  std::ranges::move(eval::relative_pose_metrics(pairs, segment), std::back_inserter(run.figures));
  run.diverged = has_diverged(last, stream.path_length);

  const eval::NeesSummary summary = eval::nees_summary(nees);
  const bool has_covariance = summary.samples > 0;
  if (has_covariance) {
    const std::size_t left = eval::leaves_for_good(nees, summary.step_bounds);
    run.figures.insert(run.figures.end(), {{"nees_mean", summary.mean, "1"},
                                           {"nees_median", summary.median, "1"},
                                           {"nees_inside", summary.inside, "1"},
                                           {"nees_leaves", left > 0 ? time_of(stream.scans[left - 1]) : 0.0, "s"}});
  }
  Series position{"position_error", "m", {}, {}}, consistency{"nees", "1", {}, {}};
  for (const std::size_t i : stream.samples) {
    position.time.push_back(time_of(stream.scans[i]));
    position.values.push_back(errors[i]);
    consistency.values.push_back(nees[i]);
  }
  consistency.time = position.time;
  run.series.push_back(std::move(position));
  if (has_covariance) run.series.push_back(std::move(consistency));
}

void add_set_distances(const LandmarkMap& map, const LandmarkStream& stream, double cutoff, FilterRun& run) {
  std::vector<Vector2> estimates, truth;
  for (const LandmarkEstimate& l : map.landmarks) {
    if (l.kind == LandmarkKind::point && l.parameters.allFinite()) estimates.emplace_back(l.parameters.head<2>());
  }
  for (const KnownLandmark& l : stream.seen) truth.push_back(l.position);
  const Eigen::MatrixXd distances = eval::distances(estimates, truth);
  run.figures.push_back({"landmark_ospa", eval::ospa(distances, {1.0, cutoff}).total, "m"});
  run.figures.push_back({"landmark_gospa", eval::gospa(distances, {1.0, cutoff}).total, "m"});
}

void add_map_figures(const LandmarkTrack& track, const LandmarkStream& stream, const LandmarkJudgement& judgement,
                     FilterRun& run) {
  const eval::LandmarkErrors errors =
      eval::landmark_errors(track.map, stream.seen, {.gate = judgement.match_within, .known_ids = judgement.known_ids});
  run.figures.insert(run.figures.end(), {{"landmark_rmse", errors.rmse, "m"},
                                         {"landmark_mean_error", errors.mean, "m"},
                                         {"landmarks_found", static_cast<double>(errors.found), "1"},
                                         {"landmarks_missed", static_cast<double>(errors.missed), "1"},
                                         {"landmarks_invented", static_cast<double>(errors.invented), "1"}});
  if (judgement.as_sets) add_set_distances(track.map, stream, judgement.match_within, run);
  if (track.landmark_errors.empty()) return;
  Series series{"landmark_error", "m", {}, track.landmark_errors};
  for (const std::size_t i : stream.samples) series.time.push_back(time_of(stream.scans[i]));
  run.series.push_back(std::move(series));
}

/// Innovations, and how many particles are still different.
void add_health(const LandmarkTrack& track, const LandmarkStream& stream, FilterRun& run) {
  double nis = 0.0, ess = 0.0;
  int updates = 0, particles = 0;
  for (const SlamEstimate& e : track.estimates) {
    particles = std::max(particles, e.particles);
    ess += e.effective_sample_size;
    if (!(e.nis > 0.0)) continue;  // nothing was there to update with
    nis += e.nis;
    ++updates;
  }
  if (updates > 0) run.figures.push_back({"nis_mean", nis / updates, "1"});
  const auto scans = static_cast<double>(stream.scans.size());
  run.timings = {{"cpu_run", track.computing, "s"},
                 {"cpu_per_update", track.computing / scans, "s"},
                 {"peak_memory", peak_memory(), "B"}};
  if (particles < 2) return;
  run.timings.push_back({"cpu_per_update_and_particle", track.computing / (scans * particles), "s"});
  const SlamEstimate& last = track.estimates.back();
  run.figures.insert(run.figures.end(),
                     {{"ess_mean", ess / scans, "1"},
                      {"distinct_particles_end", static_cast<double>(last.distinct_particles), "1"},
                      {"distinct_ancestors_end", static_cast<double>(last.distinct_ancestors), "1"}});
  Series size{"effective_sample_size", "1", {}, {}}, survivors{"distinct_particles", "1", {}, {}},
      founders{"distinct_ancestors", "1", {}, {}};
  for (const std::size_t i : stream.samples) {
    for (Series* s : {&size, &survivors, &founders}) s->time.push_back(time_of(stream.scans[i]));
    size.values.push_back(track.estimates[i].effective_sample_size);
    survivors.values.push_back(track.estimates[i].distinct_particles);
    founders.values.push_back(track.estimates[i].distinct_ancestors);
  }
  run.series.insert(run.series.end(), {std::move(size), std::move(survivors), std::move(founders)});
}

}  // namespace

LandmarkStream record(const std::shared_ptr<const sim::LandmarkScene>& scene, std::uint64_t seed, double period) {
  sim::LandmarkWorld source(scene, seed);
  LandmarkStream stream;
  stream.start = source.world().start_in_map;
  std::vector<Odometry> odometry;
  std::set<std::int64_t> seen;
  Pose2 truth = stream.start;
  while (auto observation = source.next()) {
    if (const auto* o = std::get_if<Odometry>(&*observation)) {
      odometry.push_back(*o);
    } else if (const auto* g = std::get_if<GroundTruth>(&*observation)) {
      stream.path_length += (g->base_in_map.position() - truth.position()).norm();
      truth = g->base_in_map;
    } else {
      stream.scans.push_back(
          {std::move(odometry), std::get<LandmarkDetections>(std::move(*observation)), source.informed(), truth});
      odometry.clear();
      for (const LandmarkDetection& d : stream.scans.back().informed.detections) seen.insert(d.id);
    }
  }
  for (const KnownLandmark& l : source.world().landmarks) {
    if (seen.contains(l.id)) stream.seen.push_back(l);
  }
  const double scan_period = scene->sensor.controls_per_scan / scene->vehicle.control_rate;
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(period / scan_period)));
  for (std::size_t i = 0; i < stream.scans.size(); ++i) {
    if (i % stride == 0 || i + 1 == stream.scans.size()) stream.samples.push_back(i);
  }
  return stream;
}

double landmark_rmse(const LandmarkMap& map, const LandmarkStream& stream, const LandmarkJudgement& judgement) {
  return eval::landmark_errors(map, stream.seen, {.gate = judgement.match_within, .known_ids = judgement.known_ids})
      .rmse;
}

std::vector<std::string> landmark_metric_names(bool as_sets) {
  std::vector<std::string> names{"position_rmse",   "position_mean_error", "heading_rmse",      "final_position_error",
                                 "rpe_translation", "rpe_rotation",        "landmark_rmse",     "landmark_mean_error",
                                 "landmarks_found", "landmarks_missed",    "landmarks_invented"};
  if (as_sets) names.insert(names.end(), {"landmark_ospa", "landmark_gospa"});
  names.insert(names.end(), {"nees_mean", "nees_median", "nees_inside", "nees_leaves", "nis_mean", "ess_mean",
                             "distinct_particles_end", "distinct_ancestors_end"});
  names.insert(names.end(), {"position_error", "landmark_error", "nees", "effective_sample_size", "distinct_particles",
                             "distinct_ancestors"});
  return names;
}

FilterRun judge(const LandmarkTrack& track, const LandmarkStream& stream, const LandmarkJudgement& judgement) {
  FilterRun run;
  add_pose_figures(track, stream, judgement.segment, run);
  add_map_figures(track, stream, judgement, run);
  add_health(track, stream, run);
  return run;
}

}  // namespace noctule::experiment
