#include "sim/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/error.hpp"
#include "sim/room_geometry.hpp"
#include "sim/wall_pictures.hpp"

namespace noctule::sim {
namespace {

constexpr int kFloor = 0, kCeiling = 1, kFirstWall = 2;
constexpr float kFloorGrey = 95.0f, kCeilingGrey = 205.0f, kWallGrey = 150.0f;
constexpr float kPlasterSide = 1.28f;       // of the texture [m]
constexpr float kPlasterDeviation = 33.0f;  // its standard deviation [grey levels]
constexpr float kTolerance = 1e-4f;         // by which walls reach beyond their ends, so that corners have no gap [m]
const Vector2 kLightFrom(std::cos(0.7), std::sin(0.7));  // the walls differ by where they face

/// Where the 16 rays of a pixel on an edge go: no two share a row or a column (Hammersley's points).
constexpr auto kEdgeRays = [] {
  std::array<std::pair<float, float>, 16> rays{};
  for (unsigned i = 0; i < 16; ++i) {
    const unsigned mirrored = ((i & 1) << 3) | ((i & 2) << 1) | ((i & 4) >> 1) | ((i & 8) >> 3);
    rays[i] = {(static_cast<float>(i) + 0.5f) / 16.0f, (static_cast<float>(mirrored) + 0.5f) / 16.0f};
  }
  return rays;
}();

/// Brightness of an upright surface by the direction in which it looks.
double shade(const Vector2& normal) {
  return 0.88 + 0.12 * normal.dot(kLightFrom);
}

}  // namespace

Renderer::Renderer(const RoomParameters& room, const models::CameraIntrinsics& camera,
                   const models::CameraMounting& mounting, int channels)
    : camera_(camera),
      mounting_(mounting),
      channels_(channels),
      ceiling_(static_cast<float>(room.height)),
      contrast_(static_cast<float>(room.contrast)),
      plaster_(plaster()) {
  if (mounting.height >= room.height) {
    std::ostringstream out;
    out << "camera.mounting.height_cm: expected it below the ceiling at " << 100.0 * room.height << " cm, got "
        << 100.0 * mounting.height;
    throw InputError(out.str());
  }
  const RoomGeometry geometry(room);
  for (const WallSegment& w : geometry.walls()) {
    walls_.push_back({w.from,
                      (w.to - w.from).normalized(),
                      w.normal,
                      (w.to - w.from).norm(),
                      kWallGrey * static_cast<float>(shade(-w.normal)),
                      {}});
  }
  for (const CylinderParameters& c : room.cylinders) {
    const auto tint = [&](std::size_t i) { return static_cast<float>(c.colour[i] / 255.0); };
    const bool tall = c.height <= 0.0 || c.height > room.height;
    cylinders_.push_back({c.centre, c.radius, tall ? room.height : c.height, {tint(2), tint(1), tint(0)}});
  }
  first_cylinder_ = kFirstWall + static_cast<int>(walls_.size());
  first_cap_ = first_cylinder_ + static_cast<int>(cylinders_.size());
  first_picture_ = first_cap_ + static_cast<int>(cylinders_.size());
  for (const WallPicture& p : hang_pictures(room, geometry)) {
    walls_[p.wall].pictures.push_back(static_cast<int>(pictures_.size()));
    pictures_.push_back({static_cast<int>(p.wall), static_cast<float>(p.along), static_cast<float>(p.height),
                         static_cast<float>(p.half), Texture(p.image(), Texture::Border::clamp)});
  }
  tints_.assign(static_cast<std::size_t>(first_picture_) + pictures_.size(), {1.0f, 1.0f, 1.0f});
  for (std::size_t i = 0; i < cylinders_.size(); ++i) {
    auto tint = cylinders_[i].tint;
    if (channels_ == 1) tint.fill(0.114f * tint[0] + 0.587f * tint[1] + 0.299f * tint[2]);
    tints_[static_cast<std::size_t>(first_cylinder_) + i] = tints_[static_cast<std::size_t>(first_cap_) + i] = tint;
  }
  build_rays();
  build_bins();
}

void Renderer::build_rays() {
  const Eigen::Matrix3d optical_in_base = mounting_.optical_in_base().linear();
  rays_.reserve(static_cast<std::size_t>(camera_.width + 1) * static_cast<std::size_t>(camera_.height + 1));
  for (int y = 0; y <= camera_.height; ++y) {
    for (int x = 0; x <= camera_.width; ++x) {
      const auto ray = models::unproject(camera_, {x - 0.5, y - 0.5});
      if (!ray) {
        std::ostringstream out;
        out << "camera.intrinsics: expected a lens that sends a ray through every pixel, got k1 = " << camera_.k1
            << ", k2 = " << camera_.k2 << ", k3 = " << camera_.k3 << ", which folds at pixel (" << x << ", " << y
            << ")";
        throw InputError(out.str());
      }
      const Vector3 d = optical_in_base * Vector3(ray->direction.x(), ray->direction.y(), 1.0);
      rays_.push_back({static_cast<float>(d.x()), static_cast<float>(d.y()), static_cast<float>(d.z())});
    }
  }
}

void Renderer::build_bins() {
  bins_ = std::clamp(static_cast<int>(kTwoPi * std::min(camera_.fx, camera_.fy) / 1.5), 64, 8192);
  const double width = kTwoPi / bins_;
  std::vector<double> azimuths;  // of the rays
  azimuths.reserve(rays_.size());
  for (const Ray& r : rays_) azimuths.push_back(std::atan2(r.y, r.x));
  bin_.reserve(static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height));
  bin_used_.assign(static_cast<std::size_t>(bins_), false);
  const std::size_t row = static_cast<std::size_t>(camera_.width) + 1;
  for (std::size_t y = 0; y < static_cast<std::size_t>(camera_.height); ++y) {
    for (std::size_t x = 0; x + 1 < row; ++x) {
      const std::size_t i = y * row + x;
      double spread = 0.0;
      for (const std::size_t k : {i + 1, i + row, i + row + 1}) {
        spread = std::max(spread, std::abs(wrap(azimuths[k] - azimuths[i])));
      }
      const int bin = std::min(static_cast<int>((azimuths[i] + kPi) / width), bins_ - 1);
      const bool narrow = spread < 0.99 * width;
      bin_.push_back(narrow ? bin : bins_);
      if (narrow) bin_used_[static_cast<std::size_t>(bin)] = true;
    }
  }
  table_.resize(static_cast<std::size_t>(bins_) + 1);
}

Renderer::Ray Renderer::ray(int x, int y, float dx, float dy) const {
  const std::size_t row = static_cast<std::size_t>(camera_.width) + 1;
  const Ray* a = &rays_[static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x)];
  const Ray* b = a + row;
  const float w00 = (1.0f - dx) * (1.0f - dy), w10 = dx * (1.0f - dy), w01 = (1.0f - dx) * dy, w11 = dx * dy;
  return {w00 * a[0].x + w10 * a[1].x + w01 * b[0].x + w11 * b[1].x,
          w00 * a[0].y + w10 * a[1].y + w01 * b[0].y + w11 * b[1].y,
          w00 * a[0].z + w10 * a[1].z + w01 * b[0].z + w11 * b[1].z};
}

std::span<const int> Renderer::candidates(int x, int y) const {
  const auto pixel =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x);
  return table_[static_cast<std::size_t>(bin_[pixel])];
}

void Renderer::place(const Pose2& base_in_map) {
  eye_ = base_in_map * mounting_.position;
  eye_height_ = static_cast<float>(mounting_.height);
  base_to_map_ = Eigen::Rotation2Dd(base_in_map.yaw).toRotationMatrix();
  const Matrix2 to_base = base_to_map_.transpose();
  near_walls_.clear();
  near_cylinders_.clear();
  for (const RoomWall& w : walls_) {
    const Vector2 a = to_base * (w.from - eye_), n = to_base * w.normal, t = to_base * w.tangent;
    const auto f = [](double x) { return static_cast<float>(x); };
    near_walls_.push_back({f(n.x()), f(n.y()), f(n.dot(a)), f(a.x()), f(a.y()), f(t.x()), f(t.y()), f(w.length)});
  }
  for (const Cylinder& c : cylinders_) {
    const Vector2 p = to_base * (c.centre - eye_);
    near_cylinders_.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(c.radius),
                               static_cast<float>(p.squaredNorm() - c.radius * c.radius),
                               static_cast<float>(c.height)});
  }
  fill_table();
}

template <class Visit>
void Renderer::for_bins(double from, double to, Visit visit) const {
  const double width = kTwoPi / bins_;
  const int first = static_cast<int>(std::floor((from + kPi) / width)) - 1;
  const int last = static_cast<int>(std::floor((to + kPi) / width)) + 1;
  for (int i = first; i <= last; ++i) {
    const int bin = ((i % bins_) + bins_) % bins_;
    const double middle = (i + 0.5) * width - kPi;
    if (bin_used_[static_cast<std::size_t>(bin)]) {
      visit(static_cast<std::size_t>(bin), middle - 1.5 * width, middle + 1.5 * width);
    }
  }
}

void Renderer::fill_table() {
  for (auto& surfaces : table_) surfaces.clear();
  struct Interval {
    double from, to;
  };
  std::vector<Interval> intervals;
  std::vector<double> limit(table_.size(), std::numeric_limits<double>::infinity());
  const auto distance = [](const NearWall& w, double azimuth) {
    const double cosine = w.nx * std::cos(azimuth) + w.ny * std::sin(azimuth);
    return cosine > 1e-3 ? w.rho / cosine : 1e3 * w.rho;
  };
  // A wall that faces the camera is seen counter-clockwise from its begin; it hides whatever is behind it.
  for (const NearWall& w : near_walls_) {
    const double from = std::atan2(w.ay, w.ax);
    const double to = std::atan2(w.ay + w.length * w.ty, w.ax + w.length * w.tx);
    intervals.push_back({from, from + wrap(to - from)});
    if (w.rho <= 0.0f) continue;
    for_bins(intervals.back().from, intervals.back().to, [&](std::size_t bin, double begin, double end) {
      if (begin < intervals.back().from || end > intervals.back().to) return;
      limit[bin] = std::min(limit[bin], std::max(distance(w, begin), distance(w, end)));
    });
  }
  for (std::size_t i = 0; i < near_walls_.size(); ++i) {
    const NearWall& w = near_walls_[i];
    if (w.rho <= 0.0f) continue;
    const int surface = kFirstWall + static_cast<int>(i);
    const auto [from, to] = intervals[i];
    for_bins(from, to, [&](std::size_t bin, double begin, double end) {
      const double nearest = std::min(distance(w, std::max(begin, from)), distance(w, std::min(end, to)));
      if (0.99 * nearest <= limit[bin]) table_[bin].push_back(surface);
    });
    table_.back().push_back(surface);
  }
  for (std::size_t i = 0; i < near_cylinders_.size(); ++i) {
    const NearCylinder& c = near_cylinders_[i];
    const int surface = first_cylinder_ + static_cast<int>(i);
    const double d = std::hypot(c.x, c.y), middle = std::atan2(c.y, c.x);
    const double half = c.radius < d ? std::asin(c.radius / d) : kPi;
    for_bins(middle - half, middle + half, [&](std::size_t bin, double, double) {
      if (table_[bin].empty() || table_[bin].back() != surface) table_[bin].push_back(surface);
    });
    table_.back().push_back(surface);
  }
}

void Renderer::meet_floor_or_ceiling(const Ray& r, Hit& nearest) const {
  if (r.z < 0.0f) {
    nearest = {-eye_height_ / r.z, kFloor, 0.0f, 0.0f};
  } else if (r.z > 0.0f) {
    nearest = {(ceiling_ - eye_height_) / r.z, kCeiling, 0.0f, ceiling_};
  } else {
    nearest = {std::numeric_limits<float>::infinity(), kCeiling, 0.0f, ceiling_};
  }
}

void Renderer::meet_wall(const Ray& r, int wall, Hit& nearest) const {
  const NearWall& w = near_walls_[static_cast<std::size_t>(wall)];
  const float facing = w.nx * r.x + w.ny * r.y;
  if (!(facing > 0.0f)) return;
  const float s = w.rho / facing;
  if (s >= nearest.s) return;
  const float along = (s * r.x - w.ax) * w.tx + (s * r.y - w.ay) * w.ty;
  if (along < -kTolerance || along > w.length + kTolerance) return;
  const float z = eye_height_ + s * r.z;
  nearest = {s, kFirstWall + wall, along, z};
  for (const int i : walls_[static_cast<std::size_t>(wall)].pictures) {
    const Picture& p = pictures_[static_cast<std::size_t>(i)];
    if (std::abs(along - p.along) <= p.half && std::abs(z - p.height) <= p.half) nearest.surface = first_picture_ + i;
  }
}

void Renderer::meet_cylinder(const Ray& r, int cylinder, Hit& nearest) const {
  const NearCylinder& c = near_cylinders_[static_cast<std::size_t>(cylinder)];
  const float a = r.x * r.x + r.y * r.y, b = r.x * c.x + r.y * c.y;
  const float discriminant = b * b - a * c.outside;
  if (!(discriminant >= 0.0f) || b <= 0.0f) return;
  float s = (b - std::sqrt(discriminant)) / a;
  float z = eye_height_ + s * r.z;
  int surface = first_cylinder_ + cylinder;
  if (z > c.top) {  // above the rim; from above, its lid may be seen
    if (!(r.z < 0.0f)) return;
    s = (c.top - eye_height_) / r.z;
    z = c.top;
    surface = first_cap_ + cylinder;
    const float dx = s * r.x - c.x, dy = s * r.y - c.y;
    if (dx * dx + dy * dy > c.radius * c.radius) return;
  }
  if (s > 0.0f && s < nearest.s) nearest = {s, surface, 0.0f, z};
}

Renderer::Hit Renderer::cast(const Ray& r, std::span<const int> candidates) const {
  Hit nearest;
  meet_floor_or_ceiling(r, nearest);
  for (const int surface : candidates) {
    if (surface < first_cylinder_) {
      meet_wall(r, surface - kFirstWall, nearest);
    } else {
      meet_cylinder(r, surface - first_cylinder_, nearest);
    }
  }
  return nearest;
}

Renderer::Hit Renderer::meet(const Ray& r, int surface) const {
  Hit hit;
  meet_floor_or_ceiling(r, hit);
  if (surface < kFirstWall) return hit;
  if (surface < first_cylinder_) {
    meet_wall(r, surface - kFirstWall, hit);
  } else if (surface >= first_picture_) {
    meet_wall(r, pictures_[static_cast<std::size_t>(surface - first_picture_)].wall, hit);
  } else {
    meet_cylinder(r, surface - (surface < first_cap_ ? first_cylinder_ : first_cap_), hit);
  }
  return hit;
}

float Renderer::plaster_at(float u, float v, float footprint) const {
  if (contrast_ == 0.0f) return 1.0f;
  const float value = plaster_.at(u / kPlasterSide, v / kPlasterSide, footprint / kPlasterSide);
  return 1.0f + contrast_ * (value - 128.0f) / kPlasterDeviation;
}

float Renderer::grey(const Ray& r, const Hit& hit, float pixel) const {
  const float length = std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z);
  // What a pixel covers of a surface grows with the distance, and in one direction with the slant.
  const float across = pixel * hit.s / static_cast<float>(camera_.fx);
  const auto slanted = [&](float cosine) { return across / std::sqrt(std::max(std::abs(cosine) / length, 0.05f)); };
  if (hit.surface >= first_picture_) {
    const Picture& p = pictures_[static_cast<std::size_t>(hit.surface - first_picture_)];
    const NearWall& w = near_walls_[static_cast<std::size_t>(p.wall)];
    const float side = 2.0f * p.half;
    return p.texture.at((p.along + p.half - hit.along) / side, (p.height + p.half - hit.z) / side,
                        slanted(w.nx * r.x + w.ny * r.y) / side);
  }
  if (hit.surface >= kFirstWall && hit.surface < first_cylinder_) {
    const auto i = static_cast<std::size_t>(hit.surface - kFirstWall);
    const NearWall& w = near_walls_[i];
    const float apart = 0.37f * static_cast<float>(i);  // no two walls are alike
    return walls_[i].grey * plaster_at(hit.along + apart, hit.z + apart, slanted(w.nx * r.x + w.ny * r.y));
  }
  const Vector2 place = eye_ + base_to_map_ * Vector2(hit.s * r.x, hit.s * r.y);
  if (hit.surface < kFirstWall || hit.surface >= first_cap_) {
    const float mean = hit.surface == kFloor ? kFloorGrey : hit.surface == kCeiling ? kCeilingGrey : 255.0f;
    return mean * plaster_at(static_cast<float>(place.x()), static_cast<float>(place.y()), slanted(r.z));
  }
  const Cylinder& c = cylinders_[static_cast<std::size_t>(hit.surface - first_cylinder_)];
  const Vector2 normal = (place - c.centre) / c.radius;
  const double round = std::atan2(normal.y(), normal.x()) * c.radius;
  return 255.0f * static_cast<float>(shade(normal)) * plaster_at(static_cast<float>(round), hit.z, across);
}

void Renderer::add_pixel(int x, int y, const int* above, const int* below, float weight, float* light) const {
  const bool edge = above[0] != above[1] || above[0] != below[0] || above[0] != below[1];
  const int surface = above[0];
  const auto cast_one = [&](float dx, float dy, float share, float size) {
    const Ray r = ray(x, y, dx, dy);
    const Hit hit = edge ? cast(r, candidates(x, y)) : meet(r, surface);
    const float value = share * weight * grey(r, hit, size);
    const auto& tint = tints_[static_cast<std::size_t>(hit.surface)];
    for (int c = 0; c < channels_; ++c) light[c] += value * tint[static_cast<std::size_t>(c)];
  };
  if (edge) {
    for (const auto& [dx, dy] : kEdgeRays) cast_one(dx, dy, 1.0f / kEdgeRays.size(), 0.25f);
  } else if (surface >= first_picture_) {
    for (const float dy : {0.25f, 0.75f}) {
      for (const float dx : {0.25f, 0.75f}) cast_one(dx, dy, 0.25f, 0.5f);
    }
  } else {
    cast_one(0.5f, 0.5f, 1.0f, 1.0f);
  }
}

void Renderer::add_light(const Pose2& base_in_map, float weight, std::vector<float>& light) {
  place(base_in_map);
  const auto width = static_cast<std::size_t>(camera_.width);
  std::vector<int> above(width + 1), below(width + 1);
  const auto look = [&](int y, std::vector<int>& surfaces) {
    for (int x = 0; x <= camera_.width; ++x) {
      const auto near = candidates(std::min(x, camera_.width - 1), std::min(y, camera_.height - 1));
      const auto i = static_cast<std::size_t>(y) * (width + 1) + static_cast<std::size_t>(x);
      surfaces[static_cast<std::size_t>(x)] = cast(rays_[i], near).surface;
    }
  };
  look(0, above);
  float* pixel = light.data();
  for (int y = 0; y < camera_.height; ++y) {
    look(y + 1, below);
    for (int x = 0; x < camera_.width; ++x, pixel += channels_) {
      add_pixel(x, y, &above[static_cast<std::size_t>(x)], &below[static_cast<std::size_t>(x)], weight, pixel);
    }
    std::swap(above, below);
  }
}

DepthImage Renderer::depth(const Pose2& base_in_map) {
  place(base_in_map);
  DepthImage image{camera_.width, camera_.height, {}};
  image.depth.reserve(bin_.size());
  for (int y = 0; y < camera_.height; ++y) {
    for (int x = 0; x < camera_.width; ++x) {
      image.depth.push_back(cast(ray(x, y, 0.5f, 0.5f), candidates(x, y)).s);
    }
  }
  return image;
}

}  // namespace noctule::sim
