#include "report/text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "core/angles.hpp"

namespace noctule::report {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";  // U+FFFD
constexpr const char* kMinus = "\xE2\x88\x92";        // U+2212
constexpr const char* kDash = "\xE2\x80\x94";         // U+2014

/// Length of the UTF-8 sequence that starts at `i`, 0 where there is none.
std::size_t utf8_length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(i);
  std::size_t length = 0;
  if (first < 0x80) {
    length = 1;
  } else if (first >= 0xC2 && first < 0xE0) {
    length = 2;
  } else if (first >= 0xE0 && first < 0xF0) {
    length = 3;
  } else if (first >= 0xF0 && first < 0xF5) {
    length = 4;
  }
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = i + 1; k < i + length; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return 0;
  }
  return length;
}

int decimals_for(double magnitude) {
  if (magnitude >= 99.95) return 0;
  return magnitude >= 9.995 ? 1 : 2;
}

}  // namespace

std::string escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    const char c = text[i];
    if (length == 0 || (length == 1 && static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t')) {
      out += kReplacement;
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else {
      out += text.substr(i, length);
    }
    i += length == 0 ? 1 : length;
  }
  return out;
}

std::string fixed(double value, int decimals) {
  std::array<char, 400> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals);
  std::string result(text.data(), end);
  if (result.front() == '-' && result.find_first_not_of("-0.") == std::string::npos) result.erase(0, 1);
  return result;
}

std::string aligned(double value, int decimals) {
  std::string text = fixed(value, decimals);
  if (text.front() == '-') text.replace(0, 1, kMinus);
  return text;
}

std::string power_of_ten(int exponent) {
  // Raised 1, 2 and 3 are older than the others and stand elsewhere in Unicode.
  static constexpr std::array<const char*, 10> kRaised{"\xE2\x81\xB0", "\xC2\xB9",     "\xC2\xB2",     "\xC2\xB3",
                                                       "\xE2\x81\xB4", "\xE2\x81\xB5", "\xE2\x81\xB6", "\xE2\x81\xB7",
                                                       "\xE2\x81\xB8", "\xE2\x81\xB9"};
  std::string text = exponent < 0 ? "10\xE2\x81\xBB" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) text += kRaised[static_cast<std::size_t>(digit - '0')];
  return text;
}

std::string printed(double value) {
  if (!std::isfinite(value)) return kDash;
  constexpr double kLarge = 1e6;
  if (std::abs(value) >= kLarge) {
    const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
    return aligned(value / std::pow(10.0, exponent), 1) + "\xC3\x97" + power_of_ten(exponent);
  }
  return aligned(value, decimals_for(std::abs(value)));
}

std::string printed_signed(double value) {
  return value > 0.0 && std::isfinite(value) ? "+" + printed(value) : printed(value);
}

PrintUnit print_unit(std::string_view unit_name, double largest) {
  if (unit_name == "m") return std::abs(largest) >= 10.0 ? PrintUnit{"m", 1.0} : PrintUnit{"cm", 100.0};
  if (unit_name == "rad") return {"\xC2\xB0", degrees(1.0)};
  if (unit_name == "1") return {"", 1.0};
  if (unit_name == "s" && largest != 0.0 && std::abs(largest) < 1e-3) return {"\xC2\xB5s", 1e6};
  if (unit_name == "s" && largest != 0.0 && std::abs(largest) < 1.0) return {"ms", 1e3};
  return {std::string(unit_name), 1.0};
}

std::string quantity(double value, std::string_view unit_name) {
  if (!std::isfinite(value)) return kDash;
  if (unit_name == "1" && value == std::round(value)) return fixed(value, 0);
  const PrintUnit unit = print_unit(unit_name, value);
  const std::string space = unit.symbol.empty() || unit_name == "rad" ? "" : " ";
  return printed(value * unit.scale) + space + unit.symbol;
}

std::string printed_duration(double seconds) {
  if (!std::isfinite(seconds)) return kDash;
  if (seconds < 100.0) return printed(seconds) + " s";
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

std::string point_text(double x, double y) {
  return fixed(x, 1) + " " + fixed(y, 1);
}

std::string text_at(const std::string& css_class, double x, double y, const std::string& text,
                    const std::string& more) {
  return "<text class=\"" + css_class + "\" x=\"" + fixed(x, 1) + "\" y=\"" + fixed(y, 1) + "\"" + more + ">" +
         escape(text) + "</text>";
}

}  // namespace noctule::report
