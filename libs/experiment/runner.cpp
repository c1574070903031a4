#include "experiment/runner.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "core/error.hpp"
#include "experiment/parts.hpp"

namespace noctule::experiment {
namespace {

std::vector<FilterRun> run_piece(const Plan& plan, const Piece& piece) {
  const PlannedScenario& s = plan.scenarios[piece.scenario];
  const auto place = [&] { return "scenario '" + s.name + "', seed " + std::to_string(piece.seed) + ": "; };
  try {
    return s.scenario->run(piece.seed, s.filters);
  } catch (const InputError& e) {
    throw InputError(place() + e.what());
  } catch (const std::exception& e) {
    throw std::runtime_error(place() + e.what());
  }
}

/// "scenario 'heptagon': seeds 3, 4 and 12 more"
std::string seeds_text(const Plan& plan, std::span<const Piece> pieces) {
  constexpr std::size_t kShown = 10;
  std::string text;
  for (std::size_t i = 0; i < pieces.size() && i < kShown; ++i) {
    const bool first = i == 0 || pieces[i].scenario != pieces[i - 1].scenario;
    if (first) text += (i == 0 ? "scenario '" : "; scenario '") + plan.scenarios[pieces[i].scenario].name + "': seeds ";
    text += (first ? "" : ", ") + std::to_string(pieces[i].seed);
  }
  return text + (pieces.size() > kShown ? " and " + std::to_string(pieces.size() - kShown) + " more" : "");
}

}  // namespace

void run(const Plan& plan, const RunOptions& options, const std::function<bool(const Progress&)>& progress) {
  if (options.jobs < 1) throw InputError("jobs: expected an integer >= 1, got " + std::to_string(options.jobs));
  if (options.shard >= options.shards) {
    throw InputError("shard: expected i/n with 0 <= i < n, got " + std::to_string(options.shard) + '/' +
                     std::to_string(options.shards));
  }
  const ResultsFolder folder = ResultsFolder::claim(options.directory, plan.experiment);
  std::vector<Piece> todo;
  Progress state;
  for (std::size_t i = options.shard; i < plan.pieces.size(); i += options.shards) {
    ++state.total;
    if (folder.has(plan, plan.pieces[i])) {
      ++state.resumed;
    } else {
      todo.push_back(plan.pieces[i]);
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
        folder.write(plan, todo[i], run_piece(plan, todo[i]));
        const std::lock_guard lock(mutex);
        ++state.done;
        const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        state.seconds_left = elapsed / (state.done - state.resumed) * (state.total - state.done);
        if (!progress(state)) stop = true;
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        stop = true;
      }
    }
  };
  std::vector<std::thread> workers;
  for (int j = 1; j < options.jobs; ++j) workers.emplace_back(work);
  work();
  for (std::thread& worker : workers) worker.join();
  if (failure) std::rethrow_exception(failure);
  folder.write_tables(plan);
}

void merge(const Plan& plan, std::span<const std::filesystem::path> shards, const std::filesystem::path& directory) {
  std::vector<ResultsFolder> sources;
  for (const std::filesystem::path& shard : shards) sources.push_back(ResultsFolder::open(shard, plan.experiment));
  const auto holder_of = [&](const Piece& piece) {
    return std::find_if(sources.begin(), sources.end(), [&](const ResultsFolder& s) { return s.has(plan, piece); });
  };
  std::vector<Piece> missing;
  for (const Piece& piece : plan.pieces) {
    if (holder_of(piece) == sources.end()) missing.push_back(piece);
  }
  if (!missing.empty()) throw InputError("merge: no shard holds " + seeds_text(plan, missing));
  const ResultsFolder target = ResultsFolder::claim(directory, plan.experiment);
  for (const Piece& piece : plan.pieces) target.copy_from(*holder_of(piece), plan, piece);
  target.write_tables(plan);
}

}  // namespace noctule::experiment
