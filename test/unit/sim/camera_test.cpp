#include "sim/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <numeric>
#include <optional>

#include "config/config.hpp"
#include "core/error.hpp"
#include "sim/simulator.hpp"
#include "sim/wall_pictures.hpp"
#include "unit/sim/heptagon.hpp"

namespace noctule::sim {
namespace {

/// 4 x 4 m about the origin, plain walls named 1 (right), 2 (far, at x = 2 m is "2"), ...
RoomParameters plain_room() {
  RoomParameters room;
  room.walls = {{"south", 2.0, radians(270)}, {"east", 2.0, 0.0}, {"north", 2.0, radians(90)}, {"west", 2.0, kPi}};
  room.contrast = 0.0;
  return room;
}

CameraParameters clean_camera() {
  CameraParameters camera;
  camera.intrinsics = {.width = 640, .height = 480, .fx = 520, .fy = 510, .cx = 315, .cy = 245};
  camera.colour = false;
  camera.blur = 0.0;
  camera.noise = 0.0;
  camera.exposure = 0.0;
  return camera;
}

void distort(models::CameraIntrinsics& c) {
  c.k1 = -0.25, c.k2 = 0.07, c.p1 = 0.001, c.p2 = -0.0015;
}

CameraImage still(const CameraParameters& camera, const RoomParameters& room, const Pose2& pose,
                  std::uint64_t seed = 1) {
  return Camera(camera, room, seed).shoot(pose, pose, 0, 0.0);
}

int pixel(const Image& image, int x, int y, int channel = 0) {
  return image.pixels[static_cast<std::size_t>((y * image.width + x) * image.channels + channel)];
}

double interpolated(const Image& image, const Vector2& p) {
  const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
  const double a = p.x() - x, b = p.y() - y;
  return (1 - b) * ((1 - a) * pixel(image, x, y) + a * pixel(image, x + 1, y)) +
         b * ((1 - a) * pixel(image, x, y + 1) + a * pixel(image, x + 1, y + 1));
}

std::optional<Vector2> seen_at(const CameraParameters& camera, const Pose2& base, const Vector3& point_in_map) {
  const Vector2 in_base = noctule::inverse(base) * Vector2(point_in_map.head<2>());
  const Vector3 in_optical =
      camera.mounting.optical_in_base().inverse() * Vector3(in_base.x(), in_base.y(), point_in_map.z());
  const auto projection = models::project(camera.intrinsics, in_optical);
  if (!projection) return std::nullopt;
  return projection->pixel;
}

TEST(Camera, EdgesOfASignAreWhereTheCameraModelProjectsThem) {
  RoomParameters room = plain_room();
  room.signs = {{.landmark = 0, .picture = 1, .wall = "east", .offset = 0.1, .height = 0.35, .size = 0.4}};
  CameraParameters camera = clean_camera();
  distort(camera.intrinsics);
  camera.mounting = {.position = {0.05, 0.02}, .height = 0.3, .roll = 0.05, .pitch = -0.08, .yaw = 0.1};
  const RoomGeometry geometry(room);
  const WallPicture sign = hang_pictures(room, geometry).front();
  const auto corners = sign.corners(geometry.walls()[sign.wall]);
  for (const Pose2& base : {Pose2{1.0, 0.0, -0.1}, Pose2{1.1, -0.5, 0.3}, Pose2{0.9, 0.6, -0.75}}) {
    const Image image = still(camera, room, base).image;
    for (std::size_t side = 0; side < 4; ++side) {
      const Vector3 &a = corners[side], &b = corners[(side + 1) % 4], inside = corners[(side + 2) % 4] - b;
      for (double f = 0.1; f < 0.95; f += 0.1) {
        const Vector3 on_edge = a + f * (b - a);
        const Vector2 p = *seen_at(camera, base, on_edge);
        // Direction across the edge in the image; the margin is white, the wall is not.
        const Vector2 along = *seen_at(camera, base, on_edge + 0.001 * (b - a)) - p;
        Vector2 inwards = Vector2(-along.y(), along.x()).normalized();
        if (inwards.dot(*seen_at(camera, base, on_edge + 0.02 * inside) - p) < 0.0) inwards = -inwards;
        const double wall = interpolated(image, p - 3.0 * inwards);
        ASSERT_LT(wall, 200.0);
        double inner = 0.0;  // pixels of the way from -1.5 to 1.5 that are white
        constexpr int kSteps = 300;
        for (int i = 0; i < kSteps; ++i) {
          const double t = 3.0 * (i + 0.5) / kSteps - 1.5;
          inner += 3.0 / kSteps * (interpolated(image, p + t * inwards) - wall) / (255.0 - wall);
        }
        EXPECT_NEAR(inner, 1.5, 0.1) << "side " << side << " at " << f << " from x = " << base.x;
      }
    }
  }
}

/// Depth of a pixel without any table: the nearest of all surfaces of a convex room.
double depth_in_closed_form(const RoomParameters& room, const CameraParameters& camera, const Pose2& base,
                            const Vector2& at) {
  const Vector2 d = models::unproject(camera.intrinsics, at)->direction;
  const Vector3 in_base = camera.mounting.optical_in_base().linear() * Vector3(d.x(), d.y(), 1.0);
  const Vector2 flat = Pose2{0, 0, base.yaw} * Vector2(in_base.head<2>());
  const Vector2 eye = base * camera.mounting.position;
  const double up = camera.mounting.height;
  double s = in_base.z() < 0.0 ? -up / in_base.z() : (room.height - up) / in_base.z();
  for (const WallSegment& w : RoomGeometry(room).walls()) {
    const double facing = w.normal.dot(flat);
    if (facing > 0.0) s = std::min(s, w.normal.dot(w.from - eye) / facing);
  }
  for (const CylinderParameters& c : room.cylinders) {
    const double a = flat.squaredNorm(), b = flat.dot(c.centre - eye);
    const double discriminant = b * b - a * ((c.centre - eye).squaredNorm() - c.radius * c.radius);
    if (discriminant < 0.0 || b < 0.0) continue;
    const double side = (b - std::sqrt(discriminant)) / a, lid = (c.height - up) / in_base.z();
    if (up + side * in_base.z() <= c.height) {
      s = std::min(s, side);
    } else if (in_base.z() < 0.0 && (lid * flat - (c.centre - eye)).norm() < c.radius) {
      s = std::min(s, lid);
    }
  }
  return s;
}

TEST(Camera, DepthAgreesWithClosedForms) {
  const auto world = config::load<WorldParameters>(NOCTULE_SOURCE_DIR "/config/worlds/heptagon_signs.yaml");
  RoomParameters room = world.room;
  room.cylinders[1].height = 0.2;  // lower than the camera: its lid is seen
  CameraParameters camera = clean_camera();
  distort(camera.intrinsics);
  for (const double pitch : {0.0, 0.3, 1.4}) {
    camera.mounting = {.position = {0.04, -0.01}, .height = 0.3, .roll = 0.02, .pitch = pitch, .yaw = -0.2};
    Camera eyes(camera, room, 1);
    for (const Pose2& base : {Pose2{0, 0, 0}, Pose2{1.5, 0, 2.0}, Pose2{2.5, 1.3, -2.4}, Pose2{0.0, 1.65, -0.7}}) {
      const DepthImage image = eyes.depth(base);
      int jumps = 0;  // pixels on an outline, where rounding decides
      for (int y = 0; y < image.height; y += 3) {
        for (int x = 0; x < image.width; x += 3) {
          const double got = image.depth[static_cast<std::size_t>(y * image.width + x)];
          const double expected = depth_in_closed_form(room, camera, base, Vector2(x, y));
          if (std::abs(got - expected) > 1e-4 * expected) ++jumps;
        }
      }
      EXPECT_LE(jumps, 3) << "pitch " << pitch << ", x = " << base.x;
    }
  }
}

TEST(Camera, APostHidesTheSignBehindIt) {
  RoomParameters room = plain_room();
  room.signs = {{.landmark = 0, .picture = 1, .wall = "east", .height = 0.3, .size = 0.4}};
  CameraParameters camera = clean_camera();
  camera.colour = true;
  const Pose2 base{0, 0, 0};
  const int u = 315, v = 245;  // the optical axis meets the middle of the sign
  const Image open = still(camera, room, base).image;
  EXPECT_EQ(pixel(open, u, v, 0), pixel(open, u, v, 2)) << "signs are grey";
  room.cylinders = {{.name = "post", .centre = {1.0, 0.0}, .radius = 0.05, .height = 0.6, .colour = {255, 0, 0}}};
  Camera eyes(camera, room, 1);
  const Image hidden = eyes.shoot(base, base, 0, 0.0).image;
  EXPECT_EQ(pixel(hidden, u, v, 0), 0);
  EXPECT_GT(pixel(hidden, u, v, 2), 150);
  const DepthImage depth = eyes.depth(base);
  EXPECT_NEAR(depth.depth[static_cast<std::size_t>(v * depth.width + u)], 0.95, 1e-5);
  // The outline of the post: tangents from the eye, at asin(r / d) to both sides.
  const double half = 520.0 * std::tan(std::asin(0.05));
  int red = 0, mixed = 0;
  for (int x = 0; x < depth.width; ++x) {
    const bool post = pixel(hidden, x, v, 0) == 0, wall = pixel(hidden, x, v, 0) == pixel(hidden, x, v, 2);
    red += post ? 1 : 0;
    mixed += !post && !wall ? 1 : 0;
  }
  EXPECT_LE(mixed, 2);
  EXPECT_NEAR(red + 0.5 * mixed, 2.0 * half, 1.0);
  // A post behind the wall's sign, seen from the other side of it, hides nothing.
  EXPECT_EQ(still(camera, room, {1.5, 0, 0}).image, still(camera,
                                                          [&] {
                                                            RoomParameters bare = room;
                                                            bare.cylinders.clear();
                                                            return bare;
                                                          }(),
                                                          {1.5, 0, 0})
                                                        .image);
}

TEST(Camera, NoiseIsWhiteWithTheVarianceAskedFor) {
  CameraParameters camera = clean_camera();
  camera.noise = 5.0;
  RoomParameters room = plain_room();
  const Pose2 base{1.5, 0, 0};  // nothing but wall in the rows looked at
  Camera eyes(camera, room, 7);
  const Image image = eyes.shoot(base, base, 3, 0.0).image;
  CameraParameters clean = clean_camera();
  const double level = pixel(still(clean, room, base).image, 320, 200);
  double sum = 0.0, squares = 0.0, right = 0.0, below = 0.0;
  int n = 0;
  const auto error = [&](int x, int y) { return pixel(image, x, y) - level; };
  for (int y = 100; y < 240; ++y) {
    for (int x = 60; x < 560; ++x, ++n) {
      sum += error(x, y);
      squares += error(x, y) * error(x, y);
      right += error(x, y) * error(x + 1, y);
      below += error(x, y) * error(x, y + 1);
    }
  }
  const double variance = 25.0 + 1.0 / 12.0;  // and of rounding
  EXPECT_NEAR(sum / n, 0.0, 0.5 + 4.0 * std::sqrt(variance / n)) << "the level itself is rounded";
  const double mean = sum / n;
  EXPECT_NEAR(squares / n - mean * mean, variance, 4.0 * variance * std::sqrt(2.0 / n));
  EXPECT_NEAR(right / n - mean * mean, 0.0, 4.0 * variance / std::sqrt(n));
  EXPECT_NEAR(below / n - mean * mean, 0.0, 4.0 * variance / std::sqrt(n));
  EXPECT_NE(eyes.shoot(base, base, 4, 0.0).image, image) << "each picture has noise of its own";
  EXPECT_EQ(eyes.shoot(base, base, 3, 0.0).image, image) << "which its number alone decides";
  EXPECT_NE(still(camera, room, base, 8).image, still(camera, room, base, 7).image);
}

TEST(Camera, SameBytesFromAnyNumberOfThreads) {
  const auto world = config::load<WorldParameters>(NOCTULE_SOURCE_DIR "/config/worlds/heptagon_signs.yaml");
  CameraParameters camera;
  camera.intrinsics = {.width = 160, .height = 120, .fx = 125, .fy = 125, .cx = 79.5, .cy = 59.5};
  const auto film = [&] {
    Camera eyes(camera, world.room, 5);
    std::vector<Image> images;
    for (int i = 0; i < 3; ++i) images.push_back(eyes.shoot({0.1 * i, 0, 0}, {0.1 * i, 0, 0.01}, i, 0.1 * i).image);
    return images;
  };
  const auto alone = film();
  std::vector<std::future<std::vector<Image>>> crowd;
  for (int i = 0; i < 4; ++i) crowd.push_back(std::async(std::launch::async, film));
  for (auto& one : crowd) EXPECT_EQ(one.get(), alone);
}

/// Way from 16 % to 84 % of the step from the black post on the left to the wall on the right, in pixels.
double edge_width(const Image& image, int y) {
  const double wall = pixel(image, 400, y);
  const auto crossing = [&](double level) {
    int x = 250;
    while (pixel(image, x + 1, y) < level * wall) ++x;
    return x + (level * wall - pixel(image, x, y)) / (pixel(image, x + 1, y) - pixel(image, x, y));
  };
  return crossing(0.8413) - crossing(0.1587);
}

TEST(Camera, BlurOfDefocusAndOfMotionHaveTheirWidths) {
  RoomParameters room = plain_room();
  room.cylinders = {{.name = "post", .centre = {1.0, 0.2}, .radius = 0.2, .height = 0.6, .colour = {0, 0, 0}}};
  CameraParameters camera = clean_camera();
  camera.intrinsics.fx = camera.intrinsics.fy = 1000;
  const Pose2 base{0.0, -0.02, 0.0};  // its right edge stands near the middle of the image
  const int y = 245;
  camera.blur = 3.0;
  EXPECT_NEAR(edge_width(still(camera, room, base).image, y), 2.0 * 3.0, 0.2);
  camera.blur = 0.0;
  const double turn = 0.012;  // 12 pixels
  Camera eyes(camera, room, 1);
  const Image image = eyes.shoot({0.0, -0.02, -0.5 * turn}, {0.0, -0.02, 0.5 * turn}, 0, 0.0).image;
  EXPECT_NEAR(edge_width(image, y), (0.8413 - 0.1587) * 12.0, 0.4);
}

TEST(Camera, LightRisesFallsAndSaturates) {
  CameraParameters camera = clean_camera();
  const RoomParameters room = plain_room();
  const auto grey = [&](double time, int x = 320) {
    Camera eyes(camera, room, 1);
    return pixel(eyes.shoot({}, {}, 0, time).image, x, 200);
  };
  const int level = grey(0.0);
  camera.lighting = {.gain = 1.0, .swing = 0.5, .period = 4.0, .gradient = 0.0};
  EXPECT_NEAR(grey(1.0), 1.5 * level, 1.0);
  EXPECT_NEAR(grey(3.0), 0.5 * level, 1.0);
  camera.lighting = {.gain = 1.0, .swing = 0.0, .period = 4.0, .gradient = 0.4};
  EXPECT_NEAR(grey(0.0, 639) - grey(0.0, 320), 0.4 * level, 1.0);
  EXPECT_NEAR(grey(0.0, 320) - grey(0.0, 0), 0.4 * level, 1.0);
  camera.lighting = {.gain = 0.0, .swing = 0.0, .period = 4.0, .gradient = 0.0};
  EXPECT_EQ(grey(0.0), 0);
  camera.lighting.gain = 10.0;
  EXPECT_EQ(grey(0.0), 255);
}

TEST(Camera, SimulatorTakesOnePictureAtEachStopOrAtItsRate) {
  auto world = config::load<WorldParameters>(NOCTULE_SOURCE_DIR "/config/worlds/heptagon_signs.yaml");
  world.path.loops = 1;
  world.path.waypoints = {{1.0, 0.0}};
  world.path.scans_at_start = 2;
  RobotParameters robot = test::paper002();
  robot.camera.emplace();
  robot.camera->intrinsics = {.width = 64, .height = 48, .fx = 50, .fy = 50, .cx = 31.5, .cy = 23.5};
  const auto count = [&] {
    Simulator simulator(world, robot, 1);
    std::int64_t scans = 0, images = 0, utime = 0;
    while (const auto o = simulator.next()) {
      if (std::holds_alternative<UltrasonicScan>(*o)) ++scans;
      if (const auto* image = std::get_if<CameraImage>(&*o)) {
        EXPECT_EQ(image->stamp.seq, images++);
        EXPECT_GT(image->stamp.utime, utime);
        utime = image->stamp.utime;
        EXPECT_TRUE(image->image.consistent());
      }
    }
    EXPECT_EQ(simulator.world().landmarks.size(), 10u);
    return std::pair(scans, images);
  };
  const auto [scans, at_stops] = count();
  EXPECT_EQ(at_stops, scans);
  robot.camera->rate = 5.0;  // 5 s of driving
  EXPECT_NEAR(static_cast<double>(count().second), 25.0, 3.0);
  robot.camera.reset();
  Simulator blind(world, robot, 1);
  EXPECT_TRUE(blind.world().landmarks.empty());
}

std::string problem(const RoomParameters& room) {
  return room.validate();
}

TEST(Camera, WhatDoesNotFitTheRoomIsNamed) {
  RoomParameters room = plain_room();
  const SignParameters good{.landmark = 0, .picture = 1, .wall = "east", .height = 0.3, .size = 0.4};
  room.signs = {good};
  EXPECT_EQ(problem(room), "");
  room.signs[0].wall = "front";
  EXPECT_EQ(problem(room), "signs[0].wall: expected the name of a wall, got 'front'");
  room.signs[0] = good;
  room.signs[0].offset = 1.9;
  EXPECT_EQ(problem(room),
            "signs[0]: expected it to fit on wall 'east' of 400 x 250 cm, got a square of 40 cm beyond its edge");
  room.signs = {good, good};
  EXPECT_NE(problem(room).find("places that overlap"), std::string::npos);
  room.signs[1].offset = 0.5;
  EXPECT_EQ(problem(room), "landmark: expected different numbers, got 0 twice");
  CameraParameters camera = clean_camera();
  camera.intrinsics.k1 = -3.0;
  EXPECT_THROW(Camera(camera, plain_room(), 1), InputError);
  camera = clean_camera();
  camera.mounting.height = 3.0;
  EXPECT_THROW(Camera(camera, plain_room(), 1), InputError);
}

}  // namespace
}  // namespace noctule::sim
