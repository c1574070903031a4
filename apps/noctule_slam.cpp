/// The SLAM filter as a process.
#include "apps/common/single_module.hpp"
#include "core/error.hpp"
#include "modules/pipeline.hpp"
#include "modules/source_factory.hpp"

int main(int argc, char** argv) {
  using namespace noctule;
  const apps::Program program{.name = "noctule-slam",
                              .description =
                                  "Estimates the robot's path and a map of landmarks from odometry, "
                                  "ultrasonic scans with contour features, and sightings of landmarks."};
  return apps::run_single_module(
      argc, argv, program,
      [](bus::Bus& bus, const modules::PipelineParameters& parameters, const apps::CommandLine& line) {
        if (!parameters.slam) throw InputError(line.file + ": expected a section 'slam'");
        const KnownWorld world = modules::known_world(parameters.source);
        return modules::make_slam(bus, parameters, world, modules::Threads{line.threads});
      });
}
