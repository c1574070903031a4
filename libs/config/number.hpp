#pragma once
/// Numbers as text. What is written is read back to the same bits, through units too.
#include <optional>
#include <string>
#include <string_view>

namespace noctule::config {

/// A number of a file: as written (to be checked against its range) and in SI.
struct Number {
  double written = 0.0;
  double si = 0.0;
};

/// `text` as a decimal number times `to_si`; nothing when it is not one. "nan" and "inf", with or without the leading
/// dot of YAML, are read as such. Texts of more than 17 digits are multiplied in extended precision: not every double
/// in SI is a product of the unit and another double, and all must be writable.
[[nodiscard]] std::optional<Number> parse_number(std::string_view text, double to_si);

/// The shortest text that parse_number turns into `si` again.
[[nodiscard]] std::string print_number(double si, double to_si);

}  // namespace noctule::config
