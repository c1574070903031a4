#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/source.hpp"

namespace noctule::eval {

/// Point landmarks from CSV, `id,x,y` a line, metres in the map frame; the header may be there or not.
/// \param place of the text, for messages: a file name
/// \throws InputError `place:line: ...`: not three finite numbers, an id that is no integer or comes twice
[[nodiscard]] std::vector<KnownLandmark> parse_landmarks(std::string_view text, const std::string& place);

/// The same with a header.
[[nodiscard]] std::string landmarks_csv(std::span<const KnownLandmark> landmarks);

}  // namespace noctule::eval
