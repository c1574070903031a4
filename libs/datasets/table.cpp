#include "datasets/table.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "core/error.hpp"
#include "datasets/file_content.hpp"

namespace noctule::datasets {
namespace {

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r");
  return first == s.npos ? std::string_view{} : s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  const std::string_view ends = separator == ' ' ? std::string_view(" \t") : std::string_view(&separator, 1);
  for (std::string_view rest = trimmed(line); !rest.empty();) {
    const auto end = rest.find_first_of(ends);
    fields.push_back(trimmed(rest.substr(0, end)));
    if (end == rest.npos) return;
    rest = separator == ' ' ? trimmed(rest.substr(end)) : rest.substr(end + 1);
    if (rest.empty()) fields.emplace_back();  // a separator at the end of the line
  }
}

// The text of a field for a message: short and printable.
std::string quoted(std::string_view field) {
  std::string shown = "'";
  for (const char c : field.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (field.size() > 40 ? "...'" : "'");
}

// Shortest text that reads back as the same number.
std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

// A problem of a line, empty when it is sound; appends its numbers to `values`.
std::string parse(const std::vector<std::string_view>& fields, const TableFormat& format, std::vector<double>& values) {
  const std::size_t numbers = format.columns.size(), expected = numbers + static_cast<std::size_t>(format.text_columns);
  if (fields.size() != expected) {
    return "expected " + std::to_string(expected) + " columns, got " + std::to_string(fields.size());
  }
  for (std::size_t i = 0; i < numbers; ++i) {
    const std::string_view f = fields[i];
    double value = 0.0;
    const auto [end, code] = std::from_chars(f.data(), f.data() + f.size(), value);
    if (code != std::errc{} || end != f.data() + f.size() || !std::isfinite(value)) {
      return format.columns[i] + ": expected a finite number, got " + quoted(f);
    }
    values.push_back(value);
  }
  return {};
}

}  // namespace

Table::Table(const std::filesystem::path& path, const TableFormat& format)
    : path_(path.string()), columns_(format.columns) {
  const FileContent text = read_file(path);
  std::string_view rest = text.bytes;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);  // byte order mark
  std::vector<std::string_view> fields;
  if (format.unbroken) {
    read_unbroken(rest, format);
    rest = {};
  }
  bool header_seen = format.header.empty();
  for (int number = 1; !rest.empty(); ++number) {
    const auto end = rest.find('\n');
    const bool terminated = end != rest.npos;
    const std::string_view line = trimmed(rest.substr(0, end));
    rest = terminated ? rest.substr(end + 1) : std::string_view{};
    const std::string place = path_ + ":" + std::to_string(number) + ": ";
    if (!header_seen) {
      if (line != format.header) throw InputError(place + "expected '" + format.header + "', got " + quoted(line));
      header_seen = true;
      continue;
    }
    if (line.empty() || (format.comment != '\0' && line.front() == format.comment)) continue;

    const std::size_t before = values_.size();
    split(line, format.separator, fields);
    const std::string problem = parse(fields, format, values_);
    if (!problem.empty() && terminated) throw InputError(place + problem);
    if (!problem.empty() || (!terminated && text.cut_off)) {
      values_.resize(before);
      notes_.push_back(place + "the last record was cut off and is left out");
      continue;
    }
    if (!terminated) notes_.push_back(place + "the last line has no end; taken as whole");
    lines_.push_back(number);
  }
  if (lines_.empty()) throw InputError(path_ + ": expected at least one record, got none");
  if (text.cut_off) notes_.push_back(path_ + ": the compressed file is cut off; read up to the last whole record");
}

void Table::read_unbroken(std::string_view text, const TableFormat& format) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::vector<std::string_view> fields, record;
  for (auto begin = text.find_first_not_of(kBlanks); begin != text.npos;) {
    const auto end = std::min(text.find_first_of(kBlanks, begin), text.size());
    fields.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kBlanks, end);
  }
  const std::size_t size = columns_.size();
  for (std::size_t begin = 0; begin + size <= fields.size(); begin += size) {
    record.assign(fields.begin() + static_cast<std::ptrdiff_t>(begin),
                  fields.begin() + static_cast<std::ptrdiff_t>(begin + size));
    lines_.push_back(static_cast<int>(begin / size) + 1);
    const std::string problem = parse(record, format, values_);
    if (!problem.empty()) throw InputError(path_ + ": record " + std::to_string(lines_.back()) + ": " + problem);
  }
  if (fields.size() % size != 0) notes_.push_back(path_ + ": the last record was cut off and is left out");
}

std::int64_t Table::integer(int row, int column) const {
  const double value = (*this)(row, column);
  if (std::trunc(value) != value || std::abs(value) > 0x1p53) refuse(row, column, "an integer");
  return static_cast<std::int64_t>(value);
}

double Table::at_least(double min, int row, int column) const {
  const double value = (*this)(row, column);
  if (value < min) {
    refuse(row, column, "at least " + shortest(min));
  }
  return value;
}

std::int64_t Table::utime(int row, int column, double unit) const {
  const double microseconds = (*this)(row, column) * unit * 1e6;
  if (std::abs(microseconds) > 3e16) refuse(row, column, "a time within a thousand years");
  return std::llround(microseconds);
}

void Table::require_ascending(int column, bool equal_allowed) const {
  for (int row = 1; row < rows(); ++row) {
    const double previous = (*this)(row - 1, column), value = (*this)(row, column);
    if (value > previous || (equal_allowed && value == previous)) continue;
    refuse(row, column, std::string(equal_allowed ? "at least " : "more than ") + shortest(previous) + " as above");
  }
}

void Table::refuse(int row, int column, const std::string& expected) const {
  throw InputError(path_ + ":" + std::to_string(lines_[static_cast<std::size_t>(row)]) + ": " +
                   columns_[static_cast<std::size_t>(column)] + ": expected " + expected + ", got " +
                   shortest((*this)(row, column)));
}

}  // namespace noctule::datasets
