#pragma once
/// Strict reading of recordings that are tables of numbers: one record a line, a fixed number of columns.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace noctule::datasets {

/// How a table is written.
struct TableFormat {
  std::vector<std::string> columns{};  ///< names of the numeric columns, for messages; their number is required
  char separator = ' ';                ///< ' ' stands for any run of blanks and tabs
  std::string header{};                ///< when not empty, what the first line must be
  char comment = '\0';                 ///< lines that begin with it are passed over; '\0': none
  bool unbroken = false;  ///< numbers between blanks and line ends of any kind, each record as many as columns
  int text_columns = 0;   ///< further columns at the end of each line that are not read
};

/// A table of finite numbers that remembers where each came from.
class Table {
 public:
  /// Reads a file, gzip'ed or plain. A last line that was cut off, and the rest of a gzip file that was, are left out
  /// with a note.
  /// \throws InputError naming file:line and column: unreadable or damaged file, wrong header, wrong number of columns,
  ///         what is not a finite number, no record at all
  Table(const std::filesystem::path& path, const TableFormat& format);

  [[nodiscard]] int rows() const { return static_cast<int>(lines_.size()); }
  [[nodiscard]] double operator()(int row, int column) const {
    return values_[static_cast<std::size_t>(row) * columns_.size() + static_cast<std::size_t>(column)];
  }
  /// \throws InputError unless the number is an integer that fits into 53 bits
  [[nodiscard]] std::int64_t integer(int row, int column) const;
  /// \throws InputError unless the number is at least `min`
  [[nodiscard]] double at_least(double min, int row, int column) const;
  /// A time as microseconds, `unit` being the column's unit in seconds.
  /// \throws InputError beyond a thousand years, where microseconds lose their meaning
  [[nodiscard]] std::int64_t utime(int row, int column, double unit) const;
  /// \throws InputError where a number of the column is smaller than the one above it, or equal to it
  void require_ascending(int column, bool equal_allowed) const;

  /// Refuses a number: "file:line: column: expected ..., got ...".
  [[noreturn]] void refuse(int row, int column, const std::string& expected) const;

  /// What was left out, one line each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  void read_unbroken(std::string_view text, const TableFormat& format);

  std::string path_;
  std::vector<std::string> columns_;
  std::vector<double> values_;  // rows x columns
  std::vector<int> lines_;      // line of each row (unbroken: its number), from 1
  std::vector<std::string> notes_;
};

}  // namespace noctule::datasets
