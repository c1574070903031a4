#include "apps/evaluate/judge.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "config/config.hpp"
#include "core/error.hpp"
#include "eval/contour_error.hpp"
#include "eval/contour_file.hpp"
#include "eval/error_series.hpp"
#include "eval/landmark_file.hpp"
#include "eval/number_text.hpp"
#include "eval/set_distance.hpp"
#include "eval/tum.hpp"
#include "report/files.hpp"
#include "sim/room_geometry.hpp"
#include "sim/world.hpp"

namespace noctule::apps {
namespace {

namespace fs = std::filesystem;
using Metrics = std::vector<eval::Metric>;

std::vector<eval::TimedPose3> read_tum(const fs::path& file) {
  return eval::parse_tum(report::read_file(file), file.string());
}

/// Both or none. \throws InputError naming what is missing
bool both(const fs::path& estimate, const fs::path& truth, const char* what) {
  if (estimate.empty() != truth.empty()) {
    throw InputError(std::string(what) + ": expected an estimate and a truth, got only the " +
                     (truth.empty() ? "estimate " + estimate.string() : "truth " + truth.string()));
  }
  return !estimate.empty();
}

void add(Metrics& metrics, const std::string& name, const eval::ErrorStatistics& s, const char* unit) {
  metrics.push_back({name + "_rmse", s.rmse, unit});
  metrics.push_back({name + "_mean", s.mean, unit});
  metrics.push_back({name + "_median", s.median, unit});
  metrics.push_back({name + "_sd", s.sd, unit});
  metrics.push_back({name + "_min", s.min, unit});
  metrics.push_back({name + "_max", s.max, unit});
}

std::vector<eval::Segment> segments_of(const std::vector<eval::PosePair3>& pairs, const std::string& kind, double size,
                                       SegmentChoice choice) {
  const auto starts =
      choice == SegmentChoice::end_to_end ? eval::SegmentStarts::end_to_end : eval::SegmentStarts::every_pose;
  if (kind == "m") {
    return choice == SegmentChoice::nearest ? eval::segments_nearest_distance(eval::travelled(pairs), size, 0.1 * size)
                                            : eval::segments_by_distance(eval::travelled(pairs), size, starts);
  }
  if (kind == "steps") return eval::segments_by_steps(pairs.size(), static_cast<std::size_t>(size), starts);
  std::vector<std::int64_t> utimes;
  for (const eval::PosePair3& p : pairs) utimes.push_back(p.utime);
  return eval::segments_by_time(utimes, size, starts);
}

void add_relative(const std::vector<eval::PosePair3>& pairs, const EvaluationOptions& options, Metrics& metrics) {
  const auto each = [&](const std::vector<double>& sizes, const std::string& kind) {
    for (const double size : sizes) {
      const std::string name = "rpe_" + eval::shortest(size) + kind;
      const auto segments = segments_of(pairs, kind, size, options.segments);
      metrics.push_back({name + "_segments", static_cast<double>(segments.size()), "1"});
      const eval::PoseErrorSeries errors = eval::relative_errors(pairs, segments);
      add(metrics, name + "_translation", eval::error_statistics(errors.translation), "m");
      add(metrics, name + "_rotation", eval::error_statistics(errors.rotation), "rad");
    }
  };
  each(options.lengths, "m");
  each(options.durations, "s");
  each(options.steps, "steps");
}

/// \param whole truth has attitudes, not positions alone
void add_trajectory(std::vector<eval::PosePair3> pairs, bool whole, const EvaluationOptions& options,
                    Metrics& metrics) {
  const eval::ErrorStatistics raw = eval::error_statistics(eval::absolute_errors(pairs).translation);
  metrics.push_back({"poses", static_cast<double>(pairs.size()), "1"});
  metrics.push_back({"path_length", pairs.empty() ? 0.0 : eval::travelled(pairs).back(), "m"});
  metrics.push_back({"position_rmse", raw.rmse, "m"});
  metrics.push_back({"position_max", raw.max, "m"});
  const auto add_heading = [&](const std::string& name) {
    std::vector<double> heading;
    for (const eval::PosePair3& p : pairs) {
      heading.push_back(std::abs(wrap(eval::in_plane(p.estimate).yaw - eval::in_plane(p.truth).yaw)));
    }
    const eval::ErrorStatistics s = eval::error_statistics(heading);
    metrics.push_back({name + "_rmse", s.rmse, "rad"});
    metrics.push_back({name + "_max", s.max, "rad"});
  };
  if (whole) {
    add_heading("heading");
    add_relative(pairs, options, metrics);
  }
  const eval::Similarity3 alignment = eval::align(pairs, options.alignment);
  pairs = eval::aligned(pairs, alignment);
  const eval::PoseErrorSeries errors = eval::absolute_errors(pairs);
  add(metrics, "ate", eval::error_statistics(errors.translation), "m");
  if (whole) {
    add(metrics, "ate_rotation", eval::error_statistics(errors.rotation), "rad");
    add_heading("ate_heading");
  }
  metrics.push_back({"alignment_scale", alignment.scale, "1"});
}

std::vector<eval::PosePair3> pairs_of(const EvaluationFiles& files, const EvaluationOptions& options, bool& whole) {
  const std::vector<eval::TimedPose3> estimate = read_tum(files.estimate);
  std::vector<eval::PosePair3> pairs;
  whole = !files.truth.empty();
  if (whole) {
    const std::vector<eval::TimedPose3> truth = read_tum(files.truth);
    pairs = options.association == Association::nearest
                ? eval::associate_nearest(estimate, truth, options.max_difference)
                : eval::associate_interpolated(estimate, truth, options.max_gap);
  } else {
    std::vector<eval::TimedPose3> fixes;
    for (const KnownPosition& f : eval::parse_fixes(report::read_file(files.fixes), files.fixes.string())) {
      fixes.push_back({f.utime, {{f.position.x(), f.position.y(), 0.0}, Eigen::Quaterniond::Identity()}});
    }
    // The estimate is what is dense: it is interpolated at the fixes.
    for (const eval::PosePair3& p : eval::associate_interpolated(fixes, estimate, options.max_gap)) {
      pairs.push_back({p.utime, p.truth, p.estimate});
    }
  }
  if (pairs.empty()) {
    throw InputError(files.estimate.string() + ": expected poses at times of " +
                     (whole ? files.truth : files.fixes).string() + ", got none in common");
  }
  return pairs;
}

void add_landmarks(const EvaluationFiles& files, const EvaluationOptions& options, Metrics& metrics) {
  const auto estimated = eval::parse_landmarks(report::read_file(files.landmarks), files.landmarks.string());
  const auto known = eval::parse_landmarks(report::read_file(files.known_landmarks), files.known_landmarks.string());
  std::set<std::int64_t> ids;
  for (const KnownLandmark& k : known) ids.insert(k.id);
  const bool shared = std::ranges::any_of(estimated, [&](const KnownLandmark& l) { return ids.contains(l.id); });
  const bool by_id = options.pairing ? *options.pairing == Pairing::id : shared;

  LandmarkMap map;
  std::vector<Vector2> estimate, truth;
  for (const KnownLandmark& l : estimated) {
    map.landmarks.emplace_back();
    map.landmarks.back().id = l.id;
    map.landmarks.back().parameters.head<2>() = l.position;
    estimate.push_back(l.position);
  }
  for (const KnownLandmark& k : known) truth.push_back(k.position);
  const eval::LandmarkErrors errors =
      eval::landmark_errors(map, known,
                            {.gate = options.gate,
                             .known_ids = by_id,
                             .alignment = options.align_landmarks ? eval::Alignment::rigid : eval::Alignment::none});
  metrics.push_back({"landmark_rmse", errors.rmse, "m"});
  metrics.push_back({"landmark_max", errors.max, "m"});
  metrics.push_back({"landmarks_found", static_cast<double>(errors.found), "1"});
  metrics.push_back({"landmarks_missed", static_cast<double>(errors.missed), "1"});
  metrics.push_back({"landmarks_invented", static_cast<double>(errors.invented), "1"});
  const eval::SetDistanceParameters distance{options.order, options.cutoff};
  const eval::Ospa ospa = eval::ospa(estimate, truth, distance);
  metrics.push_back({"landmark_ospa", ospa.total, "m"});
  metrics.push_back({"landmark_ospa_localisation", ospa.localisation, "m"});
  metrics.push_back({"landmark_ospa_cardinality", ospa.cardinality, "m"});
  metrics.push_back({"landmark_gospa", eval::gospa(estimate, truth, distance).total, "m"});
}

Room read_room(const fs::path& walls, const fs::path& cylinders) {
  Room room;
  if (!walls.empty()) room.walls = eval::parse_walls(report::read_file(walls), walls.string());
  if (!cylinders.empty()) room.cylinders = eval::parse_cylinders(report::read_file(cylinders), cylinders.string());
  return room;
}

void add_contours(const EvaluationFiles& files, Metrics& metrics) {
  const Room known = files.world.empty()
                         ? read_room(files.known_walls, files.known_cylinders)
                         : sim::RoomGeometry(config::load<sim::WorldParameters>(files.world).room).known_room();
  const ContourMap map = eval::as_map(read_room(files.walls, files.cylinders));
  const eval::ContourErrors errors = eval::contour_errors(map, known);
  for (eval::Metric& m : eval::contour_metrics(errors)) metrics.push_back(std::move(m));
  metrics.push_back({"complete", errors.complete() ? 1.0 : 0.0, "1"});
}

}  // namespace

void complete_from_results(const fs::path& folder, EvaluationFiles& files) {
  const auto take = [&](fs::path& file, const char* name) {
    if (file.empty() && fs::exists(folder / name)) file = folder / name;
  };
  take(files.estimate, "trajectory.tum");
  if (files.fixes.empty()) take(files.truth, "ground_truth.tum");
  if (files.truth.empty()) take(files.fixes, "fixes.csv");
  take(files.landmarks, "landmarks.csv");
  take(files.known_landmarks, "known_landmarks.csv");
  take(files.walls, "walls.csv");
  take(files.cylinders, "cylinders.csv");
  if (files.world.empty()) {
    take(files.known_walls, "known_walls.csv");
    take(files.known_cylinders, "known_cylinders.csv");
  }
  // An estimate without a truth, or the other way round, is what such a run has.
  if (files.truth.empty() && files.fixes.empty()) files.estimate.clear();
  if (files.landmarks.empty() || files.known_landmarks.empty()) files.landmarks = files.known_landmarks = fs::path();
  const bool room = !files.world.empty() || !files.known_walls.empty() || !files.known_cylinders.empty();
  if (!room || (files.walls.empty() && files.cylinders.empty())) {
    files.walls = files.cylinders = files.known_walls = files.known_cylinders = files.world = fs::path();
  }
}

std::vector<eval::Metric> evaluate(const EvaluationFiles& files, const EvaluationOptions& options) {
  Metrics metrics;
  if (both(files.estimate, files.truth.empty() ? files.fixes : files.truth, "trajectory")) {
    bool whole = false;
    std::vector<eval::PosePair3> pairs = pairs_of(files, options, whole);
    add_trajectory(std::move(pairs), whole, options, metrics);
  }
  if (both(files.landmarks, files.known_landmarks, "landmarks")) add_landmarks(files, options, metrics);
  const fs::path known = !files.world.empty()         ? files.world
                         : !files.known_walls.empty() ? files.known_walls
                                                      : files.known_cylinders;
  if (both(files.walls.empty() ? files.cylinders : files.walls, known, "contours")) add_contours(files, metrics);
  if (metrics.empty()) throw InputError("expected an estimate and a truth to compare, got none (see --help)");
  return metrics;
}

}  // namespace noctule::apps
