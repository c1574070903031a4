#pragma once
#include <string>

#include "core/parameters.hpp"

namespace noctule::config {

[[nodiscard]] bool contains(const Range&, double value);
/// `>= 1`, `> 0`, `in [0, 1]`, or nothing when every finite number is allowed.
[[nodiscard]] std::string to_string(const Range&);

}  // namespace noctule::config
