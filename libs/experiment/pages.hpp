#pragma once
/// Markdown pages whose figures come from results that are checked in beside them.
///
/// ```
/// <!-- data {results: heptagon, experiment: ../../config/experiments/heptagon.yaml, scenario: heptagon} -->
///
/// <!-- table
/// columns:
///   - {title: "PF-SLAM, N = 100", filter: pf, parameters: "N=100"}
///   - {title: PF-SLAM in the paper, source: table 3, filter: PF-SLAM}
/// rows:
///   - {title: "walls, \\|d rho\\| [cm]", metric: wall_mae_rho, unit: cm, decimals: 2}
/// -->
/// | ... the table, made from what stands above ... |
/// <!-- /table -->
///
/// ... is <!-- figure {filter: pf, parameters: "N=100", metric: wall_mae_rho, unit: cm, decimals: 2} -->1.21
/// [1.10, 1.32]<!-- /figure --> cm ...
/// ```
/// `data` holds for all that follows. A cell is what its row says, else its column, else `data` (pages.cpp lists the
/// keys); their parameters together, so that rows may say `N=20` and a column `mode=a`. With a `source` it is a
/// published figure of the experiment file, else one of summary.csv, timing.csv or, for a difference, comparisons.csv
/// in the folder `results`.
#include <filesystem>
#include <string>
#include <vector>

namespace noctule::experiment {

/// The page with all its tables and figures made anew. \param file its place: paths in it are relative to that
/// \throws InputError naming the line of a block that makes no sense or asks for what is not in the results
[[nodiscard]] std::string refreshed_page(const std::string& text, const std::filesystem::path& file);

/// Lines of a page with `data` in which a decimal number with a unit (or a percentage other than 95 %) stands in the
/// open, outside of generated text and code, and does not occur in the generated text either.
[[nodiscard]] std::vector<std::string> unsupported_figures(const std::string& text);

}  // namespace noctule::experiment
