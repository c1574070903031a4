#pragma once
/// Pictures for signs: what a printer would hang on the wall, made from a number, so that a world and the catalogue of
/// a detector agree without a file between them.
#include <cstdint>

#include "core/image.hpp"

namespace noctule::models {

/// A square grey picture of overlapping discs and slabs of many sizes inside a white margin and a black frame: rich in
/// corners at every scale. The same number gives the same picture, in any size, on every machine.
/// \param side of the picture [pixels], at least 16
[[nodiscard]] Image sign_picture(std::uint64_t number, int side);

}  // namespace noctule::models
