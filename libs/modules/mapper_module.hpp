#pragma once
#include <optional>
#include <string>
#include <vector>

#include "mapping/contour_mapper.hpp"
#include "modules/module.hpp"
#include "modules/posed_scans.hpp"

namespace noctule::modules {

/// Whose poses a map is made with.
enum class PoseSource : std::int8_t {
  slam,          ///< SLAM_ESTIMATE while running, the last SLAM_PATH at the end
  ground_truth,  ///< GROUND_TRUTH: what no filter can beat
  odometry       ///< ODOMETRY alone: dead reckoning
};

struct MapperModuleParameters {
  mapping::MapperParameters contours;
  bool incremental = true;
  double map_period = 2.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = MapperModuleParameters;
    v.group("contours", &P::contours, "walls, cylinders and points from echoes");
    v.field("incremental", &P::incremental, "make maps while running, not only the final one");
    v.field("map_period_s", &P::map_period, unit::second, "time between two maps on the bus", positive());
  }
};

/// What a mapper knows of its place in the pipeline.
struct MapperRole {
  PoseSource poses = PoseSource::slam;
  Pose2 start;               ///< of the base, map frame: where dead reckoning begins
  std::optional<Room> room;  ///< to be judged against, where it is known
};

/// ULTRASONIC_SCAN and poses -> CONTOUR_MAP (or CONTOUR_MAP_KNOWN_POSE, CONTOUR_MAP_DEAD_RECKONING), incremental while
/// running, from all scans and their final poses at the end; with SLAM's poses and a known room CONTOUR_ERRORS too.
class MapperModule : public Module {
 public:
  MapperModule(bus::Bus& bus, const MapperModuleParameters& parameters, MapperRole role);

 private:
  void listen_for_poses();
  void take_scan(const UltrasonicScan& scan);
  void map_placed_scans();
  void publish_map(ContourMap map);
  void on_finish() override;

  MapperModuleParameters parameters_;
  MapperRole role_;
  mapping::ContourMapper mapper_;
  std::vector<UltrasonicScan> scans_;
  std::size_t mapped_ = 0;  ///< of the scans, while running
  Trajectory trajectory_;
  Trajectory path_;  ///< the latest SLAM_PATH
  std::optional<std::int64_t> map_utime_;
};

}  // namespace noctule::modules
