#include "models/fiducial.hpp"

#include <array>
#include <stdexcept>
#include <string>

namespace noctule::models {
namespace {

/// The white cells, row by row from the top left, the first in the highest bit.
constexpr std::array<std::uint16_t, kFiducials> kCells = {
    0xb532, 0x0f9a, 0x332d, 0x9946, 0x549e, 0x79cd, 0x9e2e, 0xc4f2, 0xfeda, 0xcf56, 0xf991, 0x11a7, 0x0eb7,
    0x2a0f, 0x24b1, 0x263e, 0x4665, 0x6600, 0x6c5e, 0x76af, 0x868b, 0xb02b, 0xccd5, 0xdd82, 0xfe47, 0x9471,
    0xace4, 0xa554, 0x2123, 0x346f, 0x4415, 0x57b2, 0x9ecf, 0xf0cb, 0x08ae, 0x0929, 0x1875, 0x04ff, 0x0df6,
    0x1c5a, 0x1718, 0x2a28, 0x328c, 0x38b2, 0x24e8, 0x2eeb, 0x2d3f, 0x4b64, 0x502e, 0x5013};

bool white(std::uint16_t cells, int row, int column) {
  constexpr int kAll = kFiducialCells + 2 * kFiducialMargin, kBorder = kFiducialMargin + 1;
  if (row < kFiducialMargin || column < kFiducialMargin || row >= kAll - kFiducialMargin ||
      column >= kAll - kFiducialMargin) {
    return true;
  }
  const int r = row - kBorder, c = column - kBorder;
  if (r < 0 || c < 0 || r >= 4 || c >= 4) return false;
  return ((cells >> (15 - 4 * r - c)) & 1) != 0;
}

}  // namespace

Image fiducial_picture(int marker, int pixels_per_cell) {
  if (marker < 0 || marker >= kFiducials) {
    throw std::out_of_range("no marker " + std::to_string(marker) + " in the dictionary");
  }
  const int side = (kFiducialCells + 2 * kFiducialMargin) * pixels_per_cell;
  Image image{side, side, 1, {}};
  image.pixels.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const bool light = white(kCells[static_cast<std::size_t>(marker)], y / pixels_per_cell, x / pixels_per_cell);
      image.pixels.push_back(light ? 255 : 0);
    }
  }
  return image;
}

}  // namespace noctule::models
