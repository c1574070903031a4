#pragma once
/// A simulated robot hears a room: extractor, filter and mapper as in the pipeline, without a bus.
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "mapping/contour_mapper.hpp"
#include "sensors/ultrasonic/extractor.hpp"
#include "sim/robot.hpp"
#include "sim/world.hpp"

namespace noctule::experiment {

/// Filters: `pf` (particle SLAM), `known_pose` (mapping along the true path, the limit) and `dead_reckoning`. All are
/// mapped by the same batch mapper from the same scans.
class ContourRoom : public Scenario {
 public:
  explicit ContourRoom(const ScenarioSpec&);
  void check(std::span<const FilterSpec>) const override;
  [[nodiscard]] RunRows run(std::uint64_t seed, std::span<const FilterSpec>) const override;

 private:
  std::string name_;
  sim::WorldParameters world_;
  sim::RobotParameters robot_;
  sensors::ExtractorParameters extractor_;
  mapping::MapperParameters mapper_;
};

}  // namespace noctule::experiment
