#pragma once
/// The subcommands of noctule-experiment.
#include <filesystem>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace noctule::apps {

/// Which experiment, and what differs from its file.
struct ExperimentArguments {
  std::string file;
  std::string seeds;                     ///< "FIRST-LAST"; empty: the file's
  std::vector<std::string> assignments;  ///< of --set
};
/// \throws InputError
[[nodiscard]] experiment::Experiment load_experiment(const ExperimentArguments&);

/// Which part of the seeds is ours.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;
};
/// \param text "i/n"; empty: as the job array of Slurm says, else all. \throws InputError
[[nodiscard]] Shard parse_shard(const std::string& text);

/// Runs it, or goes on with it. \return the exit code
[[nodiscard]] int run_experiment(const ExperimentArguments&, const std::filesystem::path& out, int jobs,
                                 const std::string& shard);
void merge_shards(const ExperimentArguments&, const std::vector<std::filesystem::path>& shards,
                  const std::filesystem::path& out);
/// Prints what would run, and what of it is done in `out`.
void list_experiment(const ExperimentArguments&, const std::filesystem::path& out);

/// Writes report.html and what belongs to it.
void report_experiment(const std::filesystem::path& directory);

/// `FOLDER`, `FILTER`, `FILTER:PARAMETERS` or `FOLDER:FILTER:PARAMETERS`, without a folder in `folder`. Prints the
/// paired differences. \param csv file to write them to; may be empty
void compare_results(const std::string& a, const std::string& b, const std::filesystem::path& folder,
                     const std::filesystem::path& csv);

/// Makes the tables and figures of pages anew from the results beside them. \param check change nothing
/// \return the exit code: 1 where `check` finds a page that would change or a figure that is in no results
[[nodiscard]] int refresh_pages(const std::vector<std::filesystem::path>& pages, bool check);

}  // namespace noctule::apps
