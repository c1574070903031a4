#pragma once
/// Results as CSV, and their statistics.
#include <compare>
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

/// Whose figures: one line of a table.
struct Subject {
  std::string scenario;
  std::string filter;
  std::string parameters;
  friend auto operator<=>(const Subject&, const Subject&) = default;
};

/// Statistics of one metric of one filter over the seeds. Runs that diverged are in the mean wherever they have a
/// number: they are shown, never dropped.
struct SummaryRow {
  Subject subject;
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
/// `scenario,filter,parameters,metric,unit,n,diverged,mean,sd,ci95_low,ci95_high`
void write_summary(std::ostream&, std::span<const SummaryRow>);
/// \throws InputError naming file and line
[[nodiscard]] std::vector<SummaryRow> read_summary(const std::filesystem::path&);

/// Mean of a metric over the seeds at one time.
struct SeriesRow {
  Subject subject;
  std::string metric;
  std::string unit;
  double time = 0.0;  ///< [s]
  double mean = 0.0;
  Interval ci95{0.0, 0.0};
};

/// A curve of one seed.
struct SeriesOfRun {
  Subject subject;
  Series series;
};
/// Over the seeds at each time; a seed without a number then is left out there.
/// \throws InputError when seeds disagree about the times
[[nodiscard]] std::vector<SeriesRow> summarise(std::span<const SeriesOfRun>);
/// `scenario,filter,parameters,metric,unit,time,mean,ci95_low,ci95_high`
void write_series(std::ostream&, std::span<const SeriesRow>);
/// \throws InputError naming file and line
[[nodiscard]] std::vector<SeriesRow> read_series(const std::filesystem::path&);

}  // namespace noctule::experiment
