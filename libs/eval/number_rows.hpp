#pragma once
/// Text files of numbers: strict, and every complaint names its place.
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace noctule::eval {

/// The numbers of one line.
struct NumberRow {
  int line = 0;  ///< in the file, from 1
  std::vector<double> values;
};

/// Reads rows of finite numbers, one for each name in `columns`. Empty lines and lines that begin with # are passed
/// over, and so is a first line that holds the names themselves.
/// \param separator ' ' stands for any run of blanks and tabs
/// \param place of the text, for messages: a file name
/// \throws InputError `place:line: expected ..., got ...`
[[nodiscard]] std::vector<NumberRow> parse_rows(std::string_view text, const std::string& place,
                                                std::span<const std::string_view> columns, char separator);

/// Refuses something of a row. \throws InputError always
[[noreturn]] void refuse_row(const std::string& place, int line, const std::string& expected, const std::string& got);

}  // namespace noctule::eval
