#pragma once
/// Tables of this room as CSV: no quotes, because no name in them holds a comma.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace noctule::experiment {

/// A file with a fixed header, read whole. Lines count from 1, the header being the first.
class CsvTable {
 public:
  /// \throws InputError when the file cannot be read, has another header or a line of another number of cells
  CsvTable(const std::filesystem::path& file, std::string_view header);

  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  [[nodiscard]] const std::string& text(std::size_t line, std::size_t column) const { return lines_[line][column]; }
  /// NaN for an empty cell. \throws InputError naming file and line when it is no number
  [[nodiscard]] double number(std::size_t line, std::size_t column) const;
  /// Several with spaces in between.
  [[nodiscard]] std::vector<double> numbers(std::size_t line, std::size_t column) const;
  /// \throws InputError naming file and line when it is no whole number >= 0
  [[nodiscard]] std::uint64_t count(std::size_t line, std::size_t column) const;

 private:
  [[nodiscard]] double to_number(std::size_t line, const std::string& text) const;
  [[noreturn]] void refuse(std::size_t line, const std::string& expected) const;

  std::string file_;
  std::string header_;
  std::vector<std::vector<std::string>> lines_;
};

/// The shortest text that reads back the same; nothing for what is not finite.
[[nodiscard]] std::string csv_number(double value);

[[nodiscard]] std::vector<std::string> split(std::string_view text, char separator);

}  // namespace noctule::experiment
