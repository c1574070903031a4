#include "report/camera_figure.hpp"

#include <cstdint>

#include "report/text.hpp"

namespace noctule::report {
namespace {

/// Every pixel the mean of four.
Image halved(const Image& image) {
  Image half{image.width / 2, image.height / 2, image.channels, {}};
  const auto at = [&](int x, int y, int c) {
    return int{image.pixels[static_cast<std::size_t>((y * image.width + x) * image.channels + c)]};
  };
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      for (int c = 0; c < half.channels; ++c) {
        const int sum =
            at(2 * x, 2 * y, c) + at(2 * x + 1, 2 * y, c) + at(2 * x, 2 * y + 1, c) + at(2 * x + 1, 2 * y + 1, c);
        half.pixels.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
      }
    }
  }
  return half;
}

/// Windows bitmap of 24 bits: the one format that every browser shows and that needs no compression.
std::string to_bmp(const Image& image) {
  const int padding = (4 - image.width * 3 % 4) % 4;
  const auto size = static_cast<std::uint32_t>((image.width * 3 + padding) * image.height);
  constexpr std::uint32_t kHeader = 54;
  std::string bmp = "BM";
  const auto number = [&](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) bmp += static_cast<char>((value >> (8 * i)) & 0xff);
  };
  for (const std::uint32_t value : {kHeader + size, 0u, kHeader, 40u, static_cast<std::uint32_t>(image.width),
                                    static_cast<std::uint32_t>(image.height)}) {
    number(value, 4);
  }
  number(1, 2);   // planes
  number(24, 2);  // bits of a pixel
  for (const std::uint32_t value : {0u, size, 0u, 0u, 0u, 0u}) number(value, 4);
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const int channel = image.channels == 3 ? c : 0;
        bmp +=
            static_cast<char>(image.pixels[static_cast<std::size_t>((y * image.width + x) * image.channels + channel)]);
      }
    }
    bmp.append(static_cast<std::size_t>(padding), '\0');
  }
  return bmp;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = i; k < i + 3; ++k) {
      word = word << 8 | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[(word >> (18 - 6 * k)) & 63];
  }
  return text;
}

}  // namespace

std::string camera_figure(const CameraExample& example) {
  const std::string width = std::to_string(example.image.width), height = std::to_string(example.image.height);
  std::string svg = "<svg viewBox=\"0 0 " + width + " " + height +
                    "\" role=\"img\" aria-label=\"An image with the landmarks found in it\">" + "<image width=\"" +
                    width + "\" height=\"" + height + "\" href=\"data:image/bmp;base64," +
                    base64(to_bmp(halved(example.image))) + "\"/>\n";
  for (const SeenLandmark& landmark : example.landmarks) {
    if (landmark.outline.empty()) continue;
    std::string points;
    Vector2 top = landmark.outline.front();
    for (const Vector2& p : landmark.outline) {
      points += fixed(p.x(), 1) + "," + fixed(p.y(), 1) + " ";
      if (p.y() < top.y()) top = p;
    }
    const std::string name = landmark.id >= 0 ? std::to_string(landmark.id) + ": " : std::string();
    svg += "<polygon class=\"seen\" points=\"" + points + "\"/><text class=\"seen-name\" x=\"" + fixed(top.x(), 1) +
           "\" y=\"" + fixed(top.y() - 6.0, 1) + "\">" + name + fixed(landmark.range, 2) + " m</text>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace noctule::report
