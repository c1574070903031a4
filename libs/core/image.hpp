#pragma once
/// What a camera sees, as a value.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/stamp.hpp"

namespace noctule {

/// Pixels row by row from the top left, channels next to each other: one (grey) or three (blue, green, red).
struct Image {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::vector<std::uint8_t> pixels;  ///< width x height x channels bytes

  [[nodiscard]] bool empty() const { return pixels.empty(); }
  [[nodiscard]] bool consistent() const {
    return width > 0 && height > 0 && (channels == 1 || channels == 3) &&
           pixels.size() ==
               static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels);
  }
  friend bool operator==(const Image&, const Image&) = default;
};

struct CameraImage {
  Stamp stamp;  ///< of the middle of the exposure
  Image image;
};

}  // namespace noctule
