#include "experiment/runner.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>

#include "core/error.hpp"
#include "experiment/table.hpp"

namespace noctule::experiment {
namespace {

namespace fs = std::filesystem;

/// One seed of one scenario, for all filters.
struct Piece {
  std::size_t scenario = 0;
  std::uint64_t seed = 0;
};

std::vector<Piece> pieces_of(const Experiment& experiment) {
  std::vector<Piece> pieces;
  for (std::size_t s = 0; s < experiment.scenarios.size(); ++s) {
    for (std::uint64_t seed = experiment.first_seed; seed <= experiment.last_seed; ++seed) pieces.push_back({s, seed});
  }
  return pieces;
}

fs::path part_file(const Experiment& experiment, const Piece& piece, const fs::path& directory, const char* kind) {
  return directory / "parts" /
         (experiment.scenarios[piece.scenario].name + '-' + std::to_string(piece.seed) + '.' + kind + ".csv");
}

/// A file is there with its whole content or not at all.
void write_atomically(const fs::path& file, const std::string& text) {
  const fs::path temporary = file.string() + ".new";
  {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    if (!out.flush()) throw InputError(temporary.string() + ": cannot be written");
  }
  fs::rename(temporary, file);
}

void append(std::vector<Row>& rows, Row row, std::span<const eval::Metric> metrics) {
  for (const eval::Metric& m : metrics) {
    row.metric = m.name;
    row.unit = m.unit;
    row.value = m.value;
    rows.push_back(row);
  }
}

std::string text_of(std::span<const Row> rows) {
  std::ostringstream out;
  write_rows(out, rows);
  return out.str();
}

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void claim_directory(const fs::path& directory, const std::string& fingerprint) {
  std::error_code error;
  fs::create_directories(directory / "parts", error);
  if (error) throw InputError(directory.string() + ": cannot be created (" + error.message() + ")");
  const fs::path file = directory / "experiment.yaml";
  if (!fs::exists(file)) {
    write_atomically(file, fingerprint);
  } else if (read_text(file) != fingerprint) {
    throw InputError(directory.string() + ": holds the results of another experiment (see experiment.yaml there); " +
                     "choose another folder or delete it");
  }
}

bool is_done(const Experiment& experiment, const Piece& piece, const fs::path& directory) {
  // The figures are written last.
  return fs::exists(part_file(experiment, piece, directory, "runs"));
}

/// In the order of filters, metrics of each filter in the order of their first appearance, then seeds: by scenario and
/// seed as the parts are read, which is the same for every number of jobs and shards.
void write_tables(const Experiment& experiment, const fs::path& directory) {
  std::vector<Row> figures, timings;
  for (const Piece& piece : pieces_of(experiment)) {
    for (const char* kind : {"runs", "timing"}) {
      const fs::path file = part_file(experiment, piece, directory, kind);
      if (!fs::exists(file)) continue;
      auto& all = std::string_view(kind) == "runs" ? figures : timings;
      const std::vector<Row> rows = read_rows(file);
      all.insert(all.end(), rows.begin(), rows.end());
    }
  }
  std::ostringstream summary;
  write_summary(summary, summarise(figures));
  std::ostringstream timing;
  write_summary(timing, summarise(timings));
  write_atomically(directory / "runs.csv", text_of(figures));
  write_atomically(directory / "summary.csv", summary.str());
  write_atomically(directory / "timing.csv", timing.str());
}

}  // namespace

void run(const Experiment& experiment, const std::string& fingerprint, const RunOptions& options,
         const std::function<bool(const Progress&)>& progress) {
  if (options.jobs < 1) throw InputError("jobs: expected an integer >= 1, got " + std::to_string(options.jobs));
  if (options.shards < 1 || options.shard < 0 || options.shard >= options.shards) {
    throw InputError("shard: expected i/n with 0 <= i < n, got " + std::to_string(options.shard) + '/' +
                     std::to_string(options.shards));
  }
  std::vector<std::unique_ptr<Scenario>> scenarios;
  const std::vector<FilterSpec> filters = expand(experiment.filters);
  for (const ScenarioSpec& spec : experiment.scenarios) {
    scenarios.push_back(make_scenario(spec));
    for (const FilterSpec& filter : filters) scenarios.back()->check(filter);
  }
  claim_directory(options.directory, fingerprint);

  std::vector<Piece> todo;
  Progress state;
  const std::vector<Piece> all = pieces_of(experiment);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (static_cast<int>(i % static_cast<std::size_t>(options.shards)) != options.shard) continue;
    ++state.total;
    if (is_done(experiment, all[i], options.directory)) {
      ++state.resumed;
    } else {
      todo.push_back(all[i]);
    }
  }
  state.done = state.resumed;

  const auto begin = std::chrono::steady_clock::now();
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{!progress(state)};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < todo.size() && !stop; i = next++) {
      try {
        const std::vector<FilterRun> runs = scenarios[todo[i].scenario]->run(todo[i].seed, filters);
        std::vector<Row> figures, timings;
        for (std::size_t f = 0; f < filters.size(); ++f) {
          const Row row{.scenario = experiment.scenarios[todo[i].scenario].name,
                        .filter = filters[f].name,
                        .parameters = filters[f].parameters,
                        .seed = todo[i].seed,
                        .metric = {},
                        .unit = {},
                        .diverged = runs[f].diverged};
          append(figures, row, runs[f].figures);
          append(timings, row, runs[f].timings);
        }
        write_atomically(part_file(experiment, todo[i], options.directory, "timing"), text_of(timings));
        write_atomically(part_file(experiment, todo[i], options.directory, "runs"), text_of(figures));
        const std::lock_guard lock(mutex);
        ++state.done;
        const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        state.seconds_left = elapsed / (state.done - state.resumed) * (state.total - state.done);
        if (!progress(state)) stop = true;
      } catch (...) {
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
        stop = true;
      }
    }
  };
  std::vector<std::thread> workers;
  for (int j = 1; j < options.jobs; ++j) workers.emplace_back(work);
  work();
  for (std::thread& worker : workers) worker.join();
  if (failure) std::rethrow_exception(failure);
  write_tables(experiment, options.directory);
}

void merge(const Experiment& experiment, const std::string& fingerprint, std::span<const fs::path> shards,
           const fs::path& directory) {
  for (const fs::path& shard : shards) {
    if (read_text(shard / "experiment.yaml") != fingerprint) {
      throw InputError(shard.string() + ": holds no results of this experiment (see experiment.yaml there)");
    }
  }
  claim_directory(directory, fingerprint);
  for (const Piece& piece : pieces_of(experiment)) {
    const auto holder = std::find_if(shards.begin(), shards.end(),
                                     [&](const fs::path& shard) { return is_done(experiment, piece, shard); });
    if (holder == shards.end()) {
      throw InputError("merge: no shard holds seed " + std::to_string(piece.seed) + " of scenario '" +
                       experiment.scenarios[piece.scenario].name + "'");
    }
    for (const char* kind : {"timing", "runs"}) {
      write_atomically(part_file(experiment, piece, directory, kind),
                       read_text(part_file(experiment, piece, *holder, kind)));
    }
  }
  write_tables(experiment, directory);
}

}  // namespace noctule::experiment
