#pragma once
/// Runs an experiment: parallel over seeds, resumable, in shards; the rows are the same bytes whatever the order.
#include <filesystem>
#include <functional>
#include <string>

#include "experiment/experiment.hpp"

namespace noctule::experiment {

struct RunOptions {
  std::filesystem::path directory;
  int jobs = 1;
  int shard = 0;   ///< which part of the seeds, from 0
  int shards = 1;  ///< of how many
};

struct Progress {
  int done = 0;     ///< pieces (one seed of one scenario), those of an earlier, interrupted run included
  int resumed = 0;  ///< of these, found on disk at the start
  int total = 0;
  double seconds_left = 0.0;  ///< estimate
};

/// Runs what is not yet in `directory`/parts (one file per seed and scenario, written atomically), then writes
/// runs.csv, summary.csv and timing.csv from the parts in the order of the experiment file. \param fingerprint text of
/// the effective experiment; a directory that holds another one is refused \param progress called after each piece,
/// never at once from two threads; returning false stops the run \throws InputError
void run(const Experiment&, const std::string& fingerprint, const RunOptions&,
         const std::function<bool(const Progress&)>& progress);

/// Joins the parts of shards into `directory`, as if one run had made them.
/// \throws InputError when a shard belongs to another experiment or pieces are missing
void merge(const Experiment&, const std::string& fingerprint, std::span<const std::filesystem::path> shards,
           const std::filesystem::path& directory);

}  // namespace noctule::experiment
