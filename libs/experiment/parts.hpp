#pragma once
/// Results on disk while an experiment runs: one file per seed and scenario, there as a whole or not at all.
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "experiment/plan.hpp"
#include "experiment/table.hpp"

namespace noctule::experiment {

/// The results folder of one experiment.
class ResultsFolder {
 public:
  /// Creates the folder, or opens it where it holds the same experiment; what only reports look at (references, plots,
  /// roles) may differ and is brought up to date. \throws InputError when it holds another one or cannot be written
  static ResultsFolder claim(const std::filesystem::path& directory, const Experiment&);
  /// \throws InputError unless the folder holds this experiment
  static ResultsFolder open(const std::filesystem::path& directory, const Experiment&);

  [[nodiscard]] bool has(const Plan&, const Piece&) const;
  /// \param runs one per filter of the scenario
  void write(const Plan&, const Piece&, std::span<const FilterRun> runs) const;
  void copy_from(const ResultsFolder& other, const Plan&, const Piece&) const;
  /// Writes runs.csv, summary.csv, timing.csv and series.csv from the pieces that are there, in the order of the plan:
  /// the same bytes whatever the order in which they were made.
  void write_tables(const Plan&) const;

 private:
  explicit ResultsFolder(std::filesystem::path directory) : directory_(std::move(directory)) {}
  [[nodiscard]] std::filesystem::path part(const Plan&, const Piece&) const;

  std::filesystem::path directory_;
};

}  // namespace noctule::experiment
