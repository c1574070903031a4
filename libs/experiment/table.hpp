#pragma once
/// Results as CSV, and their statistics.
#include <filesystem>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "core/chi2.hpp"
#include "experiment/row.hpp"

namespace noctule::experiment {

/// `scenario,filter,parameters,seed,metric,unit,value,diverged`; numbers round-trip, a value that could not be measured
/// is empty.
void write_rows(std::ostream&, std::span<const Row>);
/// \throws InputError naming file and line
[[nodiscard]] std::vector<Row> read_rows(const std::filesystem::path&);

/// Statistics of one metric of one filter over the seeds. Runs that diverged are in the mean wherever they have a
/// number: they are shown, never dropped.
struct SummaryRow {
  std::string scenario;
  std::string filter;
  std::string parameters;
  std::string metric;
  std::string unit;
  int n = 0;         ///< runs with a finite value
  int diverged = 0;  ///< runs that diverged
  double mean = 0.0;
  double sd = 0.0;
  Interval ci95{0.0, 0.0};  ///< of the mean, Student's t
};
/// In the order of first appearance.
[[nodiscard]] std::vector<SummaryRow> summarise(std::span<const Row>);
void write_summary(std::ostream&, std::span<const SummaryRow>);

}  // namespace noctule::experiment
