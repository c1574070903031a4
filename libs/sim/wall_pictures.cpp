#include "sim/wall_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "core/error.hpp"
#include "models/fiducial.hpp"
#include "models/sign_picture.hpp"

namespace noctule::sim {
namespace {

constexpr int kSide = 512;  // of a picture [pixels]

/// Where a square of that side hangs.
template <class Parameters>
WallPicture hang(const Parameters& p, double side, const RoomParameters& room, const RoomGeometry& geometry,
                 const std::string& what) {
  const auto walls = geometry.walls();
  const auto wall = std::ranges::find(walls, p.wall, &WallSegment::name);
  if (wall == walls.end()) throw InputError(what + ".wall: expected the name of a wall, got '" + p.wall + "'");
  const double length = (wall->to - wall->from).norm();
  WallPicture picture;
  picture.landmark = p.landmark;
  picture.wall = static_cast<std::size_t>(wall - walls.begin());
  picture.along = 0.5 * length - p.offset;
  picture.height = p.height;
  picture.half = 0.5 * side;
  if (picture.along < picture.half || picture.along > length - picture.half || picture.height < picture.half ||
      picture.height > room.height - picture.half) {
    std::ostringstream out;
    out << what << ": expected it to fit on wall '" << p.wall << "' of " << 100.0 * length << " x "
        << 100.0 * room.height << " cm, got a square of " << 100.0 * side << " cm beyond its edge";
    throw InputError(out.str());
  }
  return picture;
}

void check_apart(const std::vector<WallPicture>& pictures) {
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const WallPicture &a = pictures[i], &b = pictures[k];
      const double apart = a.half + b.half;
      if (a.wall != b.wall || std::abs(a.along - b.along) >= apart || std::abs(a.height - b.height) >= apart) continue;
      throw InputError("landmarks " + std::to_string(b.landmark) + " and " + std::to_string(a.landmark) +
                       ": expected them beside each other, got places that overlap");
    }
  }
}

void check_numbers(const std::vector<WallPicture>& pictures, const RoomParameters& room) {
  std::set<std::int64_t> numbers;
  const auto take = [&](std::int64_t number) {
    if (numbers.insert(number).second) return;
    throw InputError("landmark: expected different numbers, got " + std::to_string(number) + " twice");
  };
  for (const WallPicture& p : pictures) take(p.landmark);
  for (const CylinderParameters& c : room.cylinders) {
    if (c.landmark >= 0) take(c.landmark);
  }
}

}  // namespace

Image WallPicture::image() const {
  constexpr int kCells = models::kFiducialCells + 2 * models::kFiducialMargin;
  return fiducial ? models::fiducial_picture(static_cast<int>(number), kSide / kCells)
                  : models::sign_picture(number, kSide);
}

std::array<Vector3, 4> WallPicture::corners(const WallSegment& on) const {
  const Vector2 direction = (on.to - on.from).normalized();
  const auto at = [&](double left, double up) {
    const Vector2 p = on.from + (along + left * half) * direction;
    return Vector3(p.x(), p.y(), height + up * half);
  };
  return {at(1.0, 1.0), at(-1.0, 1.0), at(-1.0, -1.0), at(1.0, -1.0)};
}

std::vector<WallPicture> hang_pictures(const RoomParameters& room, const RoomGeometry& geometry) {
  std::vector<WallPicture> pictures;
  for (std::size_t i = 0; i < room.signs.size(); ++i) {
    const SignParameters& sign = room.signs[i];
    pictures.push_back(hang(sign, sign.size, room, geometry, "signs[" + std::to_string(i) + "]"));
    pictures.back().number = sign.picture;
  }
  for (std::size_t i = 0; i < room.fiducials.size(); ++i) {
    const FiducialParameters& f = room.fiducials[i];
    const double side = f.size * (models::kFiducialCells + 2 * models::kFiducialMargin) / models::kFiducialCells;
    pictures.push_back(hang(f, side, room, geometry, "fiducials[" + std::to_string(i) + "]"));
    pictures.back().number = static_cast<std::uint64_t>(f.marker);
    pictures.back().fiducial = true;
  }
  check_apart(pictures);
  check_numbers(pictures, room);
  return pictures;
}

std::vector<KnownLandmark> known_landmarks(const RoomParameters& room, const RoomGeometry& geometry) {
  std::vector<KnownLandmark> landmarks;
  for (const WallPicture& p : hang_pictures(room, geometry)) {
    const WallSegment& wall = geometry.walls()[p.wall];
    landmarks.push_back({p.landmark, wall.from + p.along * (wall.to - wall.from).normalized()});
  }
  for (const CylinderParameters& c : room.cylinders) {
    if (c.landmark >= 0) landmarks.push_back({c.landmark, c.centre});
  }
  return landmarks;
}

}  // namespace noctule::sim
