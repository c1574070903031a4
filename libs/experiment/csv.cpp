#include "experiment/csv.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/error.hpp"
#include "eval/number_text.hpp"

namespace noctule::experiment {
namespace {

template <class T>
bool parse(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

std::string joined(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) line += (i == 0 ? "" : ",") + cells[i];
  return line;
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file, std::string_view header) : file_(file.string()), header_(header) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) throw InputError(file_ + ": cannot be read");
  if (line != header) throw InputError(file_ + ":1: expected the header " + header_ + ", got '" + line + "'");
  const std::size_t columns = split(header, ',').size();
  while (std::getline(in, line)) {
    lines_.push_back(split(line, ','));
    if (lines_.back().size() != columns) refuse(lines_.size() - 1, std::to_string(columns) + " cells");
  }
}

double CsvTable::number(std::size_t line, std::size_t column) const {
  return to_number(line, lines_[line][column]);
}

std::vector<double> CsvTable::numbers(std::size_t line, std::size_t column) const {
  std::vector<double> values;
  for (const std::string& text : split(lines_[line][column], ' ')) values.push_back(to_number(line, text));
  return values;
}

double CsvTable::to_number(std::size_t line, const std::string& text) const {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (!text.empty() && !parse(text, value)) refuse(line, "a number or nothing, not '" + text + "',");
  return value;
}

std::uint64_t CsvTable::count(std::size_t line, std::size_t column) const {
  std::uint64_t value = 0;
  if (!parse(lines_[line][column], value)) refuse(line, "a whole number, not '" + lines_[line][column] + "',");
  return value;
}

void CsvTable::refuse(std::size_t line, const std::string& expected) const {
  throw InputError(file_ + ":" + std::to_string(line + 2) + ": expected " + expected + " as in " + header_ + ", got '" +
                   joined(lines_[line]) + "'");
}

std::string csv_number(double value) {
  return std::isfinite(value) ? eval::shortest(value) : std::string();
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.emplace_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

}  // namespace noctule::experiment
