#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "apps/common/interrupt.hpp"
#include "apps/experiment/commands.hpp"
#include "config/config.hpp"
#include "core/error.hpp"
#include "experiment/parts.hpp"
#include "experiment/runner.hpp"
#include "report/text.hpp"

namespace noctule::apps {
namespace {

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

/// \throws InputError unless the variable holds a whole number
std::size_t slurm_number(const char* name) {
  const char* text = std::getenv(name);
  std::size_t value = 0;
  const std::string_view digits = text == nullptr ? "" : text;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    throw InputError(std::string(name) + ": expected a whole number beside SLURM_ARRAY_TASK_ID, got '" +
                     std::string(digits) + "'; or give --shard i/n");
  }
  return value;
}

/// A line that is written over on a terminal, and now and then a line in a log.
class ProgressLine {
 public:
  void show(const experiment::Progress& p) {
    const int tenth = p.total == 0 ? kTenths : kTenths * p.done / p.total;
    const bool known = p.done > p.resumed && p.done < p.total;
    const std::string left = known ? ", " + report::printed_duration(p.seconds_left) + " left" : "";
    if (terminal_) {
      std::fprintf(stderr, "\r\x1b[K%d of %d seeds%s", p.done, p.total, left.c_str());
    } else if (tenth != last_tenth_) {
      std::fprintf(stderr, "%d of %d seeds%s\n", p.done, p.total, left.c_str());
    }
    last_tenth_ = tenth;
  }
  void finish() const {
    if (terminal_) std::fputc('\n', stderr);
  }

 private:
  static constexpr int kTenths = 10;
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  int last_tenth_ = -1;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

experiment::Experiment load_experiment(const ExperimentArguments& arguments) {
  std::vector<std::string> assignments = arguments.assignments;
  if (!arguments.seeds.empty()) {
    const auto [first, last] = parse_pair("--seeds", arguments.seeds, '-');
    if (last < first) throw InputError("--seeds: expected the smaller number first, got '" + arguments.seeds + "'");
    assignments.push_back("first_seed=" + std::to_string(first));
    assignments.push_back("last_seed=" + std::to_string(last));
  }
  return config::load<experiment::Experiment>(arguments.file, assignments);
}

Shard parse_shard(const std::string& text) {
  if (!text.empty()) {
    const auto [i, n] = parse_pair("--shard", text, '/');
    return {i, n};
  }
  if (std::getenv("SLURM_ARRAY_TASK_ID") == nullptr) return {};
  const std::size_t id = slurm_number("SLURM_ARRAY_TASK_ID"), count = slurm_number("SLURM_ARRAY_TASK_COUNT");
  const std::size_t first = slurm_number("SLURM_ARRAY_TASK_MIN"), last = slurm_number("SLURM_ARRAY_TASK_MAX");
  if (last - first + 1 != count) {
    throw InputError("Slurm's job array has gaps (" + std::to_string(count) + " tasks from " + std::to_string(first) +
                     " to " + std::to_string(last) + "): give --shard i/n");
  }
  return {id - first, count};
}

int run_experiment(const ExperimentArguments& arguments, const fs::path& out, int jobs, const std::string& shard_text) {
  const Shard shard = parse_shard(shard_text);
  const experiment::Plan plan = experiment::make_plan(load_experiment(arguments));
  catch_interrupts();
  ProgressLine line;
  experiment::run(plan, {out, jobs, shard.index, shard.count}, [&](const experiment::Progress& p) {
    line.show(p);
    return !interrupted();
  });
  line.finish();
  if (interrupted()) {
    std::cerr << "interrupted; the same command goes on from here\n";
    return kExitInterrupted;
  }
  std::cout << (out / "summary.csv").string() << "\n";
  return 0;
}

void merge_shards(const ExperimentArguments& arguments, const std::vector<fs::path>& shards, const fs::path& out) {
  experiment::merge(experiment::make_plan(load_experiment(arguments)), shards, out);
  std::cout << (out / "summary.csv").string() << "\n";
}

void list_experiment(const ExperimentArguments& arguments, const fs::path& out) {
  const experiment::Plan plan = experiment::make_plan(load_experiment(arguments));
  const experiment::Experiment& e = plan.experiment;
  std::cout << e.name << ": seeds " << e.first_seed << " to " << e.last_seed << ", " << plan.runs() << " runs\n";
  for (const experiment::PlannedScenario& s : plan.scenarios) {
    std::cout << "scenario " << s.name << "\n";
    for (const experiment::FilterSpec& f : s.filters) {
      std::cout << "  filter " << f.name << (f.parameters.empty() ? "" : " " + f.parameters)
                << (f.role == experiment::Role::baseline ? " (baseline)" : "")
                << (f.role == experiment::Role::limit ? " (limit)" : "") << "\n";
    }
    std::cout << "  metrics " << joined(s.metrics) << "\n";
  }
  if (out.empty()) return;
  if (!fs::exists(out / "experiment.yaml")) {
    std::cout << out.string() << ": nothing done yet\n";
    return;
  }
  const auto folder = experiment::ResultsFolder::open(out, e);
  const auto done =
      std::ranges::count_if(plan.pieces, [&](const experiment::Piece& piece) { return folder.has(plan, piece); });
  std::cout << out.string() << ": " << done << " of " << plan.pieces.size() << " seeds done\n";
}

}  // namespace noctule::apps
