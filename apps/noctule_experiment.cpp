/// Monte-Carlo comparison of filters on the same random numbers.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <span>

#include "apps/common/command_line.hpp"
#include "apps/common/interrupt.hpp"
#include "config/config.hpp"
#include "core/error.hpp"
#include "experiment/runner.hpp"

namespace {

using namespace noctule;
namespace fs = std::filesystem;

constexpr int kExitInterrupted = 130;

/// Two whole numbers with a separator between them.
std::pair<std::uint64_t, std::uint64_t> parse_pair(const std::string& option, const std::string& text, char separator) {
  std::uint64_t first = 0, second = 0;
  const char* end = text.data() + text.size();
  const auto [middle, error] = std::from_chars(text.data(), end, first);
  if (error == std::errc() && middle != end && *middle == separator) {
    const auto [last, second_error] = std::from_chars(middle + 1, end, second);
    if (second_error == std::errc() && last == end) return {first, second};
  }
  throw InputError(option + ": expected two numbers as in 1" + separator + "4, got '" + text + "'");
}

experiment::Experiment load(const std::string& file, const std::string& seeds) {
  std::vector<std::string> assignments;
  if (!seeds.empty()) {
    const auto [first, last] = parse_pair("--seeds", seeds, '-');
    assignments = {"first_seed=" + std::to_string(first), "last_seed=" + std::to_string(last)};
  }
  return config::load<experiment::Experiment>(file, assignments);
}

int run(const std::string& file, const std::string& seeds, const std::string& shard, experiment::RunOptions options) {
  const experiment::Experiment experiment = load(file, seeds);
  std::string part = shard;
  if (const char* slurm = std::getenv("SLURM_ARRAY_TASK_ID"); part.empty() && slurm != nullptr) {
    const char* count = std::getenv("SLURM_ARRAY_TASK_COUNT");
    if (count == nullptr)
      throw InputError("SLURM_ARRAY_TASK_ID is set, SLURM_ARRAY_TASK_COUNT is not: give --shard i/n");
    part = std::string(slurm) + '/' + count;
  }
  if (!part.empty()) {
    const auto [i, n] = parse_pair("--shard", part, '/');
    options.shard = static_cast<int>(i);
    options.shards = static_cast<int>(n);
  }
  apps::catch_interrupts();
  const bool terminal = isatty(STDERR_FILENO) != 0;
  experiment::run(experiment, config::dump(experiment), options, [&](const experiment::Progress& p) {
    if (terminal) {
      std::fprintf(stderr, "\r%d of %d seeds, %.0f s left   ", p.done, p.total, p.seconds_left);
    } else if (p.done == p.total || p.done == p.resumed) {
      std::fprintf(stderr, "%d of %d seeds\n", p.done, p.total);
    }
    return !apps::interrupted();
  });
  if (terminal) std::fputc('\n', stderr);
  std::cout << (options.directory / "summary.csv").string() << "\n";
  return apps::interrupted() ? kExitInterrupted : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares filters on the same random numbers.", "noctule-experiment");
  app.set_version_flag("--version", "noctule-experiment " + apps::version());
  app.require_subcommand(1);
  std::string file, seeds, shard;
  experiment::RunOptions options{.directory = "results/experiment"};
  std::vector<fs::path> shards;

  CLI::App* run_command = app.add_subcommand("run", "run it, or go on with a run that was interrupted");
  run_command->add_option("FILE", file, "experiment (config/experiments/*.yaml)")->required();
  run_command->add_option("--seeds", seeds, "FIRST-LAST instead of the file's");
  run_command->add_option("--jobs", options.jobs, "seeds at the same time; no result depends on it")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  run_command->add_option("--shard", shard, "I/N: the I-th of N parts, from 0 (default: as Slurm's job array says)");
  run_command->add_option("--out", options.directory, "folder of results")->capture_default_str();

  CLI::App* merge_command = app.add_subcommand("merge", "join the folders of all shards");
  merge_command->add_option("FILE", file, "experiment (config/experiments/*.yaml)")->required();
  merge_command->add_option("SHARDS", shards, "folders that the shards wrote")->required();
  merge_command->add_option("--seeds", seeds, "FIRST-LAST as in the shards");
  merge_command->add_option("--out", options.directory, "folder of results")->capture_default_str();

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    std::cerr << "noctule-experiment: " << error.what() << " (see --help)\n";
    return 2;
  }
  return apps::run_guarded("noctule-experiment", [&] {
    if (run_command->parsed()) return run(file, seeds, shard, options);
    const experiment::Experiment experiment = load(file, seeds);
    experiment::merge(experiment, config::dump(experiment), shards, options.directory);
    std::cout << (options.directory / "summary.csv").string() << "\n";
    return 0;
  });
}
