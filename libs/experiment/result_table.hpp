#pragma once
/// The tables of a report, independent of how they are written down.
#include <string>
#include <vector>

#include "experiment/results.hpp"
#include "report/text.hpp"

namespace noctule::experiment {

struct TableCell {
  std::string value;
  std::string detail;     ///< interval or remark, set smaller
  std::string css_class;  ///< "limit", "odometry", "paper" or nothing
};

struct TableColumn {
  std::string title;
  std::string detail;
  std::string css_class;
};

struct TableRow {
  std::string title;
  std::vector<TableCell> cells;
};

struct ResultTable {
  std::string caption;
  std::string corner;  ///< head of the first column
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
};

/// Means with their intervals and the runs that diverged, beside the published figures. With few filters one table,
/// a metric a row; else one table a metric, in the layout of papers: a parameter set a row, a filter a column.
[[nodiscard]] std::vector<ResultTable> result_tables(const Results&, const std::string& scenario);

/// Paired differences of one scenario.
[[nodiscard]] ResultTable comparison_table(std::span<const Comparison>, const std::string& scenario);

[[nodiscard]] std::string to_html(const ResultTable&);
/// For the package booktabs.
[[nodiscard]] std::string to_latex(const ResultTable&, const std::string& label);

/// `position_rmse` in words, "Position RMSE".
[[nodiscard]] std::string in_words(const std::string& metric);

/// Centimetres below a metre, degrees, the unit of time that fits.
[[nodiscard]] report::PrintUnit printed_unit(const std::string& si, double largest);

/// Decimals that show two digits of an interval's half width (of the value where there is none).
[[nodiscard]] int decimals_for(double half_width, double value);

}  // namespace noctule::experiment
