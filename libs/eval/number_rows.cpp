#include "eval/number_rows.hpp"

#include <charconv>
#include <cmath>
#include <optional>

#include "core/error.hpp"

namespace noctule::eval {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  while (true) {
    const auto end = separator == ' ' ? line.find_first_of(kBlanks) : line.find(separator);
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = trimmed(line);
  }
}

std::optional<double> parse_finite(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

void refuse_row(const std::string& place, int line, const std::string& expected, const std::string& got) {
  throw InputError(place + ":" + std::to_string(line) + ": expected " + expected + ", got " + got);
}

std::vector<NumberRow> parse_rows(std::string_view text, const std::string& place,
                                  std::span<const std::string_view> columns, char separator) {
  std::vector<NumberRow> rows;
  bool first = true;
  for (int number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.starts_with('#')) continue;
    const auto fields = split(line, separator);
    const bool header = first && std::equal(fields.begin(), fields.end(), columns.begin(), columns.end());
    first = false;
    if (header) continue;
    if (fields.size() != columns.size()) {
      refuse_row(place, number, std::to_string(columns.size()) + " numbers", std::to_string(fields.size()));
    }
    NumberRow row{number, {}};
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto value = parse_finite(fields[i]);
      if (!value) {
        refuse_row(place, number, std::string(columns[i]) + " as a finite number", "'" + std::string(fields[i]) + "'");
      }
      row.values.push_back(*value);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace noctule::eval
