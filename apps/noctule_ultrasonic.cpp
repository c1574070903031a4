/// The ultrasonic extractor as a process: ODOMETRY, ULTRASONIC_SCAN -> CONTOUR_FEATURES.
#include "apps/common/single_module.hpp"
#include "core/error.hpp"
#include "modules/ultrasonic_module.hpp"

int main(int argc, char** argv) {
  using namespace noctule;
  const apps::Program program{.name = "noctule-ultrasonic",
                              .description = "Finds walls, cylinders and corners in ultrasonic scans."};
  return apps::run_single_module(
      argc, argv, program,
      [](bus::Bus& bus, const modules::PipelineParameters& parameters, const apps::CommandLine& line) {
        if (!parameters.ultrasonic) throw InputError(line.file + ": expected a section 'ultrasonic'");
        return std::make_unique<modules::UltrasonicModule>(bus, *parameters.ultrasonic);
      });
}
