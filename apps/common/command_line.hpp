#pragma once
/// The command line that all executables share.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "modules/pipeline_parameters.hpp"

namespace noctule::apps {

enum class LogLevel { error, warning, info };

/// What the user asked for, beside the executable's own options.
struct CommandLine {
  std::string file;                      ///< pipeline file
  std::vector<std::string> assignments;  ///< of --set
  std::optional<std::uint64_t> seed;
  int threads = 1;
  std::string bus;
  std::string mirror;
  LogLevel log_level = LogLevel::info;
  bool print_config = false;
};

/// An option of one executable: `--name TEXT`.
struct Option {
  std::string name;  ///< as CLI11 writes it: "--out", "-o,--out"
  std::string* value;
  std::string help;
};

struct Program {
  std::string name;
  std::string description;
  std::string default_bus = "udpm://";
  std::string file_help = "pipeline file (config/pipelines/*.yaml)";
  std::vector<Option> options = {};
};

/// Parses the arguments; prints help or version and ends the program where that was asked for, and with exit code 2 and
/// one line where they make no sense.
[[nodiscard]] CommandLine parse_command_line(int argc, char** argv, const Program& program);

/// The pipeline file with --set and --seed applied.
/// \throws InputError
[[nodiscard]] modules::PipelineParameters load_pipeline(const CommandLine& command_line);

/// The bus that was asked for, with its mirror; it reports problems on the terminal.
/// \throws InputError
[[nodiscard]] std::unique_ptr<bus::Bus> open_bus(const CommandLine& command_line);

/// As --version prints it.
[[nodiscard]] std::string version();

/// A number of the command line.
/// \throws InputError when the text is none, or below `min`
[[nodiscard]] double parse_option(const std::string& name, const std::string& text, double min);

/// Runs the program's body: prints what it throws as one line, and turns it into the exit code (2 bad input, 1 fault).
[[nodiscard]] int run_guarded(const std::string& program, const std::function<int()>& body);

}  // namespace noctule::apps
