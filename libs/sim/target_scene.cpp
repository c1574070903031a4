#include "sim/target_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.hpp"
#include "core/rng.hpp"

namespace noctule::sim {
namespace {

constexpr int kPanSpeed = 3;       // [pixels a frame]
constexpr int kJumpPeriod = 60;    // [frames]
constexpr double kJump = 150.0;    // [pixels]
constexpr double kFastest = 25.0;  // [pixels a frame]
constexpr double kCrossing = 4.0;  // [pixels a frame] before the bar
constexpr int kHidden = 15;        // [frames]
constexpr std::size_t kNoisePool = 1 << 16;
using Colour = std::array<double, 3>;  // blue, green, red

std::uint8_t level(double value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
}

/// In [-1, 1], fixed to each point of a square lattice, between them smooth.
double value_noise(std::uint64_t texture, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto corner = [&](int dx, int dy) {
    const auto i = static_cast<std::uint64_t>(static_cast<std::int64_t>(fx) + dx);
    const auto j = static_cast<std::uint64_t>(static_cast<std::int64_t>(fy) + dy);
    return static_cast<double>(splitmix64(texture ^ splitmix64(i * 0x9e3779b97f4a7c15ULL + j)) >> 11) * 0x1.0p-52 - 1.0;
  };
  const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double u = ease(x - fx), v = ease(y - fy);
  const double top = corner(0, 0) + u * (corner(1, 0) - corner(0, 0));
  const double bottom = corner(0, 1) + u * (corner(1, 1) - corner(0, 1));
  return top + v * (bottom - top);
}

/// \param hue in [0, 6): red 0, green 2, blue 4
Colour saturated(double hue, double brightness) {
  const auto part = [&](double centre) {
    const double away = std::abs(std::remainder(hue - centre, 6.0));
    return brightness * std::clamp(2.0 - away, 0.15, 1.0);
  };
  return {part(4.0), part(2.0), part(0.0)};
}

std::uint8_t* pixel(Image& image, int u, int v) {
  return image.pixels.data() +
         (static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(u)) *
             static_cast<std::size_t>(image.channels);
}

Image blank(int width, int height) {
  Image image{width, height, 3, {}};
  image.pixels.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return image;
}

}  // namespace

TargetScene::TargetScene(const TargetFilmParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), seed_(seed) {
  require_sound(parameters_, "target film");
  hue_ = Rng(seed_, stream_id("target_scene.hue")).uniform(0.0, 6.0);
  paint_background();
  noise_.resize(kNoisePool);
  Rng rng(seed_, stream_id("target_scene.noise"));
  for (float& v : noise_) v = static_cast<float>(rng.normal(0.0, parameters_.noise_sd));
}

void TargetScene::paint_background() {
  const bool pans = parameters_.film == TargetFilm::pan;
  background_ = blank(parameters_.width + (pans ? kPanSpeed * parameters_.frames : 0), parameters_.height);
  Rng rng(seed_, stream_id("target_scene.background"));
  const std::array<std::uint64_t, 6> textures{rng(), rng(), rng(), rng(), rng(), rng()};
  for (int v = 0; v < background_.height; ++v) {
    for (int u = 0; u < background_.width; ++u) {
      const double light = 110.0 + 45.0 * value_noise(textures[0], u / 37.0, v / 37.0) +
                           25.0 * value_noise(textures[1], u / 11.0, v / 11.0) +
                           12.0 * value_noise(textures[2], u / 4.0, v / 4.0);
      for (std::size_t c = 0; c < 3; ++c)
        pixel(background_, u, v)[c] = level(light + 30.0 * value_noise(textures[3 + c], u / 60.0, v / 60.0));
    }
  }
  // Boards with corners, so that there is something to follow.
  for (int i = background_.width / 12; i > 0; --i) {
    const auto left = static_cast<int>(rng.uniform(-20.0, background_.width)),
               top = static_cast<int>(rng.uniform(-20.0, background_.height));
    const auto right = left + static_cast<int>(rng.uniform(8.0, 45.0)),
               bottom = top + static_cast<int>(rng.uniform(8.0, 45.0));
    const Colour colour{rng.uniform(40.0, 200.0), rng.uniform(40.0, 200.0), rng.uniform(40.0, 200.0)};
    for (int v = std::max(top, 0); v < std::min(bottom, background_.height); ++v) {
      for (int u = std::max(left, 0); u < std::min(right, background_.width); ++u) {
        for (std::size_t c = 0; c < 3; ++c) {
          std::uint8_t& value = pixel(background_, u, v)[c];
          value = level(0.4 * value + 0.6 * colour[c]);
        }
      }
    }
  }
}

int TargetScene::pan(int k) const {
  return parameters_.film == TargetFilm::pan ? kPanSpeed * k : 0;
}

Vector2 TargetScene::lissajous(int k, std::uint32_t slot, const Vector2& amplitude) const {
  Rng rng(seed_, stream_id("target_scene.way"), 0, slot);
  const double first = rng.uniform(0.0, kTwoPi), second = rng.uniform(0.0, kTwoPi);
  const double across = rng.uniform(0.025, 0.04), down = rng.uniform(0.03, 0.05);
  return {amplitude.x() * std::sin(across * k + first), amplitude.y() * std::sin(down * k + second)};
}

ImageBox TargetScene::truth(int k) const {
  const Vector2 middle(0.5 * (parameters_.width - 1), 0.5 * (parameters_.height - 1));
  const Vector2 most = middle - Vector2::Constant(1.8 * parameters_.radius + 4.0);
  Vector2 centre = middle;
  double radius = parameters_.radius;
  switch (parameters_.film) {
    case TargetFilm::oscillation: {
      const double amplitude = std::min(80.0, most.x());
      centre += Vector2(amplitude * std::sin(kFastest / amplitude * k), lissajous(k, 0, 0.4 * most).y());
      break;
    }
    case TargetFilm::teleport:
      centre.x() += (k / kJumpPeriod % 2 == 0 ? -0.5 : 0.5) * kJump;
      centre += lissajous(k, 0, {std::min(40.0, most.x() - 0.5 * kJump), 0.7 * most.y()});
      break;
    case TargetFilm::occlusion: {
      const double at = std::fmod(kCrossing * k, 4.0 * most.x());
      centre.x() += std::abs(at - 2.0 * most.x()) - most.x();
      centre.y() += lissajous(k, 0, 0.3 * most).y();
      break;
    }
    case TargetFilm::still:
      centre += lissajous(0, 0, 0.8 * most);
      break;
    case TargetFilm::lighting:
      radius *= 1.2 + 0.5 * std::sin(0.045 * k - 0.41);
      centre += lissajous(k, 0, 0.8 * most);
      break;
    default:
      centre += lissajous(k, 0, 0.8 * most);
      break;
  }
  return {centre, Vector2::Constant(2.0 * radius)};
}

double TargetScene::visible(int k) const {
  if (parameters_.film != TargetFilm::occlusion) return 1.0;
  const ImageBox box = truth(k);
  const double half = 0.5 * (2.0 * parameters_.radius + kHidden * kCrossing);
  const double middle = 0.5 * (parameters_.width - 1);
  const double least = box.centre.x() - 0.5 * box.size.x(), most = box.centre.x() + 0.5 * box.size.x();
  const double hidden = std::max(0.0, std::min(most, middle + half) - std::max(least, middle - half));
  return 1.0 - hidden / box.size.x();
}

std::vector<int> TargetScene::losses() const {
  std::vector<int> list;
  bool hidden = false;
  for (int k = 1; k < parameters_.frames; ++k) {
    if (parameters_.film == TargetFilm::teleport && k % kJumpPeriod == 0) list.push_back(k);
    const double share = visible(k);
    if (hidden && share >= 0.5) {
      list.push_back(k);
      hidden = false;
    }
    hidden = hidden || share <= 0.0;
  }
  return list;
}

void TargetScene::paint(const Disc& disc, Image& image) const {
  const Colour base = saturated(disc.hue, 200.0);
  const double reach = disc.radius + 1.0;
  const int top = std::max(0, static_cast<int>(disc.centre.y() - reach));
  const int bottom = std::min(image.height - 1, static_cast<int>(disc.centre.y() + reach) + 1);
  const int left = std::max(0, static_cast<int>(disc.centre.x() - reach));
  const int right = std::min(image.width - 1, static_cast<int>(disc.centre.x() + reach) + 1);
  for (int v = top; v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      const Vector2 offset = (Vector2(u, v) - disc.centre) / disc.radius;
      const double cover = std::clamp((1.0 - offset.norm()) * disc.radius + 0.5, 0.0, 1.0);
      if (cover <= 0.0) continue;
      const double shade = 1.0 + 0.35 * value_noise(disc.texture, 2.5 * offset.x() + 8.0, 2.5 * offset.y() + 8.0);
      std::uint8_t* const p = pixel(image, u, v);
      for (std::size_t c = 0; c < 3; ++c) p[c] = level((1.0 - cover) * p[c] + cover * shade * base[c]);
    }
  }
}

void TargetScene::paint_bar(Image& image) const {
  const double half = 0.5 * (2.0 * parameters_.radius + kHidden * kCrossing), middle = 0.5 * (image.width - 1);
  const std::uint64_t texture = splitmix64(seed_);
  for (int v = 0; v < image.height; ++v) {
    for (int u = static_cast<int>(std::ceil(middle - half)); u <= static_cast<int>(middle + half); ++u) {
      const double light = 90.0 + 40.0 * value_noise(texture, u / 9.0, v / 9.0);
      std::fill_n(pixel(image, u, v), 3, level(light));
    }
  }
}

void TargetScene::expose(int k, Image& image) const {
  double gain = 1.0;
  if (parameters_.film == TargetFilm::lighting)
    gain = 1.0 - 0.6 * std::clamp(std::min((k - 40) / 8.0, (100 - k) / 8.0), 0.0, 1.0);
  std::size_t at = Rng(seed_, stream_id("target_scene.frame"), static_cast<std::uint64_t>(k)).index(kNoisePool);
  const std::size_t stride = 2 * (static_cast<std::size_t>(k) % 977) + 7919;  // odd: visits the whole pool
  for (std::uint8_t& v : image.pixels) {
    v = level(gain * v + static_cast<double>(noise_[at]));
    at = (at + stride) % kNoisePool;
  }
}

Image TargetScene::frame(int k) const {
  Image image = blank(parameters_.width, parameters_.height);
  for (int v = 0; v < image.height; ++v) {
    const std::uint8_t* const from = pixel(const_cast<Image&>(background_), pan(k), v);
    std::copy_n(from, 3 * static_cast<std::size_t>(image.width), pixel(image, 0, v));
  }
  if (parameters_.film == TargetFilm::distractor) {
    const Vector2 middle(0.5 * (image.width - 1), 0.5 * (image.height - 1));
    paint({middle + lissajous(k, 1, 0.7 * middle), parameters_.radius, hue_ + 0.5, splitmix64(seed_ + 1)}, image);
  }
  const ImageBox box = truth(k);
  paint({box.centre, 0.5 * box.size.x(), hue_, splitmix64(seed_ + 2)}, image);
  if (parameters_.film == TargetFilm::occlusion) paint_bar(image);
  expose(k, image);
  if (!parameters_.grey) return image;
  Image grey{image.width, image.height, 1, {}};
  grey.pixels.resize(image.pixels.size() / 3);
  for (std::size_t i = 0; i < grey.pixels.size(); ++i) {
    const std::uint8_t* const c = image.pixels.data() + 3 * i;
    grey.pixels[i] = level(0.114 * c[0] + 0.587 * c[1] + 0.299 * c[2]);
  }
  return grey;
}

}  // namespace noctule::sim
