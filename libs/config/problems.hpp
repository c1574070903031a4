#pragma once
/// Everything that is wrong with a configuration, collected before the program stops.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace noctule::config {

/// Where a text comes from: a file, or the command line.
struct Source {
  std::string name;                 ///< path as the user gave it, or `--set a.b=1`
  std::filesystem::path directory;  ///< relative paths inside the text start here
  bool has_lines = true;            ///< not where it is a single value
};

struct Place {
  std::shared_ptr<const Source> source;
  int line = 0;  ///< from 1; 0 where lines mean nothing
};
[[nodiscard]] std::string to_string(const Place&);

class Problems {
 public:
  /// \param key dotted path of the key, empty for the file as a whole
  void add(const Place& place, const std::string& key, const std::string& text);
  [[nodiscard]] bool empty() const { return lines_.empty(); }
  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  /// \throws InputError with one problem a line, in the order they were found, when there are any
  void throw_if_any() const;

 private:
  std::vector<std::string> lines_;
};

}  // namespace noctule::config
