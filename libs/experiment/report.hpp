#pragma once
/// The report of a folder of results.
#include <filesystem>
#include <string>

#include "experiment/results.hpp"

namespace noctule::experiment {

/// One self-contained page. \param configuration text of the experiment, shown at its end
[[nodiscard]] std::string report_page(const Results&, const std::string& configuration);

/// All tables, for the package booktabs.
[[nodiscard]] std::string latex_tables(const Results&);

/// Writes report.html, tables.tex, comparisons.csv and figures/*.svg beside the results in `directory`.
/// \throws InputError naming what is missing or cannot be written
void write_report(const std::filesystem::path& directory);

}  // namespace noctule::experiment
