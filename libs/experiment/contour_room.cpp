#include "experiment/contour_room.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>

#include "config/config.hpp"
#include "core/error.hpp"
#include "datasets/images.hpp"
#include "eval/contour_error.hpp"
#include "eval/trajectory.hpp"
#include "experiment/slam_filters.hpp"
#include "sim/room_geometry.hpp"
#include "sim/simulator.hpp"

namespace noctule::experiment {
namespace {

/// What every filter is fed: one stop of the robot.
struct Stop {
  std::vector<Odometry> odometry;  ///< since the previous stop
  UltrasonicScan scan;
  ContourFeatures features;
  std::optional<LandmarkDetections> sightings;
  Pose2 truth;
};

struct Stream {
  std::vector<Stop> stops;
  KnownWorld world;
  double path_length = 0.0;
};

Stream record(const ContourRoomParameters& parameters, std::uint64_t seed) {
  sim::RobotParameters robot = parameters.robot;
  if (!parameters.camera) robot.camera.reset();  // nobody looks
  sim::Simulator simulator(parameters.world, robot, seed);
  sensors::UltrasonicExtractor extractor(parameters.extractor);
  std::optional<sensors::LandmarkCamera> camera;
  if (parameters.camera) camera.emplace(*parameters.camera, datasets::read_image);
  Stream stream{{}, simulator.world(), 0.0};
  std::vector<Odometry> odometry;
  Pose2 truth = stream.world.start_in_map;
  while (const auto observation = simulator.next()) {
    if (const auto* o = std::get_if<Odometry>(&*observation)) {
      odometry.push_back(*o);
      extractor.predict(*o);
    } else if (const auto* g = std::get_if<GroundTruth>(&*observation)) {
      stream.path_length += (g->base_in_map.position() - truth.position()).norm();
      truth = g->base_in_map;
    } else if (const auto* scan = std::get_if<UltrasonicScan>(&*observation)) {
      stream.stops.push_back({std::move(odometry), *scan, extractor.update(*scan), std::nullopt, truth});
      odometry.clear();
    } else if (const auto* image = std::get_if<CameraImage>(&*observation)) {
      stream.stops.back().sightings = camera->detect(*image);
    }
  }
  return stream;
}

/// What a filter is fed with beside odometry.
struct Senses {
  bool sonar = true;
  bool camera = true;
};

constexpr std::string_view kSensors = "sensors=";

/// Takes the parameter `sensors` out of a filter's.
Senses take_senses(FilterSpec& spec) {
  std::string rest, which = "both";
  std::istringstream parts(spec.parameters);
  for (std::string part; std::getline(parts, part, ';');) {
    if (part.starts_with(kSensors)) {
      which = part.substr(kSensors.size());
    } else {
      rest += (rest.empty() ? "" : ";") + part;
    }
  }
  spec.parameters = rest;
  if (which != "sonar" && which != "camera" && which != "both") {
    throw InputError("filter '" + spec.name + "': sensors: expected sonar, camera or both, got '" + which + "'");
  }
  return {.sonar = which != "camera", .camera = which != "sonar"};
}

/// Poses of the base at the stops, and what else the filter said.
struct Result {
  std::vector<Pose2> online;  ///< estimate at each stop, when it was made
  std::vector<Pose2> path;    ///< final estimate of each stop
  std::vector<double> nees;
  std::optional<LandmarkMap> landmarks;  ///< of a filter that saw some
};

Result dead_reckon(const Stream& stream) {
  Result result;
  Pose2 pose = stream.world.start_in_map;
  for (const Stop& stop : stream.stops) {
    for (const Odometry& o : stop.odometry) pose = pose * o.increment;
    result.path.push_back(pose);
  }
  result.online = result.path;
  return result;
}

Result true_path(const Stream& stream) {
  Result result;
  for (const Stop& stop : stream.stops) result.path.push_back(stop.truth);
  result.online = result.path;
  return result;
}

Result filter(const Stream& stream, FilterSpec spec, std::uint64_t seed) {
  const Senses senses = take_senses(spec);
  const auto slam = filters::make_slam_filter(slam_filter_parameters(spec), seed, stream.world.start_in_map);
  Result result;
  for (const Stop& stop : stream.stops) {
    for (const Odometry& o : stop.odometry) slam->predict(o);
    if (senses.sonar) slam->update(stop.scan, stop.features);
    if (senses.camera && stop.sightings) slam->update(*stop.sightings);
    const SlamEstimate estimate = slam->estimate();
    result.online.push_back(estimate.pose);
    const double nees = eval::nees(estimate.pose, estimate.covariance, stop.truth);
    if (std::isfinite(nees)) result.nees.push_back(nees);
  }
  std::map<std::int64_t, Pose2> path;  // by time; the latest where echoes and sightings share one
  for (const PathPose& pose : slam->path().poses) path[pose.utime] = pose.pose;
  for (const Stop& stop : stream.stops) result.path.push_back(path.at(stop.scan.stamp.utime));
  if (senses.camera) result.landmarks = slam->map();
  return result;
}

bool diverged(const Result& result, const Stream& stream) {
  if (result.online.empty()) return true;
  const Pose2& last = result.online.back();
  return !last.finite() ||
         has_diverged((last.position() - stream.stops.back().truth.position()).norm(), stream.path_length);
}

std::vector<eval::Metric> figures(const Result& result, const Stream& stream, const mapping::MapperParameters& mapper) {
  std::vector<mapping::PosedScan> scans;
  std::vector<eval::PosePair> pairs;
  for (std::size_t i = 0; i < stream.stops.size(); ++i) {
    scans.push_back({stream.stops[i].scan, result.path[i]});
    pairs.push_back({stream.stops[i].scan.stamp.utime, result.online[i], stream.stops[i].truth});
  }
  const eval::ContourErrors errors =
      eval::contour_errors(mapping::map_contours(scans, mapper), stream.world.room.value());
  std::vector<eval::Metric> metrics = eval::contour_metrics(errors);
  metrics.push_back({"complete", errors.complete() ? 1.0 : 0.0, "1"});
  const eval::PoseErrors pose = eval::pose_errors(pairs);
  metrics.push_back({"position_rmse", pose.position_rmse, "m"});
  metrics.push_back({"heading_rmse", pose.heading_rmse, "rad"});
  if (!result.nees.empty()) metrics.push_back({"nees_mean", eval::nees_summary(result.nees).mean, "1"});
  if (result.landmarks && !stream.world.landmarks.empty()) {
    const eval::LandmarkErrors landmarks =
        eval::landmark_errors(*result.landmarks, stream.world.landmarks, {.known_ids = true});
    metrics.push_back({"landmark_rmse", landmarks.rmse, "m"});
    metrics.push_back({"landmarks_found", static_cast<double>(landmarks.found), "1"});
  }
  return metrics;
}

}  // namespace

ContourRoom::ContourRoom(const ScenarioSpec& spec) : parameters_(config::load<ContourRoomParameters>(spec.config)) {}

std::vector<std::string> ContourRoom::filters() const {
  return {"pf", "vb_pf", "em_pf", kKnownPose, kDeadReckoning};
}

std::vector<std::string> ContourRoom::metrics() const {
  const Room room = sim::RoomGeometry(parameters_.world.room).known_room();
  std::vector<std::string> names;
  for (const eval::Metric& m : eval::contour_metrics(eval::contour_errors({}, room))) {
    names.push_back(m.name);
  }
  names.insert(names.end(), {"complete", "position_rmse", "heading_rmse", "nees_mean"});
  if (parameters_.camera) names.insert(names.end(), {"landmark_rmse", "landmarks_found"});
  return names;
}

void ContourRoom::check(const FilterSpec& filter) const {
  if (!is_slam_filter(filter.name)) return;
  FilterSpec spec = filter;
  const Senses senses = take_senses(spec);
  static_cast<void>(slam_filter_parameters(spec));
  if (!senses.sonar && !parameters_.camera) {
    throw InputError("filter '" + filter.name + "': sensors: expected sonar where there is no camera, got camera");
  }
}

std::vector<FilterRun> ContourRoom::run(std::uint64_t seed, std::span<const FilterSpec> filters) const {
  const Stream stream = record(parameters_, seed);
  std::vector<FilterRun> runs;
  for (const FilterSpec& spec : filters) {
    reset_peak_memory();
    const double begin = cpu_seconds();
    const Result result = spec.name == kKnownPose       ? true_path(stream)
                          : spec.name == kDeadReckoning ? dead_reckon(stream)
                                                        : filter(stream, spec, seed);
    const double filter_time = cpu_seconds() - begin;
    runs.push_back({.figures = figures(result, stream, parameters_.mapper),
                    .timings = {{"cpu_per_scan", filter_time / static_cast<double>(stream.stops.size()), "s"},
                                {"peak_memory", peak_memory(), "B"}},
                    .series = {},
                    .diverged = diverged(result, stream)});
  }
  return runs;
}

}  // namespace noctule::experiment
