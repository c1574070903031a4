#include "apps/common/command_line.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "config/number.hpp"
#include "core/error.hpp"
#include "modules/pipeline_file.hpp"

namespace noctule::apps {
namespace {

constexpr int kExitFault = 1;
constexpr int kExitBadInput = 2;

LogLevel parse_log_level(const std::string& text) {
  static const std::map<std::string, LogLevel> kLevels{
      {"error", LogLevel::error}, {"warning", LogLevel::warning}, {"info", LogLevel::info}};
  const auto level = kLevels.find(text);
  if (level == kLevels.end()) {
    throw CLI::ValidationError("--log-level: expected error, warning or info, got '" + text + "'");
  }
  return level->second;
}

void add_shared_options(CLI::App& app, CommandLine& line, const std::string& file_help) {
  app.add_option("FILE,--config", line.file, file_help);
  app.add_option("--set", line.assignments, "override a value: key.path=value; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  app.add_option("--seed", line.seed, "seed of all random numbers (instead of the file's)");
  app.add_option("--threads", line.threads, "most threads, 1 to 1024; no result depends on it")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--bus", line.bus, "memq:// or udpm://GROUP:PORT?ttl=N; ttl=0 stays on this host")
      ->capture_default_str();
  app.add_option("--mirror", line.mirror, "publish everything on this second udpm bus too");
  app.add_flag("--print-config", line.print_config, "print the effective configuration and end");
}

}  // namespace

std::string version() {
  return NOCTULE_VERSION;
}

CommandLine parse_command_line(int argc, char** argv, const Program& program) {
  CommandLine line;
  line.bus = program.default_bus;
  std::string level = "info";
  bool print_keys = false;
  CLI::App app(program.description, program.name);
  app.set_version_flag("--version", program.name + " " + version());
  add_shared_options(app, line, program.file_help);
  app.add_option("--log-level", level, "error, warning or info")->capture_default_str();
  app.add_flag("--keys", print_keys, "print all keys of a pipeline file as a Markdown table and end");
  for (const Option& o : program.options) app.add_option(o.name, *o.value, o.help)->capture_default_str();
  try {
    app.parse(argc, argv);
    if (print_keys) {
      std::cout << modules::pipeline_reference();
      std::exit(0);
    }
    if (line.file.empty()) throw CLI::RequiredError("FILE");
    line.log_level = parse_log_level(level);
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
