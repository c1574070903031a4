#include "sim/texture.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "core/rng.hpp"

namespace noctule::sim {
namespace {

/// Smooth random values: bilinear between the points of a repeating grid of `cells` x `cells`.
void add_octave(std::vector<float>& sum, int side, int cells, float amplitude) {
  Rng rng(0, stream_id("plaster"), static_cast<std::uint64_t>(cells));
  std::vector<float> grid(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  for (float& g : grid) g = amplitude * static_cast<float>(rng.uniform(-1.0, 1.0));
  const auto value = [&](int x, int y) { return grid[static_cast<std::size_t>((y % cells) * cells + x % cells)]; };
  const float step = static_cast<float>(cells) / static_cast<float>(side);
  for (int y = 0; y < side; ++y) {
    const float gy = static_cast<float>(y) * step;
    const int iy = static_cast<int>(gy);
    const float fy = gy - static_cast<float>(iy);
    for (int x = 0; x < side; ++x) {
      const float gx = static_cast<float>(x) * step;
      const int ix = static_cast<int>(gx);
      const float fx = gx - static_cast<float>(ix);
      const float top = (1.0f - fx) * value(ix, iy) + fx * value(ix + 1, iy);
      const float bottom = (1.0f - fx) * value(ix, iy + 1) + fx * value(ix + 1, iy + 1);
      sum[static_cast<std::size_t>(y * side + x)] += (1.0f - fy) * top + fy * bottom;
    }
  }
}

/// std::floor is a call on machines without SSE 4.1.
int floor_of(float x) {
  const int i = static_cast<int>(x);
  return i - (x < static_cast<float>(i) ? 1 : 0);
}

/// Logarithm of a number >= 1, 0.09 too small at most: linear between powers of two.
float rough_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return static_cast<float>(bits - 0x3f800000u) * 0x1.0p-23f;
}

}  // namespace

Texture::Texture(const Image& grey, Border border) : repeat_(border == Border::repeat) {
  const bool power_of_two = grey.width > 0 && (grey.width & (grey.width - 1)) == 0;
  if (!grey.consistent() || grey.channels != 1 || grey.width != grey.height || !power_of_two) {
    throw std::invalid_argument("expected a square grey picture, its side a power of two");
  }
  levels_.push_back({grey.width, grey.pixels});
  while (levels_.back().side > 1) {
    const Level& fine = levels_.back();
    Level coarse{fine.side / 2, {}};
    coarse.grey.reserve(fine.grey.size() / 4);
    for (int y = 0; y < fine.side; y += 2) {
      for (int x = 0; x < fine.side; x += 2) {
        const auto at = [&](int dx, int dy) {
          return fine.grey[static_cast<std::size_t>((y + dy) * fine.side + x + dx)];
        };
        coarse.grey.push_back(static_cast<std::uint8_t>((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4));
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

float Texture::bilinear(const Level& level, float u, float v) const {
  const float side = static_cast<float>(level.side);
  const float x = u * side - 0.5f, y = v * side - 0.5f;
  int x0 = floor_of(x), y0 = floor_of(y);
  const float ax = x - static_cast<float>(x0), ay = y - static_cast<float>(y0);
  int x1 = x0 + 1, y1 = y0 + 1;
  const int last = level.side - 1;
  if (repeat_) {
    x0 &= last, x1 &= last, y0 &= last, y1 &= last;
  } else {
    x0 = std::clamp(x0, 0, last), x1 = std::clamp(x1, 0, last);
    y0 = std::clamp(y0, 0, last), y1 = std::clamp(y1, 0, last);
  }
  const auto at = [&](int column, int row) {
    return static_cast<float>(level.grey[static_cast<std::size_t>(row * level.side + column)]);
  };
  const float top = at(x0, y0) + ax * (at(x1, y0) - at(x0, y0));
  const float bottom = at(x0, y1) + ax * (at(x1, y1) - at(x0, y1));
  return top + ay * (bottom - top);
}

float Texture::at(float u, float v, float footprint) const {
  const float level = rough_log2(std::max(footprint * static_cast<float>(levels_.front().side), 1.0f));
  const auto fine = std::min(static_cast<std::size_t>(level), levels_.size() - 1);
  const float a = bilinear(levels_[fine], u, v);
  if (fine + 1 == levels_.size()) return a;
  const float mix = level - static_cast<float>(fine);
  return mix <= 0.0f ? a : a + mix * (bilinear(levels_[fine + 1], u, v) - a);
}

Texture plaster() {
  constexpr int kSide = 256;
  std::vector<float> sum(kSide * kSide, 0.0f);
  for (int cells = 2; cells <= kSide; cells *= 2) add_octave(sum, kSide, cells, 30.0f);
  Image image{kSide, kSide, 1, {}};
  for (const float value : sum) {
    image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(128.0f + value), 0L, 255L)));
  }
  return {image, Texture::Border::repeat};
}

}  // namespace noctule::sim
