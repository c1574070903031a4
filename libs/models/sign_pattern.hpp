#pragma once
#include <cstdint>

#include "core/image.hpp"

namespace noctule::models {

/// Picture of generated sign `number`: square, three channels. A dark frame, a bright margin, and within it large and
/// small rectangles, discs and triangles in contrasting colours, drawn at random but the same for ever and on every
/// machine. The picture is a function of the plane that every `side` samples (3 x 3 rays a pixel): pictures of
/// different sizes show the same sign.
/// \param side pixels, 8 to 4096
/// \throws std::invalid_argument outside
[[nodiscard]] Image sign_pattern(std::uint64_t number, int side = 256);

}  // namespace noctule::models
