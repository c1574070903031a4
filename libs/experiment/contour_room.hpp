#pragma once
/// A simulated robot hears a room, and perhaps sees it: extractor, detectors, filter and mapper as in the pipeline,
/// without a bus.
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "mapping/contour_mapper.hpp"
#include "sensors/camera/landmark_camera.hpp"
#include "sensors/ultrasonic/extractor.hpp"
#include "sim/robot.hpp"
#include "sim/world.hpp"

namespace noctule::experiment {

struct ContourRoomParameters {
  sim::WorldParameters world;
  sim::RobotParameters robot;
  sensors::ExtractorParameters extractor;
  std::optional<sensors::LandmarkCameraParameters> camera;
  mapping::MapperParameters mapper;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("world", &ContourRoomParameters::world, "room and way");
    v.group("robot", &ContourRoomParameters::robot, "drive and sensors");
    v.group("extractor", &ContourRoomParameters::extractor, "contour features from three positions");
    v.group("camera", &ContourRoomParameters::camera, "landmarks in the pictures of the robot's camera; absent: none");
    v.group("mapper", &ContourRoomParameters::mapper, "the batch mapper that judges every filter's path");
  }
  [[nodiscard]] std::string validate() const {
    return camera && !robot.camera ? "camera: expected a robot with a camera, got one without" : "";
  }
};

/// Filters: `pf` (particle SLAM), `known_pose` (mapping along the true path, the limit) and `dead_reckoning`. All are
/// mapped by the same batch mapper from the same scans, whatever the filter was fed with: the parameter `sensors` of a
/// filter says `sonar`, `camera` or `both` (all there are, where it is left out). Pictures are drawn and looked at once
/// a seed.
class ContourRoom : public Scenario {
 public:
  explicit ContourRoom(const ScenarioSpec&);
  [[nodiscard]] std::vector<std::string> filters() const override;
  [[nodiscard]] std::vector<std::string> metrics() const override;
  void check(const FilterSpec&) const override;
  [[nodiscard]] std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec>) const override;

 private:
  ContourRoomParameters parameters_;
};

}  // namespace noctule::experiment
