#include "apps/common/single_module.hpp"

#include <iostream>

#include "apps/common/interrupt.hpp"
#include "modules/pipeline_file.hpp"

namespace noctule::apps {
namespace {

constexpr std::chrono::milliseconds kPatience{100};  // between two looks at the keyboard

void run_until_finished(bus::Bus& bus, modules::Module& module) {
  while (!module.finished() && !interrupted()) bus.handle_for(kPatience);
  module.finish();
  bus.drain();
}

void print_counts(const bus::Bus& bus) {
  for (const bus::Reception& r : bus.receptions()) {
    std::cerr << r.channel << ": " << r.sequence.used << " used, " << r.sequence.missed << " missed, "
              << r.sequence.duplicates << " duplicates, " << r.sequence.late << " late, " << r.refused << " refused\n";
  }
}

}  // namespace

int run_single_module(int argc, char** argv, const Program& program, const ModuleFactory& make) {
  const CommandLine line = parse_command_line(argc, argv, program);
  return run_guarded(program.name, [&] {
    const modules::PipelineParameters parameters = load_pipeline(line);
    if (line.print_config) {
      std::cout << modules::dump_pipeline(parameters);
      return 0;
    }
    catch_interrupts();
    const auto bus = open_bus(line);
    const auto module = make(*bus, parameters, line);
    if (line.log_level >= LogLevel::info) std::cerr << program.name << ": listening on " << line.bus << std::endl;
    run_until_finished(*bus, *module);
    if (line.log_level >= LogLevel::info) print_counts(*bus);
    return 0;
  });
}

}  // namespace noctule::apps
