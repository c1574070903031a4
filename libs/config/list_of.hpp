#pragma once
#include <string>
#include <vector>

namespace noctule::config {

/// `a, b, c`
[[nodiscard]] inline std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace noctule::config
