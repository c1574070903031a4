#include "modules/recorder_module.hpp"

#include "eval/contour_error.hpp"
#include "eval/room_alignment.hpp"
#include "mapping/contour_mapper.hpp"
#include "noctule/contour_map.hpp"
#include "noctule/ground_truth.hpp"
#include "noctule/landmark_detections.hpp"
#include "noctule/landmark_map.hpp"
#include "noctule/odometry.hpp"
#include "noctule/path_estimate.hpp"
#include "noctule/slam_estimate.hpp"
#include "noctule/ultrasonic_scan.hpp"
#include "report/results.hpp"

namespace noctule::modules {
namespace {

const char* state_name(std::int8_t state) {
  switch (state) {
    case module_status::STATE_STARTING:
      return "starting";
    case module_status::STATE_RUNNING:
      return "running";
    case module_status::STATE_DEGRADED:
      return "degraded";
    case module_status::STATE_FAILED:
      return "failed";
    default:
      return "finished";
  }
}

eval::ContourErrors errors_of(const ContourMap& map, const KnownWorld& world) {
  if (!world.start_is_rough) return eval::contour_errors(map, *world.room);
  const Vector2 place = world.start_in_map.position();
  return eval::contour_errors(eval::align_to_room(map, *world.room, {&place, 1}));
}

report::ModuleReport report_of(const module_status& status) {
  return {.name = status.module,
          .state = state_name(status.state),
          .received = status.received,
          .missed = status.missed,
          .duplicates = status.duplicates,
          .late = status.late,
          .dropped = status.dropped,
          .errors = status.errors,
          .last_error = status.last_error,
          .warning = status.warning};
}

}  // namespace

RecorderModule::RecorderModule(bus::Bus& bus, KnownWorld world) : Module(bus, "recorder") {
  data_.world = std::move(world);
  listen_to_observations();
  listen_to_estimates();
  listen_to_maps();
  listen_to_modules();
}

void RecorderModule::listen_to_observations() {
  listen<odometry>(bus::channel::kOdometry, [this](const Odometry& o) {
    see(o.stamp.utime);
    dead_reckoning_.move(o, data_.world.start_in_map);
  });
  listen<ground_truth>(bus::channel::kGroundTruth, [this](const GroundTruth& truth) {
    see(truth.stamp.utime);
    truth_.add(truth.stamp.utime, truth.base_in_map);
  });
  listen<ultrasonic_scan>(bus::channel::kUltrasonicScan, [this](const UltrasonicScan& scan) {
    see(scan.stamp.utime);
    dead_reckoning_.begin(scan.stamp.utime, data_.world.start_in_map);
    scans_.push_back(scan);
  });
  listen<landmark_detections>(bus::channel::kLandmarkDetections,
                              [this](const LandmarkDetections& detections) { see(detections.stamp.utime); });
}

void RecorderModule::listen_to_estimates() {
  listen<slam_estimate>(bus::channel::kSlamEstimate,
                        [this](const SlamEstimate& estimate) { data_.estimates.push_back(estimate); });
  listen<path_estimate>(bus::channel::kSlamPath, [this](const PathEstimate& path) { data_.path = path; });
  listen<landmark_map>(bus::channel::kSlamMap, [this](const LandmarkMap& map) { data_.landmarks = map; });
}

void RecorderModule::listen_to_maps() {
  listen<contour_map>(bus::channel::kContourMap, [this](const ContourMap& map) { data_.contours = {map, {}}; });
  listen<contour_map>(bus::channel::kContourMapKnownPose, [this](const ContourMap& map) {
    data_.contours_known_pose = {map, {}};
  });
  listen<contour_map>(bus::channel::kContourMapDeadReckoning, [this](const ContourMap& map) {
    data_.contours_dead_reckoning = {map, {}};
  });
}

void RecorderModule::listen_to_modules() {
  watch_modules([this](const module_status& status) {
    if (status.module != name()) statuses_[status.module] = status;
  });
}

void RecorderModule::see(std::int64_t utime) {
  if (!first_utime_) first_utime_ = utime;
  last_utime_ = utime;
}

std::vector<mapping::PosedScan> RecorderModule::best_posed_scans() const {
  if (data_.path.poses.empty()) return posed_scans(scans_, dead_reckoning_);
  Trajectory path(Trajectory::Between::nothing);
  for (const PathPose& pose : data_.path.poses) path.add(pose.utime, pose.pose);
  return posed_scans(scans_, path);
}

report::RunData RecorderModule::data() const {
  report::RunData data = data_;
  data.duration = data_seconds();
  data.truth = truth_.poses();
  data.dead_reckoning = dead_reckoning_.poses();
  if (data.world.room) {
    for (auto* result : {&data.contours, &data.contours_known_pose, &data.contours_dead_reckoning}) {
      if (*result) (*result)->errors = errors_of((*result)->map, data.world);
    }
    if (data.world.start_is_rough) {
      data.notes.push_back(
          "Where the recording began is only roughly known. Maps are drawn as if it were known; the error of a wall is "
          "what remains after the others have aligned the map with the room, and only walls that can be heard from the "
          "start count.");
    }
  }
  data.direct_points = mapping::direct_points(posed_scans(scans_, dead_reckoning_));
  for (const auto& [name, status] : statuses_) {
    data.modules.push_back(report_of(status));
    if (!status.warning.empty()) data.warnings.push_back(name + ": " + status.warning);
  }
  data.metrics = report::run_metrics(data);
  return data;
}

}  // namespace noctule::modules
