#pragma once
/// What to say about a key that nobody knows.
#include <string>
#include <string_view>
#include <vector>

#include "config/schema.hpp"

namespace noctule::config {

/// Complete text of the problem: the key with another unit, the nearest known key, or the list of known keys.
[[nodiscard]] std::string unknown_key(std::string_view key, const std::vector<Field>& known);

}  // namespace noctule::config
