#include "apps/common/command_line.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "config/number.hpp"
#include "core/error.hpp"
#include "modules/pipeline_file.hpp"

namespace noctule::apps {
namespace {

constexpr int kExitFault = 1;
constexpr int kExitBadInput = 2;

}  // namespace

std::string version() {
  return NOCTULE_VERSION;
}

CommandLine parse_command_line(int argc, char** argv, const Program& program) {
  CommandLine line;
  line.bus = program.default_bus;
  CLI::App app(program.description, program.name);
  app.set_version_flag("--version", program.name + " " + version());
  app.add_option("FILE,--config", line.file, program.file_help)->required();
  app.add_option("--set", line.assignments, "override a value: key.path=value; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  app.add_option("--seed", line.seed, "seed of all random numbers (instead of the file's)");
  app.add_option("--threads", line.threads, "most threads; no result depends on it")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--bus", line.bus, "memq:// or udpm://GROUP:PORT?ttl=N; ttl=0 stays on this host")
      ->capture_default_str();
  app.add_option("--mirror", line.mirror, "publish everything on this second udpm bus too");
  const std::map<std::string, LogLevel> levels{
      {"error", LogLevel::error}, {"warning", LogLevel::warning}, {"info", LogLevel::info}};
  app.add_option("--log-level", line.log_level, "error, warning or info")
      ->transform(CLI::CheckedTransformer(levels))
      ->default_str("info");
  app.add_flag("--print-config", line.print_config, "print the effective configuration and end");
  for (const Option& option : program.options)
    app.add_option(option.name, *option.value, option.help)->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) std::exit(app.exit(error));  // help, version
    std::cerr << program.name << ": " << error.what() << " (see --help)\n";
    std::exit(kExitBadInput);
  }
  return line;
}

modules::PipelineParameters load_pipeline(const CommandLine& line) {
  std::vector<std::string> assignments = line.assignments;
  if (line.seed) assignments.push_back("seed=" + std::to_string(*line.seed));
  return modules::load_pipeline(line.file, assignments);
}

std::unique_ptr<bus::Bus> open_bus(const CommandLine& line) {
  auto bus = std::make_unique<bus::Bus>(line.bus);
  if (!line.mirror.empty()) bus->mirror_to(line.mirror);
  if (line.log_level >= LogLevel::warning) {
    bus->on_problem([](const std::string& channel, const std::string& text) {
      std::cerr << "warning: " << channel << ": " << text << "\n";
    });
  }
  return bus;
}

double parse_option(const std::string& name, const std::string& text, double min) {
  const auto number = config::parse_number(text, 1.0);
  if (!number || !(number->si >= min)) {
    throw InputError(name + ": expected a number >= " + config::print_number(min, 1.0) + ", got '" + text + "'");
  }
  return number->si;
}

int run_guarded(const std::string& program, const std::function<int()>& body) {
  try {
    return body();
  } catch (const InputError& error) {
    std::cerr << program << ": " << error.what() << "\n";
    return kExitBadInput;
  } catch (const std::exception& error) {
    std::cerr << program << ": internal error: " << error.what() << "\n";
    return kExitFault;
  }
}

}  // namespace noctule::apps
