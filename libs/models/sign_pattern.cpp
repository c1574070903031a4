#include "models/sign_pattern.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "core/pose2.hpp"
#include "core/rng.hpp"

namespace noctule::models {
namespace {

constexpr double kFrame = 0.05;   // width of the dark frame, in sides
constexpr double kMargin = 0.10;  // where shapes begin
constexpr int kLarge = 9;
constexpr int kSmall = 28;

using Colour = std::array<double, 3>;

enum class Form { rectangle, disc, triangle };

struct Shape {
  Form form = Form::disc;
  Vector2 centre, axis;  // axis: the half length, along its direction
  double ratio = 1.0;    // of the other half length
  Colour colour{};

  [[nodiscard]] bool covers(const Vector2& p) const {
    const Vector2 d = p - centre;
    const double s = axis.squaredNorm();
    const double u = d.dot(axis) / s, v = (axis.x() * d.y() - axis.y() * d.x()) / s;
    switch (form) {
      case Form::rectangle:
        return std::abs(u) <= 1.0 && std::abs(v) <= ratio;
      case Form::disc:
        return u * u + v * v <= 1.0;
      case Form::triangle:
        return u >= -0.5 && u + std::abs(v) / ratio <= 1.0;
    }
    return false;
  }
};

/// A colour of given luminance (Rec. 601), in blue, green, red.
Colour colour_of(double luminance, Rng& rng) {
  Colour c{rng.uniform(), rng.uniform(), rng.uniform()};
  const double now = 0.114 * c[0] + 0.587 * c[1] + 0.299 * c[2];
  const double pull = 0.4;  // towards grey
  for (double& x : c) x = std::min(1.0, std::max(0.0, luminance + pull * (x - now)));
  return c;
}

std::array<Shape, kLarge + kSmall> shapes_of(std::uint64_t number) {
  std::array<Shape, kLarge + kSmall> shapes;
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    Rng rng(number, stream_id("sign_pattern"), 0, i);
    const bool large = i < kLarge;
    const double size = large ? rng.uniform(0.10, 0.22) : rng.uniform(0.025, 0.07);
    Shape& s = shapes[i];
    s.form = static_cast<Form>(rng.index(3));
    s.centre = Vector2(rng.uniform(kMargin + 0.5 * size, 1.0 - kMargin - 0.5 * size),
                       rng.uniform(kMargin + 0.5 * size, 1.0 - kMargin - 0.5 * size));
    Vector2 direction(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
    if (direction.norm() < 0.1) direction = Vector2(1.0, 0.0);
    s.axis = direction * (size / std::sqrt(direction.squaredNorm()));
    s.ratio = rng.uniform(0.5, 1.0);
    // Dark and bright by turns, so that what lies over another stands out from it.
    s.colour = colour_of(i % 2 == 0 ? rng.uniform(0.05, 0.30) : rng.uniform(0.65, 0.95), rng);
  }
  return shapes;
}

}  // namespace

Image sign_pattern(std::uint64_t number, int side) {
  if (side < 8 || side > 4096) throw std::invalid_argument("sign_pattern: expected 8 to 4096 pixels a side");
  const auto shapes = shapes_of(number);
  const Colour frame{0.08, 0.08, 0.08}, ground{0.92, 0.92, 0.92};
  constexpr int kRays = 3;

  Image image{side, side, 3, {}};
  image.pixels.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 3U);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      Colour sum{};
      for (int ray = 0; ray < kRays * kRays; ++ray) {
        const Vector2 p((column + (ray % kRays + 0.5) / kRays) / side, (row + (ray / kRays + 0.5) / kRays) / side);
        const double edge = std::min(std::min(p.x(), p.y()), std::min(1.0 - p.x(), 1.0 - p.y()));
        Colour seen = edge < kFrame ? frame : ground;
        if (edge >= kMargin) {
          for (const Shape& s : shapes)
            if (s.covers(p)) seen = s.colour;
        }
        for (std::size_t c = 0; c < 3; ++c) sum[c] += seen[c];
      }
      for (const double c : sum) image.pixels.push_back(static_cast<std::uint8_t>(c / (kRays * kRays) * 255.0 + 0.5));
    }
  }
  return image;
}

}  // namespace noctule::models
