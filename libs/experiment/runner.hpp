#pragma once
/// Runs an experiment: parallel over seeds, resumable, in shards; the rows are the same bytes whatever the order.
#include <filesystem>
#include <functional>
#include <span>

#include "experiment/plan.hpp"

namespace noctule::experiment {

struct RunOptions {
  std::filesystem::path directory;
  int jobs = 1;
  std::size_t shard = 0;   ///< which part of the seeds, from 0
  std::size_t shards = 1;  ///< of how many
};

struct Progress {
  int done = 0;     ///< pieces (one seed of one scenario), those of an earlier, interrupted run included
  int resumed = 0;  ///< of these, found on disk at the start
  int total = 0;
  double seconds_left = 0.0;  ///< estimate
};

/// Runs what is not yet in `directory`, then writes its tables (experiment/parts.hpp).
/// \param progress called before the first and after each piece, never at once from two threads; returning false stops
/// the run \throws InputError, also when the directory holds another experiment; what a scenario throws comes with
/// scenario and seed
void run(const Plan&, const RunOptions&, const std::function<bool(const Progress&)>& progress);

/// Joins what shards wrote into `directory`, as if one run had made it.
/// \throws InputError when a shard belongs to another experiment or pieces are missing
void merge(const Plan&, std::span<const std::filesystem::path> shards, const std::filesystem::path& directory);

}  // namespace noctule::experiment
