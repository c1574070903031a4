#pragma once
/// Flat pictures before a camera, drawn ray by ray: an oracle with a lens, blur, noise and light, that shares nothing
/// with the detectors but the model of the lens.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "core/rng.hpp"
#include "models/camera.hpp"
#include "models/fiducial.hpp"
#include "models/sign_picture.hpp"
#include "sensors/camera/landmark_detector.hpp"
#include "sensors/camera/planar_picture.hpp"
#include "sensors/camera/signs.hpp"

namespace noctule::camera_scene {

struct Flat {
  sensors::PlanarPicture picture;
  sensors::PlanarPose pose;
};

struct Exposure {
  double blur = 0.7;   ///< sd of the lens and focus [pixels]
  double noise = 2.0;  ///< sd of a pixel [grey levels]
  double gain = 0.8, offset = 10.0;
};

/// Upright picture at a range and bearing whose middle is `height` over the floor, its face turned from the line of
/// sight by `angle` about the vertical.
inline sensors::PlanarPose facing(const models::CameraMounting& mounting, double range, double bearing, double height,
                                  double angle) {
  sensors::PlanarPose pose;
  pose.translation = sensors::point_of_sighting(mounting, range, bearing, height);
  const double heading = mounting.yaw + bearing + angle;  // of the picture's z axis in base_link
  Matrix3 in_base;
  in_base.col(2) << std::cos(heading), std::sin(heading), 0.0;
  in_base.col(1) << 0.0, 0.0, -1.0;
  in_base.col(0) = in_base.col(1).cross(in_base.col(2));
  pose.rotation = mounting.optical_in_base().linear().transpose() * in_base;
  return pose;
}

/// Smooth clutter about 120 with structure of 4 to 60 pixels.
inline std::vector<double> background(int width, int height, Rng& rng, double contrast = 25.0) {
  std::vector<double> grey(static_cast<std::size_t>(width * height), 120.0);
  for (const int cell : {64, 24, 9, 4}) {
    const int columns = width / cell + 2, rows = height / cell + 2;
    std::vector<double> knots(static_cast<std::size_t>(columns * rows));
    for (double& k : knots) k = rng.normal();
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int i = x / cell, j = y / cell;
        const double a = static_cast<double>(x % cell) / cell, b = static_cast<double>(y % cell) / cell;
        const auto k = [&](int c, int r) { return knots[static_cast<std::size_t>(r * columns + c)]; };
        grey[static_cast<std::size_t>(y * width + x)] +=
            0.5 * contrast *
            ((1 - b) * ((1 - a) * k(i, j) + a * k(i + 1, j)) + b * ((1 - a) * k(i, j + 1) + a * k(i + 1, j + 1)));
      }
    }
  }
  return grey;
}

inline void blur_rows(std::vector<double>& grey, int width, int height, double sd, bool down) {
  const int reach = static_cast<int>(std::ceil(3.5 * sd));
  std::vector<double> weights;
  double total = 0.0;
  for (int k = -reach; k <= reach; ++k) total += weights.emplace_back(std::exp(-0.5 * k * k / (sd * sd)));
  const int length = down ? height : width, lines = down ? width : height;
  const int step = down ? width : 1, jump = down ? 1 : width;
  std::vector<double> line(static_cast<std::size_t>(length + 2 * reach));
  for (int l = 0; l < lines; ++l) {
    for (int i = -reach; i < length + reach; ++i)
      line[static_cast<std::size_t>(i + reach)] =
          grey[static_cast<std::size_t>(l * jump + std::clamp(i, 0, length - 1) * step)];
    for (int i = 0; i < length; ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * line[static_cast<std::size_t>(i) + k];
      grey[static_cast<std::size_t>(l * jump + i * step)] = sum / total;
    }
  }
}

/// Draws a picture over the scene, 5 x 5 rays a pixel where it shows.
inline void draw(const models::CameraIntrinsics& camera, const Flat& flat, std::vector<double>& grey) {
  const auto outline = sensors::picture_outline(camera, flat.picture, flat.pose);
  if (!outline) return;
  Vector2 low = outline->front(), high = low;
  for (const Vector2& p : *outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Matrix3 back = flat.pose.rotation.transpose();
  const Vector3 eye = -(back * flat.pose.translation);
  constexpr int kRays = 5;
  const Image& texture = flat.picture.grey;
  for (int y = std::max(0, static_cast<int>(low.y()) - 2);
       y <= std::min(camera.height - 1, static_cast<int>(high.y()) + 2); ++y) {
    for (int x = std::max(0, static_cast<int>(low.x()) - 2);
         x <= std::min(camera.width - 1, static_cast<int>(high.x()) + 2); ++x) {
      const auto middle = models::unproject(camera, Vector2(x, y));
      if (!middle) continue;
      double& g = grey[static_cast<std::size_t>(y * camera.width + x)];
      double sum = 0.0;
      for (int k = 0; k < kRays * kRays; ++k) {
        // Rays at random within their cells: else edges along the rows would all be off by the same.
        const std::uint64_t bits = splitmix64(static_cast<std::uint64_t>((y * camera.width + x) * kRays * kRays + k));
        const double a = static_cast<double>(bits & 0xffffU) / 65536.0;
        const double b = static_cast<double>((bits >> 16) & 0xffffU) / 65536.0;
        const Vector2 off((k % kRays + a) / kRays - 0.5, (k / kRays + b) / kRays - 0.5);
        const Vector3 e = back * Vector2(middle->direction + middle->by_pixel * off).homogeneous();
        const Vector2 p = eye.head<2>() - e.head<2>() * (eye.z() / e.z());
        const double u = (p.x() / flat.picture.width + 0.5) * texture.width;
        const double v = (p.y() / flat.picture.height + 0.5) * texture.height;
        const bool on = u >= 0.0 && v >= 0.0 && u < texture.width && v < texture.height;
        sum += on ? static_cast<double>(texture.pixels[static_cast<std::size_t>(static_cast<int>(v) * texture.width +
                                                                                static_cast<int>(u))])
                  : g;
      }
      g = sum / (kRays * kRays);
    }
  }
}

/// An upright cylinder on the floor.
struct Column {
  double range = 2.0, bearing = 0.0, radius = 0.05, height = 0.5;
  std::vector<double> colour{200.0, 40.0, 40.0};  ///< red, green, blue
};

/// A column before clutter in colour, 5 x 5 rays a pixel, darker towards its sides.
inline Image photograph(const models::CameraIntrinsics& camera, const models::CameraMounting& mounting,
                        const Column& column, const Exposure& exposure, Rng& rng) {
  const std::vector<double> behind = background(camera.width, camera.height, rng);
  std::array<std::vector<double>, 3> planes{behind, behind, behind};
  const Matrix3 in_base = mounting.optical_in_base().linear();
  const double direction = mounting.yaw + column.bearing;
  const Vector2 axis = column.range * Vector2(std::cos(direction), std::sin(direction));
  constexpr int kRays = 5;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto middle = models::unproject(camera, Vector2(x, y));
      if (!middle) continue;
      int hits = 0;
      double light = 0.0;
      for (int k = 0; k < kRays * kRays; ++k) {
        const Vector2 off((k % kRays + 0.5) / kRays - 0.5, (k / kRays + 0.5) / kRays - 0.5);
        const Vector3 d = in_base * Vector2(middle->direction + middle->by_pixel * off).homogeneous();
        const double a = d.head<2>().squaredNorm(), b = d.head<2>().dot(axis);
        const double c = axis.squaredNorm() - column.radius * column.radius;
        const double root = b * b - a * c;
        if (root < 0.0) continue;
        const double t = (b - std::sqrt(root)) / a;
        const double z = mounting.height + t * d.z();
        if (t <= 0.0 || z < 0.0 || z > column.height) continue;
        ++hits;
        light += 0.6 + 0.4 * std::sqrt(root) / (column.radius * std::sqrt(a));
      }
      const auto i = static_cast<std::size_t>(y * camera.width + x);
      for (std::size_t p = 0; p < 3; ++p)
        planes[p][i] += (light * column.colour[2 - p] - hits * planes[p][i]) / (kRays * kRays);
    }
  }
  Image image{camera.width, camera.height, 3, std::vector<std::uint8_t>(3 * behind.size())};
  for (std::size_t p = 0; p < 3; ++p) {
    for (const bool down : {false, true})
      if (exposure.blur > 0.0) blur_rows(planes[p], camera.width, camera.height, exposure.blur, down);
    for (std::size_t i = 0; i < behind.size(); ++i) {
      const double seen = exposure.offset + exposure.gain * planes[p][i] + exposure.noise * rng.normal();
      image.pixels[3 * i + p] = static_cast<std::uint8_t>(std::clamp(std::lround(seen), 0L, 255L));
    }
  }
  return image;
}

inline Image photograph(const models::CameraIntrinsics& camera, std::span<const Flat> flats, const Exposure& exposure,
                        Rng& rng) {
  std::vector<double> grey = background(camera.width, camera.height, rng);
  for (const Flat& flat : flats) draw(camera, flat, grey);
  if (exposure.blur > 0.0) {
    blur_rows(grey, camera.width, camera.height, exposure.blur, false);
    blur_rows(grey, camera.width, camera.height, exposure.blur, true);
  }
  Image image{camera.width, camera.height, 1, {}};
  image.pixels.reserve(grey.size());
  for (const double g : grey) {
    const double seen = exposure.offset + exposure.gain * g + exposure.noise * rng.normal();
    image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(seen), 0L, 255L)));
  }
  return image;
}

/// Catalogue of generated signs 0, 1 ... of one width, and what they look like printed large.
inline sensors::SignDetectorParameters sign_catalogue(int signs, double width) {
  sensors::SignDetectorParameters parameters;
  for (int k = 0; k < signs; ++k) {
    sensors::SignParameters sign;
    sign.id = k;
    sign.picture = static_cast<std::uint64_t>(k);
    sign.width = width;
    parameters.catalogue.push_back(sign);
  }
  return parameters;
}
inline sensors::PlanarPicture printed_sign(int number, double width) {
  return {models::sign_picture(static_cast<std::uint64_t>(number), 512), width, width};
}

/// A marker of the dictionary 4x4_50 with one cell of white around.
inline sensors::PlanarPicture printed_marker(int marker, double side) {
  constexpr int kTexels = 48;
  const double cells = models::kFiducialCells;
  const double whole = side * (cells + 2.0 * models::kFiducialMargin) / cells;
  return {models::fiducial_picture(marker, kTexels), whole, whole};
}

}  // namespace noctule::camera_scene
