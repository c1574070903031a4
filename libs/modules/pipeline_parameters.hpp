#pragma once
/// What a pipeline file says (config/pipelines/*.yaml).
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "datasets/images.hpp"
#include "datasets/mrclam.hpp"
#include "datasets/rawlog.hpp"
#include "datasets/sonar_bigwheel.hpp"
#include "datasets/sonar_corridor.hpp"
#include "datasets/sonar_scitos24.hpp"
#include "datasets/ultrasonic_rooms.hpp"
#include "datasets/victoria_park.hpp"
#include "mapping/occupancy_grid.hpp"
#include "modules/mapper_module.hpp"
#include "modules/slam_module.hpp"
#include "sensors/camera/landmark_camera.hpp"
#include "sensors/ultrasonic/extractor.hpp"
#include "sim/landmark_parameters.hpp"
#include "sim/robot.hpp"
#include "sim/world.hpp"

namespace noctule::modules {

struct SimulatorParameters {
  sim::WorldParameters world;
  sim::RobotParameters robot;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("world", &SimulatorParameters::world, "room and way");
    v.group("robot", &SimulatorParameters::robot, "drive and sensors");
  }
};

/// An LCM log with observations, as noctule-pipeline and lcm-logger write them.
struct LogParameters {
  std::filesystem::path path;
  bool sightings = true;
  std::optional<sim::WorldParameters> world;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("path", &LogParameters::path, "the log");
    v.field("sightings", &LogParameters::sightings,
            "whether recorded sightings are played; false: a camera module makes them anew from recorded images");
    v.group("world", &LogParameters::world, "where it was recorded: known room and start, for evaluation");
  }
};

using SourceParameters =
    std::variant<SimulatorParameters, LogParameters, datasets::MrclamParameters, datasets::SonarCorridorParameters,
                 datasets::SonarBigwheelParameters, datasets::SonarScitos24Parameters,
                 datasets::UltrasonicRoomsParameters, datasets::RawlogParameters, datasets::VictoriaParkParameters,
                 sim::LandmarkWorldParameters, datasets::ImageFolderParameters, datasets::VideoParameters,
                 datasets::CameraDeviceParameters>;

struct PipelineParameters {
  std::string name = "unnamed";
  std::uint64_t seed = 1;
  SourceParameters source;
  std::optional<sensors::ExtractorParameters> ultrasonic;
  std::optional<sensors::LandmarkCameraParameters> camera;
  std::optional<SlamModuleParameters> slam;
  std::optional<MapperModuleParameters> mapping;
  std::optional<mapping::OccupancyParameters> occupancy;
  bool rawlog = false;
  bool record_images = false;
  int jpeg_quality = 0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = PipelineParameters;
    v.field("name", &P::name, "title of the report");
    v.field("seed", &P::seed, "seed of all random numbers");
    v.one_of("source", &P::source,
             {"simulator", "log", "mrclam", "sonar_corridor", "sonar_bigwheel", "sonar_scitos24", "ultrasonic_rooms",
              "rawlog", "victoria_park", "landmark_world", "images", "video", "v4l2"},
             "where observations come from");
    v.group("ultrasonic", &P::ultrasonic, "contour features from ultrasonic scans; absent: scans go to SLAM alone");
    v.group("camera", &P::camera, "landmarks in the images of a camera; absent: images are passed over");
    v.group("slam", &P::slam, "absent: no filter");
    v.group("mapping", &P::mapping, "absent: no maps of contours");
    v.group("occupancy", &P::occupancy, "absent: no occupancy map");
    v.field("rawlog", &P::rawlog, "write the observations as an MRPT rawlog too");
    v.field("record_images", &P::record_images, "keep the images in the run's log, where they take most of the room");
    v.field("jpeg_quality", &P::jpeg_quality, unit::one,
            "of images on the bus, 1 to 100, so that they fit into few datagrams; 0: raw", between(0, 100));
  }
  [[nodiscard]] std::string validate() const {
    if (ultrasonic && !slam) return "ultrasonic: expected the section 'slam' too, which takes its features";
    const auto* log = std::get_if<LogParameters>(&source);
    if (camera && log != nullptr && log->sightings) {
      return "source.sightings: expected false beside the section 'camera', which makes sightings of its own";
    }
    return {};
  }
};

}  // namespace noctule::modules
