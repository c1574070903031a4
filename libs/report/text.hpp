#pragma once
/// Numbers and words as the report prints them: centimetres and degrees, independent of the locale.
#include <string>
#include <string_view>

namespace noctule::report {

/// Text for HTML and XML: markup characters escaped, control characters and bytes that are no UTF-8 replaced.
[[nodiscard]] std::string escape(std::string_view text);

/// `decimals` digits after the point; never "-0.00".
[[nodiscard]] std::string fixed(double value, int decimals);

/// `decimals` digits with a true minus sign, for columns and axes.
[[nodiscard]] std::string aligned(double value, int decimals = 2);

/// "10" with the exponent raised.
[[nodiscard]] std::string power_of_ten(int exponent);

/// About three significant digits with a true minus sign, as a power of ten from a million on; an em dash when not
/// finite.
[[nodiscard]] std::string printed(double value);
/// The same, "+" in front of positive numbers.
[[nodiscard]] std::string printed_signed(double value);

/// How an SI unit is printed.
struct PrintUnit {
  std::string symbol;
  double scale = 1.0;  ///< printed = SI * scale
};
/// Centimetres for "m" (metres where `largest` is 10 m or more), degrees for "rad", milli- or microseconds for "s"
/// below 1 s or 1 ms, nothing for "1", else the unit.
[[nodiscard]] PrintUnit print_unit(std::string_view unit_name, double largest = 0.0);

/// Value and unit, e.g. "1.62 cm"; whole numbers of unit "1" without decimals.
[[nodiscard]] std::string quantity(double value, std::string_view unit_name);

/// `x y` of a path in SVG.
[[nodiscard]] std::string point_text(double x, double y);
/// A text element of SVG; `text` is escaped. \param more attributes, with a space in front
[[nodiscard]] std::string text_at(const std::string& css_class, double x, double y, const std::string& text,
                                  const std::string& more = {});

/// Seconds as "42.0 s", "3 min 20 s" or "1 h 5 min".
[[nodiscard]] std::string printed_duration(double seconds);

}  // namespace noctule::report
