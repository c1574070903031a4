#pragma once
/// Grey pictures to be looked at from any distance.
#include <cstdint>
#include <vector>

#include "core/image.hpp"

namespace noctule::sim {

/// A square picture and its halves, quarters ... (Williams: "Pyramidal parametrics", SIGGRAPH 1983).
class Texture {
 public:
  enum class Border { clamp, repeat };

  Texture() = default;
  /// \param grey of one channel, square, its side a power of two
  Texture(const Image& grey, Border border);

  /// Grey in [0, 255] at (u, v), in sides of the picture, v downwards, averaged over about `footprint` sides.
  [[nodiscard]] float at(float u, float v, float footprint) const;

 private:
  struct Level {
    int side = 0;
    std::vector<std::uint8_t> grey;
  };
  [[nodiscard]] float bilinear(const Level& level, float u, float v) const;

  std::vector<Level> levels_;
  bool repeat_ = false;
};

/// Smooth random grey about 128 with structure from 5 mm to 64 cm where one side is 1.28 m: plaster. Repeats.
[[nodiscard]] Texture plaster();

}  // namespace noctule::sim
