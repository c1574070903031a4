#include "experiment/recorded_landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "config/config.hpp"
#include "core/error.hpp"
#include "core/limits.hpp"
#include "eval/trajectory.hpp"
#include "experiment/path_mapper.hpp"
#include "experiment/slam_filters.hpp"
#include "filters/localisation/ekf_localisation.hpp"
#include "smoothing/fix_smoother.hpp"
#include "smoothing/landmark_smoother.hpp"

namespace noctule::experiment {
namespace {

/// How the limit `fixes` believes in fixes.
struct FixSmootherParameters {
  double fix_sd = 0.5;    ///< [m]
  double start_sd = 1.0;  ///< [m, m, rad] of the first pose

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = FixSmootherParameters;
    v.field("fix_sd_m", &P::fix_sd, unit::metre, "standard deviation of a fix", positive());
    v.field("start_sd", &P::start_sd, unit::one, "standard deviation of the first pose (m, m, rad)", positive());
  }
};

constexpr double kSeriesStep = 10.0;  // [s]
constexpr const char* kKnownMap = "known_map";
constexpr const char* kFixes = "fixes";

const std::filesystem::path& folder_of(const RecordedLandmarksParameters& p) {
  return std::visit([](const auto& source) -> const std::filesystem::path& { return source.path; }, p.source);
}

std::unique_ptr<ObservationSource> open(datasets::MrclamParameters p) {
  p.known_ids = true;  // for the limits; filters do not see them unless the experiment says so
  return std::make_unique<datasets::Mrclam>(p);
}
std::unique_ptr<ObservationSource> open(const datasets::VictoriaParkParameters& p) {
  return std::make_unique<datasets::VictoriaPark>(p);
}

std::vector<Vector2> positions(const std::vector<eval::PosePair>& pairs, Pose2 eval::PosePair::*which) {
  std::vector<Vector2> all;
  for (const eval::PosePair& p : pairs) all.push_back((p.*which).position());
  return all;
}

Pose2 moved(const eval::Similarity2& s, const Pose2& pose) {
  const Vector2 position = s * pose.position();
  return {position.x(), position.y(), wrap(pose.yaw + s.rotation)};
}

}  // namespace

/// What every filter is fed, and what is known.
struct RecordedLandmarks::Stream {
  std::vector<Observation> observations;  ///< odometry and sightings
  std::vector<eval::TimedPose> truth;     ///< whole poses
  KnownWorld world;
  double way = 0.0;  ///< [m] driven by odometry
  std::int64_t begin = 0;
  double duration = 0.0;
  std::size_t messages = 0;  ///< of sightings
};

namespace {

/// What a filter made of the stream.
struct Outcome {
  std::vector<eval::TimedPose> trajectory;
  LandmarkMap map;
  std::vector<double> nis;
};

/// Feeds a filter and follows its estimate. \param update returns the estimate after a message of sightings
template <class Stream, class Predict, class Update>
std::vector<eval::TimedPose> follow(const Stream& stream, double sampling, Predict predict, Update update) {
  std::vector<eval::TimedPose> trajectory;
  Pose2 pose = stream.world.start_in_map;
  const auto spacing = static_cast<std::int64_t>(1e6 * sampling);
  std::int64_t next = std::numeric_limits<std::int64_t>::min();
  const auto note = [&](std::int64_t utime) {
    if (!trajectory.empty() && trajectory.back().utime == utime) {
      trajectory.back().pose = pose;
    } else if (utime >= next) {
      trajectory.push_back({utime, pose});
      next = utime + spacing;
    }
  };
  for (const Observation& observation : stream.observations) {
    if (const auto* o = std::get_if<Odometry>(&observation)) {
      predict(*o);
      pose = pose * o->increment;
      note(o->stamp.utime);
    } else if (const auto* d = std::get_if<LandmarkDetections>(&observation)) {
      pose = update(*d);
      note(d->stamp.utime);
    }
  }
  return trajectory;
}

LandmarkDetections without_ids(LandmarkDetections message) {
  for (LandmarkDetection& d : message.detections) d.id = -1;
  return message;
}

template <class Stream>
Outcome run_slam(const Stream& stream, double sampling, bool known_ids, const filters::SlamFilterParameters& p,
                 std::uint64_t seed) {
  const auto slam = filters::make_slam_filter(p, seed, stream.world.start_in_map);
  Outcome outcome;
  outcome.trajectory = follow(
      stream, sampling, [&](const Odometry& o) { slam->predict(o); },
      [&](const LandmarkDetections& d) {
        slam->update(known_ids ? d : without_ids(d));
        const SlamEstimate estimate = slam->estimate();
        if (estimate.nis > 0.0) outcome.nis.push_back(estimate.nis);
        return estimate.pose;
      });
  outcome.map = slam->map();
  return outcome;
}

/// With a map along its path where there is one to compare it with.
template <class Stream>
Outcome dead_reckon(const Stream& stream, double sampling) {
  Pose2 pose = stream.world.start_in_map;
  PathMapper mapper(pose);
  const bool judged = !stream.world.landmarks.empty();
  Outcome outcome;
  outcome.trajectory = follow(
      stream, sampling, [&](const Odometry& o) { pose = pose * o.increment; },
      [&](const LandmarkDetections& d) {
        if (judged) mapper.take(d, pose);
        return pose;
      });
  if (judged) outcome.map = mapper.map();
  return outcome;
}

template <class Stream>
Outcome localise(const Stream& stream, double sampling, const filters::EkfLocalisationParameters& p) {
  filters::EkfLocalisation filter(stream.world.landmarks, stream.world.start_in_map, p);
  Outcome outcome;
  outcome.trajectory = follow(
      stream, sampling, [&](const Odometry& o) { filter.predict(o); },
      [&](const LandmarkDetections& d) {
        filter.update(d);
        if (filter.nis() > 0.0) outcome.nis.push_back(filter.nis());
        return filter.pose().mean;
      });
  return outcome;
}

template <class Stream>
Outcome smooth(const Stream& stream, double sampling, const smoothing::LandmarkSmootherParameters& p) {
  smoothing::LandmarkSmoother smoother(p, stream.world.start_in_map);
  for (const Observation& observation : stream.observations) {
    if (const auto* o = std::get_if<Odometry>(&observation)) smoother.predict(*o);
    if (const auto* d = std::get_if<LandmarkDetections>(&observation)) smoother.update(*d);
  }
  const smoothing::SmoothedRun run = smoother.solve();
  std::size_t next = 0;
  return {follow(
              stream, sampling, [](const Odometry&) {},
              [&](const LandmarkDetections&) { return run.path.poses[next++].pose; }),
          run.map,
          {run.dof > 0 ? run.chi2 / run.dof : kNan}};
}

/// Poses at the fixes, each by odometry and every other fix without the one that judges it.
template <class Stream>
Outcome smooth_by_fixes(const Stream& stream, const FixSmootherParameters& p) {
  std::vector<PoseGaussian> motions;
  PoseGaussian motion;
  auto fix = stream.world.fixes.begin();
  for (const Observation& observation : stream.observations) {
    const auto* o = std::get_if<Odometry>(&observation);
    if (o == nullptr) continue;
    for (; fix != stream.world.fixes.end() && fix->utime <= o->stamp.utime; ++fix) {
      motions.push_back(motion);
      motion = {};
    }
    motion = motion * PoseGaussian{o->increment, o->covariance};
  }
  const PoseGaussian start{stream.world.start_in_map, p.start_sd * p.start_sd * Matrix3::Identity()};
  const Matrix2 r = p.fix_sd * p.fix_sd * Matrix2::Identity();
  Outcome outcome;
  outcome.trajectory.resize(motions.size());
  for (std::size_t judged = 0; judged < 2; ++judged) {
    std::vector<std::optional<Vector2>> fixes{std::nullopt};  // the start is none
    for (std::size_t k = 0; k < motions.size(); ++k) {
      fixes.push_back(k % 2 == judged ? std::nullopt : std::optional(stream.world.fixes[k].position));
    }
    const std::vector<PoseGaussian> poses = smoothing::smooth_fixes(start, motions, fixes, r);
    for (std::size_t k = judged; k < motions.size(); k += 2) {
      outcome.trajectory[k] = {stream.world.fixes[k].utime, poses[k + 1].mean};
    }
  }
  return outcome;
}

/// Estimates and truth at the same times; a fix has the heading of the estimate, which is nobody's truth.
template <class Stream>
std::vector<eval::PosePair> pairs_of(const Outcome& outcome, const Stream& stream, double max_gap) {
  if (!stream.truth.empty()) return eval::associate(outcome.trajectory, stream.truth, max_gap);
  std::vector<eval::PosePair> pairs;
  for (const KnownPosition& fix : stream.world.fixes) {
    const auto estimate = eval::interpolate(outcome.trajectory, fix.utime, max_gap);
    if (estimate) pairs.push_back({fix.utime, *estimate, {fix.position.x(), fix.position.y(), estimate->yaw}});
  }
  return pairs;
}

Series error_over_time(const std::vector<eval::PosePair>& aligned, std::int64_t begin, double duration, double gap) {
  Series series{"position_error", "m", {}, {}};
  auto pair = aligned.begin();
  for (double t = kSeriesStep; t <= duration; t += kSeriesStep) {
    const std::int64_t utime = begin + static_cast<std::int64_t>(1e6 * t);
    while (pair != aligned.end() && pair->utime < utime) ++pair;
    const bool known = pair != aligned.end() && seconds(pair->utime - utime) <= gap;
    series.time.push_back(t);
    series.values.push_back(known ? (pair->estimate.position() - pair->truth.position()).norm() : kNan);
  }
  return series;
}

/// Landmarks brought to the truth by the alignment of the trajectory.
LandmarkMap moved(const eval::Similarity2& s, LandmarkMap map) {
  for (LandmarkEstimate& l : map.landmarks) l.parameters.head<2>() = s * l.parameters.head<2>();
  return map;
}

}  // namespace

RecordedLandmarks::RecordedLandmarks(const ScenarioSpec& spec)
    : parameters_(config::load<RecordedLandmarksParameters>(spec.config)) {
  if (!std::filesystem::is_directory(folder_of(parameters_))) {
    throw InputError("scenario '" + spec.name + "': source.path: expected the folder of a recording, got '" +
                     folder_of(parameters_).string() + "' (recordings are not part of Noctule)");
  }
  const auto* mrclam = std::get_if<datasets::MrclamParameters>(&parameters_.source);
  known_ids_ = mrclam != nullptr && mrclam->known_ids;
}

RecordedLandmarks::~RecordedLandmarks() = default;

const RecordedLandmarks::Stream& RecordedLandmarks::stream() const {
  std::call_once(read_once_, [this] {
    const auto source = std::visit([](const auto& p) { return open(p); }, parameters_.source);
    auto stream = std::make_unique<Stream>();
    stream->world = source->world();
    std::optional<std::int64_t> begin;
    std::int64_t end = 0;
    while (auto observation = source->next()) {
      if (const auto* g = std::get_if<GroundTruth>(&*observation)) {
        stream->truth.push_back({g->stamp.utime, g->base_in_map});
        continue;
      }
      if (const auto* o = std::get_if<Odometry>(&*observation)) {
        if (!begin) begin = o->stamp.utime;
        end = o->stamp.utime;
        stream->way += o->increment.position().norm();
      } else {
        ++stream->messages;
      }
      stream->observations.push_back(std::move(*observation));
    }
    stream->begin = begin.value_or(0);
    stream->duration = begin ? seconds(end - *begin) : 0.0;
    if (stream->messages == 0) throw InputError(folder_of(parameters_).string() + ": expected sightings, got none");
    if (stream->truth.empty() && stream->world.fixes.empty()) {
      throw InputError(folder_of(parameters_).string() + ": expected true poses or fixes, got none");
    }
    stream_ = std::move(stream);
  });
  return *stream_;
}

std::vector<std::string> RecordedLandmarks::filters() const {
  std::vector<std::string> names = filters::kSlamFilterNames;
  names.emplace_back(kDeadReckoning);
  if (std::holds_alternative<datasets::MrclamParameters>(parameters_.source)) {
    names.insert(names.end(), {kKnownMap, kSmoother});
  } else {
    names.emplace_back(kFixes);
  }
  return names;
}

std::vector<std::string> RecordedLandmarks::metrics() const {
  return {"position_rmse",    "position_rmse_unaligned",
          "position_max",     "heading_rmse",
          "rpe_translation",  "rpe_rotation",
          "landmark_rmse",    "landmarks_found",
          "landmarks_missed", "landmarks_invented",
          "landmarks",        "nis_mean",
          "position_error"};
}

void RecordedLandmarks::check(const FilterSpec& filter) const {
  if (is_slam_filter(filter.name)) {
    static_cast<void>(slam_filter_parameters(filter));
  } else if (filter.name == kKnownMap) {
    static_cast<void>(config::load<filters::EkfLocalisationParameters>(effective_config(filter)));
  } else if (filter.name == kFixes) {
    static_cast<void>(config::load<FixSmootherParameters>(effective_config(filter)));
  } else if (filter.name == kSmoother) {
    static_cast<void>(config::load<smoothing::LandmarkSmootherParameters>(effective_config(filter)));
  }
}

FilterRun RecordedLandmarks::run_one(std::uint64_t seed, const FilterSpec& spec) const {
  const Stream& data = stream();
  reset_peak_memory();
  const double sampling = parameters_.sampling, begin = cpu_seconds();
  Outcome outcome;
  if (spec.name == kDeadReckoning) {
    outcome = dead_reckon(data, sampling);
  } else if (spec.name == kKnownMap) {
    outcome = localise(data, sampling, config::load<filters::EkfLocalisationParameters>(effective_config(spec)));
  } else if (spec.name == kFixes) {
    outcome = smooth_by_fixes(data, config::load<FixSmootherParameters>(effective_config(spec)));
  } else if (spec.name == kSmoother) {
    outcome = smooth(data, sampling, config::load<smoothing::LandmarkSmootherParameters>(effective_config(spec)));
  } else {
    outcome = run_slam(data, sampling, known_ids_, slam_filter_parameters(spec), seed);
  }
  const double cpu = cpu_seconds() - begin;

  std::vector<eval::PosePair> pairs = pairs_of(outcome, data, parameters_.max_truth_gap);
  FilterRun run;
  run.diverged = pairs.empty() || !outcome.trajectory.back().pose.finite() ||
                 has_diverged((pairs.back().estimate.position() - pairs.back().truth.position()).norm(), data.way);
  run.figures.push_back({"position_rmse_unaligned", eval::pose_errors(pairs).position_rmse, "m"});
  const eval::Similarity2 alignment = eval::align(positions(pairs, &eval::PosePair::estimate),
                                                  positions(pairs, &eval::PosePair::truth), eval::Alignment::rigid);
  for (eval::PosePair& p : pairs) p.estimate = moved(alignment, p.estimate);
  const eval::PoseErrors errors = eval::pose_errors(pairs);
  run.figures.push_back({"position_rmse", errors.position_rmse, "m"});
  run.figures.push_back({"position_max", errors.position_max, "m"});
  if (!data.truth.empty()) {
    run.figures.push_back({"heading_rmse", errors.heading_rmse, "rad"});
    std::ranges::move(eval::relative_pose_metrics(pairs, parameters_.rpe_length), std::back_inserter(run.figures));
  }
  if (!outcome.map.landmarks.empty()) {
    run.figures.push_back({"landmarks", static_cast<double>(outcome.map.landmarks.size()), "1"});
  }
  if (!outcome.map.landmarks.empty() && !data.world.landmarks.empty()) {
    const eval::LandmarkErrors landmarks = eval::landmark_errors(moved(alignment, outcome.map), data.world.landmarks,
                                                                 {.gate = parameters_.landmark_gate,
                                                                  .known_ids = known_ids_ || !is_slam_filter(spec.name),
                                                                  .alignment = eval::Alignment::rigid});
    run.figures.push_back({"landmark_rmse", landmarks.rmse, "m"});
    run.figures.push_back({"landmarks_found", static_cast<double>(landmarks.found), "1"});
    run.figures.push_back({"landmarks_missed", static_cast<double>(landmarks.missed), "1"});
    run.figures.push_back({"landmarks_invented", static_cast<double>(landmarks.invented), "1"});
  }
  if (!outcome.nis.empty()) {
    double sum = 0.0;
    for (const double nis : outcome.nis) sum += nis;
    run.figures.push_back({"nis_mean", sum / static_cast<double>(outcome.nis.size()), "1"});
  }
  if (!outcome.trajectory.empty()) {
    run.series.push_back(error_over_time(pairs, data.begin, data.duration, 1.0));
  }
  run.timings = {{"cpu_per_scan", cpu / static_cast<double>(data.messages), "s"},
                 {"realtime_factor", data.duration / std::max(cpu, 1e-9), "1"},
                 {"peak_memory", peak_memory(), "B"}};
  return run;
}

std::vector<FilterRun> RecordedLandmarks::run(std::uint64_t seed, std::span<const FilterSpec> filters) const {
  std::vector<FilterRun> runs;
  for (const FilterSpec& spec : filters) {
    if (is_slam_filter(spec.name)) {
      runs.push_back(run_one(seed, spec));
      continue;
    }
    const std::lock_guard lock(seedless_mutex_);
    const std::string key = spec.name + ' ' + spec.parameters;
    auto found = seedless_.find(key);
    if (found == seedless_.end()) found = seedless_.emplace(key, run_one(seed, spec)).first;
    runs.push_back(found->second);
  }
  return runs;
}

}  // namespace noctule::experiment
