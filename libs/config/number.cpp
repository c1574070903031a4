#include "config/number.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace noctule::config {
namespace {

constexpr int kDigitsOfDouble = std::numeric_limits<double>::max_digits10;         // 17
constexpr int kDigitsOfExtended = std::numeric_limits<long double>::max_digits10;  // 21

int significant_digits(std::string_view text) {
  const std::string_view mantissa = text.substr(0, text.find_first_of("eE"));
  const std::size_t first = mantissa.find_first_of("123456789");
  if (first == std::string_view::npos) return 0;
  return static_cast<int>(std::ranges::count_if(mantissa.substr(first), [](char c) { return c != '.'; }));
}

template <class Float>
std::optional<Float> parse_exactly(std::string_view text) {
  Float value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || stop != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

}  // namespace

std::optional<Number> parse_number(std::string_view text, double to_si) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const bool special = text.find_first_of("nN") != std::string_view::npos;  // .nan, -.inf
  std::string bare(text);
  if (special) std::erase(bare, '.');
  const std::optional<double> written = parse_exactly<double>(bare);
  if (!written) return std::nullopt;
  Number number{*written, *written * to_si};
  if (!special && significant_digits(bare) > kDigitsOfDouble) {
    if (const auto extended = parse_exactly<long double>(bare)) {
      number.si = static_cast<double>(*extended * static_cast<long double>(to_si));
    }
  }
  return number;
}

std::string print_number(double si, double to_si) {
  if (std::isnan(si)) return ".nan";
  if (std::isinf(si)) return si > 0 ? ".inf" : "-.inf";
  const double quotient = si / to_si;
  std::string best;
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double candidate : {quotient, std::nextafter(quotient, -kInf), std::nextafter(quotient, kInf)}) {
    if (!std::isfinite(candidate) || candidate * to_si != si) continue;
    const std::string text = shortest(candidate);
    if (best.empty() || text.size() < best.size()) best = text;
  }
  if (!best.empty()) return best;
  std::array<char, 64> buffer{};
  const long double extended = static_cast<long double>(si) / static_cast<long double>(to_si);
  // One digit before the point and the rest behind it: always more than a double's, hence read in extended precision.
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), extended,
                                          std::chars_format::scientific, kDigitsOfExtended - 1);
  return {buffer.data(), end};
}

}  // namespace noctule::config
