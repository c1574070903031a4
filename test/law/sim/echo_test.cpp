#include "sim/echo.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/rng.hpp"
#include "unit/sim/heptagon.hpp"

namespace noctule::sim {
namespace {

RoomParameters l_shape() {
  RoomParameters room;
  const double corners[6][2] = {{0, 0}, {3, 0}, {3, 1.2}, {1.2, 1.2}, {1.2, 3}, {0, 3}};
  for (const auto& [x, y] : corners) room.corners.push_back({{x, y}, ""});
  room.cylinders = {{"", {2.2, 0.5}, 0.1}};
  return room;
}

std::vector<EchoPath> find(const EchoScene& scene, const Pose2& emitter, const Pose2& receiver, double half_angle) {
  std::vector<EchoPath> echoes;
  scene.find(emitter, receiver, half_angle, echoes);
  return echoes;
}

double angle_between(const Vector2& a, const Vector2& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

Vector2 heading(double yaw) {
  return {std::cos(yaw), std::sin(yaw)};
}

/// Answers the question by brute force: samples every surface each half millimetre, and takes a sample for specular
/// when its normal points at the sensor as exactly as the spacing allows. `sure` is false where the answer depends on
/// less than the spacing: at the border of the cone, at the
/// end of a wall, or past a corner.
class BruteForce {
 public:
  explicit BruteForce(const RoomGeometry& room) : room_(room) {}

  std::vector<double> ranges(const Pose2& sensor, double half_angle) {
    sure = true;
    found_.clear();
    sensor_ = sensor;
    half_angle_ = half_angle;
    for (const WallSegment& w : room_.walls()) sample_wall(w);
    for (const RoomCylinder& c : room_.cylinders()) sample_cylinder(c.cylinder);
    for (const Corner& c : room_.corners()) {
      const bool retro_reflector = std::abs(degrees(c.interior_angle) - 90.0) <= 5.0;
      if (retro_reflector || c.interior_angle > kPi) take(c.position, c.position);
    }
    std::ranges::sort(found_);
    return found_;
  }

  bool sure = true;

 private:
  static constexpr double kSpacing = 0.0005;

  void sample_wall(const WallSegment& w) {
    const Vector2 t = (w.to - w.from).normalized();
    const double length = (w.to - w.from).norm();
    double best = 1.0;  // sine of the angle between the normal and the line of sight
    double at = 0.0;
    const double overhang = EchoScene::kFootTolerance;
    for (double s = -overhang; s <= length + overhang; s += kSpacing) {
      const Vector2 sight = (w.from + s * t - sensor_.position());
      if (w.normal.dot(sight) <= 0.0) continue;  // from behind
      const double sine = std::abs(t.dot(sight)) / sight.norm();
      if (sine < best) {
        best = sine;
        at = s;
      }
    }
    const Vector2 q = w.from + at * t;
    const double tolerance = 0.51 * kSpacing / (q - sensor_.position()).norm();
    if (best > 4.0 * tolerance) return;
    if (best > tolerance || at < -overhang + 2 * kSpacing || at > length + overhang - 2 * kSpacing) sure = false;
    take(q, w.from + std::clamp(at, kSpacing, length - kSpacing) * t);
  }

  void sample_cylinder(const Cylinder& c) {
    double best = 1e9;
    Vector2 nearest = c.centre;
    const int n = static_cast<int>(kTwoPi * c.radius / kSpacing);
    for (int i = 0; i < n; ++i) {
      const Vector2 q = c.centre + c.radius * heading(kTwoPi * i / n);
      const double misaligned = angle_between(q - c.centre, sensor_.position() - q);
      if (misaligned < best) {
        best = misaligned;
        nearest = q;
      }
    }
    take(nearest, nearest);
  }

  void take(const Vector2& q, const Vector2& visible) {
    const Vector2 sight = q - sensor_.position();
    const double off = angle_between(heading(sensor_.yaw), sight);
    if (std::abs(off - half_angle_) < 2 * kSpacing / sight.norm()) sure = false;
    if (off > half_angle_) return;
    for (const Corner& c : room_.corners()) {
      const Vector2 to_corner = c.position - sensor_.position();
      const bool beside = to_corner.norm() < sight.norm() - 2 * kSpacing && to_corner.dot(sight) > 0.0;
      if (beside && angle_between(to_corner, sight) * to_corner.norm() < 0.003) sure = false;  // a grazing look
    }
    // Walks along the line of sight and looks whether it leaves the room.
    for (double s = kSpacing; s < 0.999; s += 0.001) {
      if (!room_.contains(sensor_.position() + s * (visible - sensor_.position()))) return;
    }
    found_.push_back(sight.norm());
  }

  const RoomGeometry& room_;
  Pose2 sensor_;
  double half_angle_ = 0.0;
  std::vector<double> found_;
};

void expect_equal_to_brute_force(const RoomParameters& parameters, int poses, std::uint64_t seed) {
  const RoomGeometry room(parameters);
  const EchoScene scene(room);
  BruteForce brute_force(room);
  Rng rng(seed);
  int compared = 0, echoes = 0;
  while (compared < poses) {
    const Pose2 sensor{rng.uniform(-0.6, 3.0), rng.uniform(-0.6, 3.0), rng.uniform(-kPi, kPi)};
    if (!room.contains(sensor.position())) continue;
    if (room.clearance(sensor.position(), sensor.position()).distance < 0.05) continue;
    const double half_angle = rng.uniform(radians(5), radians(25));
    const std::vector<double> expected = brute_force.ranges(sensor, half_angle);
    if (!brute_force.sure) continue;
    const std::vector<EchoPath> found = find(scene, sensor, sensor, half_angle);
    ASSERT_EQ(found.size(), expected.size()) << sensor.x << " " << sensor.y << " " << degrees(sensor.yaw);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i].range, expected[i], 1e-5);
    ++compared;
    echoes += static_cast<int>(found.size());
  }
  EXPECT_GT(echoes, poses / 3);
}

TEST(EchoScene, EqualsBruteForceInTheHeptagon) {
  expect_equal_to_brute_force(test::heptagon_room(), 1500, 1);
}

TEST(EchoScene, EqualsBruteForceInARoomWithAnEdge) {
  expect_equal_to_brute_force(l_shape(), 1500, 2);
}

TEST(EchoScene, RangeIsAlongTheNormalNotAlongTheAxis) {
  const EchoScene scene(RoomGeometry(test::heptagon_room()));
  for (const double off_deg : {-14.9, -5.0, 0.0, 14.9}) {
    const Pose2 sensor{0.5, 0.0, radians(-90 + off_deg)};
    const auto echoes = find(scene, sensor, sensor, radians(15));
    ASSERT_EQ(echoes.size(), 1u);
    EXPECT_NEAR(echoes[0].range, 0.6, 1e-12);
    EXPECT_NEAR(echoes[0].received_off, radians(std::abs(off_deg)), 1e-12);
    EXPECT_FALSE(echoes[0].diffracted);
  }
  const Pose2 beside{0.5, 0.0, radians(-90 + 15.1)};
  EXPECT_TRUE(find(scene, beside, beside, radians(15)).empty());
}

TEST(EchoScene, NearestComesFirst) {
  // From (1.2, 0.6) towards -x: cylinder 1, wall 7 behind it.
  const EchoScene scene(RoomGeometry(test::heptagon_room()));
  const Pose2 sensor{1.2, 0.6, kPi};
  const auto echoes = find(scene, sensor, sensor, radians(15));
  ASSERT_EQ(echoes.size(), 2u);
  EXPECT_NEAR(echoes[0].range, 0.6 - 0.106346, 1e-12);
  EXPECT_NEAR(echoes[1].range, 1.8, 1e-12);
}

TEST(EchoScene, OnlyRightAnglesReturnSound) {
  // Traces rays into two neighbouring walls: at a right angle they come back antiparallel after twice the distance to
  // the corner; at the other corners of the heptagon they do not come back.
  const RoomGeometry room(test::heptagon_room());
  const EchoScene scene(room);
  for (std::size_t i = 0; i < 7; ++i) {
    const Corner& corner = room.corners()[i];
    const WallSegment &first = room.walls()[(i + 6) % 7], &second = room.walls()[i];
    const Vector2 sensor = corner.position - 0.5 * (first.normal + second.normal).normalized();
    const Vector2 axis = (corner.position - sensor).normalized();
    const double aim = 1e-4;  // hits the first wall this far from the corner
    const Vector2 hit = corner.position + aim * (first.from - first.to).normalized();
    const Vector2 out = (hit - sensor).normalized();
    const Vector2 once = out - 2 * out.dot(first.normal) * first.normal;
    const double to_second = second.normal.dot(second.from - hit) / second.normal.dot(once);
    const Vector2 back = once - 2 * once.dot(second.normal) * second.normal;
    const Vector2 end = hit + to_second * once;
    const bool returns = to_second > 0.0 && (back + out).norm() < 1e-9;

    const Pose2 pose{sensor.x(), sensor.y(), std::atan2(axis.y(), axis.x())};
    const auto echoes = find(scene, pose, pose, radians(3));
    EXPECT_EQ(!echoes.empty(), returns) << i;
    if (!returns) continue;
    const double half_way = 0.5 * ((hit - sensor).norm() + to_second + (sensor - end).dot(back));
    EXPECT_NEAR(echoes[0].range, half_way, 1e-6);
  }
}

TEST(EchoScene, WayIsTheSameInBothDirections) {
  const EchoScene heptagon(RoomGeometry(test::heptagon_room())), edge{RoomGeometry(l_shape())};
  Rng rng(3);
  int echoes = 0;
  for (int i = 0; i < 500; ++i) {
    const Pose2 base{rng.uniform(0.2, 1.0), rng.uniform(0.2, 1.0), rng.uniform(-kPi, kPi)};
    const Pose2 a = base * Pose2{0.05, 0.04, 0.1}, b = base * Pose2{0.05, -0.04, -0.1};
    for (const EchoScene* scene : {&heptagon, &edge}) {
      const auto there = find(*scene, a, b, radians(20)), back = find(*scene, b, a, radians(20));
      ASSERT_EQ(there.size(), back.size());
      for (std::size_t k = 0; k < there.size(); ++k) {
        EXPECT_NEAR(there[k].range, back[k].range, 1e-12);
        EXPECT_NEAR(there[k].emitted_off, back[k].received_off, 1e-12);
      }
      echoes += static_cast<int>(there.size());
    }
  }
  EXPECT_GT(echoes, 200);
}

TEST(EchoScene, CrossWayOverAWallIsThatOfTheMirrorImage) {
  const EchoScene scene(RoomGeometry(test::heptagon_room()));
  const Pose2 a{0.9, 0.0, radians(-90)}, b{1.1, 0.1, radians(-90)};  // 0.6 and 0.7 from wall 1
  const auto echoes = find(scene, a, b, radians(20));
  ASSERT_EQ(echoes.size(), 1u);
  EXPECT_NEAR(echoes[0].range, 0.5 * std::hypot(0.2, 0.6 + 0.7), 1e-12);
  EXPECT_NEAR(echoes[0].received_off, std::atan2(0.2, 1.3), 1e-12);
}

}  // namespace
}  // namespace noctule::sim
