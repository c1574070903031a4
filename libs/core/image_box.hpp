#pragma once
/// Upright rectangles in an image.
#include <algorithm>
#include <cmath>

#include "core/pose2.hpp"

namespace noctule {

/// In pixels: u to the right, v down, (0, 0) at the middle of the first pixel.
struct ImageBox {
  Vector2 centre = Vector2::Zero();
  Vector2 size = Vector2::Zero();  ///< width, height

  [[nodiscard]] double area() const { return size.x() * size.y(); }
  [[nodiscard]] bool is_sound() const { return centre.allFinite() && size.allFinite() && (size.array() > 0.0).all(); }
  friend bool operator==(const ImageBox& a, const ImageBox& b) { return a.centre == b.centre && a.size == b.size; }
};

/// Area of the intersection over that of the union, in [0, 1]; 0 for boxes that are not sound.
[[nodiscard]] inline double overlap(const ImageBox& a, const ImageBox& b) {
  if (!a.is_sound() || !b.is_sound()) return 0.0;
  const Vector2 least = (a.centre - 0.5 * a.size).cwiseMax(b.centre - 0.5 * b.size);
  const Vector2 most = (a.centre + 0.5 * a.size).cwiseMin(b.centre + 0.5 * b.size);
  const Vector2 side = (most - least).cwiseMax(0.0);
  const double common = side.x() * side.y();
  return common / (a.area() + b.area() - common);
}

}  // namespace noctule
