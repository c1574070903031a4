/// A data set or a log as a process.
#include <iostream>

#include "apps/common/interrupt.hpp"
#include "apps/common/source.hpp"
#include "modules/pipeline_file.hpp"

namespace {

using namespace noctule;

/// A file that is no YAML is a log to be played as it is.
modules::PipelineParameters parameters_of(const apps::CommandLine& line) {
  const bool yaml = line.file.ends_with(".yaml") || line.file.ends_with(".yml");
  if (yaml) return apps::load_pipeline(line);
  modules::PipelineParameters parameters;
  parameters.name = line.file;
  parameters.source = modules::LogParameters{.path = line.file, .world = {}};
  return parameters;
}

}  // namespace

int main(int argc, char** argv) {
  std::string speed = "1";
  const apps::Program program{
      .name = "noctule-player",
      .description = "Plays the observations of a data set or of an LCM log.",
      .file_help = "pipeline file (*.yaml), or an LCM log",
      .options = {{"--speed", &speed, "times real time; 0: as fast as possible (messages may get lost)"}}};
  const apps::CommandLine line = apps::parse_command_line(argc, argv, program);
  return apps::run_guarded(program.name, [&] {
    const modules::PipelineParameters parameters = parameters_of(line);
    if (line.print_config) {
      std::cout << modules::dump_pipeline(parameters);
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
