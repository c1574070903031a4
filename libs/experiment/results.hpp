#pragma once
/// A folder of results, read back, and what is compared in it.
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "experiment/comparison.hpp"
#include "experiment/experiment.hpp"
#include "experiment/table.hpp"

namespace noctule::experiment {

struct Results {
  Experiment experiment;
  std::vector<Row> runs;
  std::vector<SummaryRow> summary;
  std::vector<SummaryRow> timing;
  std::vector<SeriesRow> series;
};
/// \throws InputError naming what is missing or broken
[[nodiscard]] Results load_results(const std::filesystem::path& directory);

/// `key=value;key=value` taken apart.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> assignments(const std::string& parameters);

/// Which rows: all, those of a filter, or those of a filter with certain parameters.
struct Selection {
  std::string filter;                     ///< empty: any
  std::optional<std::string> parameters;  ///< as in the tables; none: any
};

/// One comparison for each scenario, metric and pair of filters: filters with equal parameters, or the only one on each
/// side. Where one side names no filter, it is the other's; where none does, every filter is compared with its
/// namesake. \throws InputError naming the filters that are there when nothing can be paired
[[nodiscard]] std::vector<Comparison> compare(std::span<const Row> a, const Selection& of_a, std::span<const Row> b,
                                              const Selection& of_b);

/// What a report of one folder compares: every filter (lines to see them by apart) with the first one that is compared,
/// at equal parameters where it has them (a filter's further parameters do not count); corrected within each scenario.
[[nodiscard]] std::vector<Comparison> standard_comparisons(const Results&);

/// \throws std::out_of_range when the experiment has no such filter
[[nodiscard]] Role role_of(const Experiment&, const std::string& filter);

}  // namespace noctule::experiment
