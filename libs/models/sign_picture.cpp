#include "models/sign_picture.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "core/pose2.hpp"
#include "core/rng.hpp"

namespace noctule::models {
namespace {

constexpr std::uint64_t kShapes = stream_id("sign_picture");
constexpr double kMargin = 0.03, kFrame = 0.03;  // of the side

/// A disc, or a slab (a turned rectangle), in units of the side.
struct Shape {
  bool disc = false;
  Vector2 centre;
  Vector2 half;  ///< half the sides of a slab; the radius of a disc in x
  double turn = 0.0;
  double grey = 0.0;

  /// Distance from the outline, below 0 inside.
  [[nodiscard]] double distance(const Vector2& p) const {
    const Vector2 d = p - centre;
    if (disc) return d.norm() - half.x();
    const double c = std::cos(turn), s = std::sin(turn);
    return std::max(std::abs(c * d.x() + s * d.y()) - half.x(), std::abs(c * d.y() - s * d.x()) - half.y());
  }
};

/// From large to small, so that the small ones stay seen.
std::vector<Shape> shapes(std::uint64_t number) {
  Rng rng(number, kShapes);
  std::vector<Shape> all;
  const auto add = [&](int count, double size) {
    for (int i = 0; i < count; ++i) {
      Shape s;
      s.disc = rng.uniform() < 0.35;
      s.centre.x() = rng.uniform(kMargin + kFrame, 1.0 - kMargin - kFrame);
      s.centre.y() = rng.uniform(kMargin + kFrame, 1.0 - kMargin - kFrame);
      s.half.x() = size * rng.uniform(0.6, 1.2);
      s.half.y() = size * rng.uniform(0.3, 0.9);
      s.turn = rng.uniform(0.0, kPi);
      s.grey = rng.uniform() < 0.5 ? rng.uniform(0.0, 90.0) : rng.uniform(165.0, 255.0);
      all.push_back(s);
    }
  };
  add(12, 0.2);
  add(30, 0.09);
  add(60, 0.045);
  return all;
}

/// Lays a shape over the picture, its outline softened over one pixel.
void paint(std::vector<double>& grey, int side, const Shape& s) {
  const double reach = s.half.norm();
  const auto pixel = [side](double x) { return std::clamp(static_cast<int>(std::floor(x * side)), 0, side - 1); };
  for (int y = pixel(s.centre.y() - reach); y <= pixel(s.centre.y() + reach); ++y) {
    for (int x = pixel(s.centre.x() - reach); x <= pixel(s.centre.x() + reach); ++x) {
      const double cover = std::clamp(0.5 - side * s.distance({(x + 0.5) / side, (y + 0.5) / side}), 0.0, 1.0);
      double& g = grey[static_cast<std::size_t>(y * side + x)];
      g += cover * (s.grey - g);
    }
  }
}

/// Share of pixel (x, y) that lies farther from the edge of the picture than `width`.
double inwards(int x, int y, int side, double width) {
  const auto within = [&](int i) {
    const double low = side * width, high = side - low;
    return std::clamp(std::min<double>(i + 1, high) - std::max<double>(i, low), 0.0, 1.0);
  };
  return within(x) * within(y);
}

}  // namespace

Image sign_picture(std::uint64_t number, int side) {
  if (side < 16) throw std::invalid_argument("expected a picture of at least 16 pixels");
  std::vector<double> grey(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 225.0);
  for (const Shape& s : shapes(number)) paint(grey, side, s);
  Image image{side, side, 1, std::vector<std::uint8_t>(grey.size())};
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const std::size_t i = static_cast<std::size_t>(y * side + x);
      const double framed = 10.0 + inwards(x, y, side, kMargin + kFrame) * (grey[i] - 10.0);
      const double value = 255.0 + inwards(x, y, side, kMargin) * (framed - 255.0);
      image.pixels[i] = static_cast<std::uint8_t>(std::lround(value));
    }
  }
  return image;
}

}  // namespace noctule::models
