/// A simulated robot as a process; also draws its sensors.
#include <fstream>
#include <iostream>

#include "apps/common/interrupt.hpp"
#include "apps/common/source.hpp"
#include "core/error.hpp"
#include "modules/pipeline_file.hpp"
#include "sim/mounting_svg.hpp"

namespace {

using namespace noctule;

void write_drawing(const sim::RobotParameters& robot, const std::string& path) {
  const std::string svg = sim::mounting_svg(robot);
  if (path == "-") {
    std::cout << svg;
    return;
  }
  std::ofstream file(path, std::ios::binary);
  if (!(file << svg) || !file.flush()) throw InputError(path + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  std::string speed = "1", drawing;
  const apps::Program program{
      .name = "noctule-sim",
      .description = "A simulated robot in a simulated room or among landmarks.",
      .options = {
          {"--speed", &speed, "times real time; 0: as fast as possible (messages may get lost)"},
          {"--show-robot", &drawing, "write a drawing of the robot's sensors (SVG; - for the terminal) and end"}}};
  const apps::CommandLine line = apps::parse_command_line(argc, argv, program);
  return apps::run_guarded(program.name, [&] {
    const modules::PipelineParameters parameters = apps::load_pipeline(line);
    const auto* simulator = std::get_if<modules::SimulatorParameters>(&parameters.source);
    if (simulator == nullptr && !std::holds_alternative<sim::LandmarkWorldParameters>(parameters.source)) {
      throw InputError(line.file + ": source.type: expected simulator or landmark_world");
    }
    if (line.print_config) {
      std::cout << modules::dump_pipeline(parameters);
      return 0;
    }
    if (!drawing.empty()) {
      if (simulator == nullptr) throw InputError(line.file + ": source.type: --show-robot expects simulator");
      write_drawing(simulator->robot, drawing);
      return 0;
    }
    const double times_real_time = apps::parse_option("--speed", speed, 0.0);
    apps::catch_interrupts();
    const auto bus = apps::open_bus(line);
    const auto source = modules::make_source(*bus, parameters);
    apps::run_source(*bus, *source.module, times_real_time);
    return 0;
  });
}
