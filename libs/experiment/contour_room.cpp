#include "experiment/contour_room.hpp"

#include <ctime>

#include <algorithm>
#include <cmath>
#include <map>

#include "config/config.hpp"
#include "core/error.hpp"
#include "eval/contour_error.hpp"
#include "eval/trajectory.hpp"
#include "filters/slam/particle_slam.hpp"
#include "sim/simulator.hpp"

namespace noctule::experiment {
namespace {

constexpr const char* kFilters = "pf, known_pose, dead_reckoning";

/// What every filter is fed: one stop of the robot.
struct Stop {
  std::vector<Odometry> odometry;  ///< since the previous stop
  UltrasonicScan scan;
  ContourFeatures features;
  Pose2 truth;
};

struct Stream {
  std::vector<Stop> stops;
  KnownWorld world;
  double path_length = 0.0;
};

Stream record(const sim::WorldParameters& world, const sim::RobotParameters& robot,
              const sensors::ExtractorParameters& parameters, std::uint64_t seed) {
  sim::Simulator simulator(world, robot, seed);
  sensors::UltrasonicExtractor extractor(parameters);
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
      stream.stops.push_back({std::move(odometry), *scan, extractor.update(*scan), truth});
      odometry.clear();
    }
  }
  return stream;
}

/// Poses of the base at the stops, and what else the filter said.
struct Result {
  std::vector<Pose2> online;  ///< estimate at each stop, when it was made
  std::vector<Pose2> path;    ///< final estimate of each stop
  std::vector<double> nees;
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

Result filter(const Stream& stream, const filters::ParticleSlamParameters& parameters, std::uint64_t seed) {
  filters::ParticleSlam slam(parameters, seed, stream.world.start_in_map);
  Result result;
  for (const Stop& stop : stream.stops) {
    for (const Odometry& o : stop.odometry) slam.predict(o);
    slam.update(stop.scan, stop.features);
    const SlamEstimate estimate = slam.estimate();
    result.online.push_back(estimate.pose);
    const double nees = eval::nees(estimate.pose, estimate.covariance, stop.truth);
    if (std::isfinite(nees)) result.nees.push_back(nees);
  }
  for (const PathPose& pose : slam.path().poses) result.path.push_back(pose.pose);
  return result;
}

/// CPU seconds of this thread.
double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// More than 3 m and more than 10 % of the path off at the end, or not a number.
bool diverged(const Result& result, const Stream& stream) {
  if (result.online.empty()) return true;
  const Pose2& last = result.online.back();
  const double error = (last.position() - stream.stops.back().truth.position()).norm();
  return !last.finite() || error > std::max(3.0, 0.1 * stream.path_length);
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
  return metrics;
}

filters::ParticleSlamParameters parameters_of(const FilterSpec& spec) {
  if (spec.config.empty()) throw InputError("filter '" + spec.name + "': config: expected a file, got nothing");
  return config::load<filters::ParticleSlamParameters>(spec.config, assignments(spec));
}

}  // namespace

ContourRoom::ContourRoom(const ScenarioSpec& spec)
    : name_(spec.name),
      world_(config::load<sim::WorldParameters>(spec.world)),
      robot_(config::load<sim::RobotParameters>(spec.robot)) {}

void ContourRoom::check(std::span<const FilterSpec> filters) const {
  for (const FilterSpec& spec : filters) {
    if (spec.name == "pf") {
      static_cast<void>(parameters_of(spec));
    } else if (spec.name != "known_pose" && spec.name != "dead_reckoning") {
      throw InputError("scenario '" + name_ + "' cannot take filter '" + spec.name + "'; it knows: " + kFilters);
    }
  }
}

RunRows ContourRoom::run(std::uint64_t seed, std::span<const FilterSpec> filters) const {
  const Stream stream = record(world_, robot_, extractor_, seed);
  RunRows rows;
  for (const FilterSpec& spec : filters) {
    const double begin = cpu_seconds();
    const Result result = spec.name == "known_pose"       ? true_path(stream)
                          : spec.name == "dead_reckoning" ? dead_reckon(stream)
                                                          : filter(stream, parameters_of(spec), seed);
    const double filter_time = cpu_seconds() - begin;
    const bool bad = diverged(result, stream);
    for (const eval::Metric& m : figures(result, stream, mapper_)) {
      rows.figures.push_back({name_, spec.name, spec.parameters, seed, m.name, m.unit, m.value, bad});
    }
    rows.timings.push_back({name_, spec.name, spec.parameters, seed, "cpu_per_scan", "s",
                            filter_time / static_cast<double>(stream.stops.size()), bad});
  }
  return rows;
}

}  // namespace noctule::experiment
