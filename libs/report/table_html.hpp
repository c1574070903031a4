#pragma once
/// Pieces of HTML tables. `text` arguments are markup: escape what comes from outside.
#include <string>
#include <vector>

namespace noctule::report {

/// A table in a frame that scrolls sideways on narrow screens; `head` is the content of thead.
[[nodiscard]] std::string table(const std::string& caption, const std::string& head, const std::string& body,
                                const std::string& css_class = {});
[[nodiscard]] std::string cell(const std::string& text, const std::string& css_class = {}, int columns = 1);
[[nodiscard]] std::string row_head(const std::string& text, int rows = 1);
[[nodiscard]] std::string column_head(const std::string& text, const std::string& css_class = {}, int columns = 1,
                                      int rows = 1);
/// A row of column heads.
[[nodiscard]] std::string head_row(const std::vector<std::string>& texts);
[[nodiscard]] std::string row(const std::string& cells, const std::string& css_class = {});
/// A value with its error in small below it.
[[nodiscard]] std::string value_with_error(double value, double error);

}  // namespace noctule::report
