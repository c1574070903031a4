#include "modules/mapper_module.hpp"

#include "eval/contour_error.hpp"
#include "modules/contour_errors_message.hpp"
#include "modules/names.hpp"
#include "noctule/ground_truth.hpp"
#include "noctule/odometry.hpp"
#include "noctule/path_estimate.hpp"
#include "noctule/slam_estimate.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::modules {
namespace {

struct Output {
  const char* module;
  const char* channel;
};
Output output_of(PoseSource poses) {
  switch (poses) {
    case PoseSource::ground_truth:
      return {name::kMapperKnownPose, bus::channel::kContourMapKnownPose};
    case PoseSource::odometry:
      return {name::kMapperDeadReckoning, bus::channel::kContourMapDeadReckoning};
    case PoseSource::slam:
      break;
  }
  return {name::kMapper, bus::channel::kContourMap};
}

Trajectory::Between between_poses_of(PoseSource poses) {
  switch (poses) {
    case PoseSource::ground_truth:
      return Trajectory::Between::linear;
    case PoseSource::odometry:
      return Trajectory::Between::hold;
    case PoseSource::slam:
      break;
  }
  return Trajectory::Between::nothing;
}

}  // namespace

MapperModule::MapperModule(bus::Bus& bus, const MapperModuleParameters& parameters, MapperRole role)
    : Module(bus, output_of(role.poses).module),
      parameters_(parameters),
      role_(std::move(role)),
      mapper_(parameters.contours),
      trajectory_(between_poses_of(role_.poses)),
      path_(Trajectory::Between::nothing) {
  listen_for_poses();
  listen<ultrasonic_scan>(bus::channel::kUltrasonicScan, [this](const UltrasonicScan& scan) { take_scan(scan); });
  finish_after({role_.poses == PoseSource::slam ? name::kSlam : name::kSource});
}

void MapperModule::listen_for_poses() {
  switch (role_.poses) {
    case PoseSource::ground_truth:
      listen<ground_truth>(bus::channel::kGroundTruth, [this](const GroundTruth& truth) {
        trajectory_.add(truth.stamp.utime, truth.base_in_map);
        map_placed_scans();
      });
      break;
    case PoseSource::odometry:
      listen<odometry>(bus::channel::kOdometry, [this](const Odometry& o) { trajectory_.move(o, role_.start); });
      break;
    case PoseSource::slam:
      listen<slam_estimate>(bus::channel::kSlamEstimate, [this](const SlamEstimate& estimate) {
        trajectory_.add(estimate.stamp.utime, estimate.pose);
        map_placed_scans();
      });
      listen<path_estimate>(bus::channel::kSlamPath, [this](const PathEstimate& path) {
        path_.clear();
        for (const PathPose& pose : path.poses) path_.add(pose.utime, pose.pose);
      });
      break;
  }
}

void MapperModule::take_scan(const UltrasonicScan& scan) {
  if (role_.poses == PoseSource::odometry) trajectory_.begin(scan.stamp.utime, role_.start);
  scans_.push_back(scan);
  map_placed_scans();
}

void MapperModule::map_placed_scans() {
  if (!parameters_.incremental) return;
  for (; mapped_ < scans_.size(); ++mapped_) {
    const std::int64_t utime = scans_[mapped_].stamp.utime;
    if (const auto pose = trajectory_.at(utime)) {
      mapper_.add(scans_[mapped_], *pose);
      if (!map_utime_) map_utime_ = utime;
      if (seconds(utime - *map_utime_) < parameters_.map_period) continue;
      map_utime_ = utime;
      publish_map(mapper_.map());
    } else if (trajectory_.poses().empty() || trajectory_.poses().back().utime < utime) {
      return;  // its pose may still come
    }
  }
}

void MapperModule::publish_map(ContourMap map) {
  map.stamp.utime = scans_.back().stamp.utime;
  if (role_.room && role_.poses == PoseSource::slam) {
    publish(bus::channel::kContourErrors,
            contour_errors_message(eval::contour_errors(map, *role_.room), map.stamp.utime));
  }
  publish(output_of(role_.poses).channel, std::move(map));
}

void MapperModule::on_finish() {
  const bool no_truth = role_.poses == PoseSource::ground_truth && trajectory_.poses().empty();
  if (no_truth || scans_.empty()) return;
  const std::vector<mapping::PosedScan> posed =
      posed_scans(scans_, role_.poses == PoseSource::slam ? path_ : trajectory_);
  if (posed.size() < scans_.size()) {
    warn(std::to_string(scans_.size() - posed.size()) + " of " + std::to_string(scans_.size()) +
         " scans have no pose and are not on the map");
  }
  publish_map(mapping::map_contours(posed, parameters_.contours));
}

}  // namespace noctule::modules
