/// The contour mapper as a process.
#include <map>

#include "apps/common/single_module.hpp"
#include "core/error.hpp"
#include "modules/pipeline.hpp"
#include "modules/source_factory.hpp"

namespace {

using noctule::modules::PoseSource;

PoseSource parse_poses(const std::string& text) {
  static const std::map<std::string, PoseSource> kNames{
      {"slam", PoseSource::slam}, {"ground_truth", PoseSource::ground_truth}, {"odometry", PoseSource::odometry}};
  const auto name = kNames.find(text);
  if (name == kNames.end()) {
    throw noctule::InputError("--poses: expected slam, ground_truth or odometry, got '" + text + "'");
  }
  return name->second;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace noctule;
  std::string poses = "slam";
  const apps::Program program{
      .name = "noctule-mapper",
      .description = "Maps walls, cylinders and corners from ultrasonic scans and the poses they were taken at.",
      .options = {{"--poses", &poses, "whose poses: slam, ground_truth or odometry"}}};
  return apps::run_single_module(
      argc, argv, program,
      [&](bus::Bus& bus, const modules::PipelineParameters& parameters, const apps::CommandLine& line) {
        if (!parameters.mapping) throw InputError(line.file + ": expected a section 'mapping'");
        const KnownWorld world = modules::known_world(parameters.source);
        return modules::make_mapper(bus, parameters, world, parse_poses(poses));
      });
}
