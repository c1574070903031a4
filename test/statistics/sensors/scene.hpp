#pragma once
/// One object before a robot that drives straight and stops to turn its ranger: enough of a simulator for the
/// extractor's own tests and sweeps.
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/rng.hpp"
#include "models/odometry.hpp"
#include "sensors/ultrasonic/extractor.hpp"

namespace noctule::sensors::scene {

enum class Kind { wall, cylinder, corner, edge };

struct Response {
  double range;      ///< [m]
  double direction;  ///< of the echo [rad]
};

/// In the frame of the world.
struct Object {
  Kind kind = Kind::wall;
  Wall wall;
  Cylinder cylinder;  ///< radius 0 for a corner or an edge

  [[nodiscard]] Response echo(const Vector2& sensor) const {
    const auto answer = [](const auto& prediction) { return Response{prediction.range, prediction.direction}; };
    return kind == Kind::wall ? answer(models::predict_echo(sensor, wall))
                              : answer(models::predict_echo(sensor, cylinder));
  }
};

struct Ranger {
  models::RangeNoise noise;
  double scale = 1.0;          ///< true noise in units of the nominal one
  double outlier_share = 0.0;  ///< of ranges with five times the noise
  int pings = 60;              ///< a full turn
  double half_angle = radians(15.0);
  double max_range = 4.0;
  Pose2 mount;  ///< axis of rotation in the base; its yaw is the first ping's axis
};

/// First echo of the object: heard with probability 0.98 exp(-2 (a / half)^2), 0.3 times that for an edge.
inline UltrasonicScan scan(const Object& object, const Pose2& base, const Ranger& ranger, std::int64_t seq, Rng& rng) {
  UltrasonicScan s{{1000000 * seq, seq}, ranger.half_angle, 0.02, ranger.max_range, {}};
  for (int i = 0; i < ranger.pings; ++i) {
    UltrasonicBeam beam;
    beam.sensor_in_base = ranger.mount * Pose2{0.0, 0.0, kTwoPi * i / ranger.pings};
    const Pose2 sensor = base * beam.sensor_in_base;
    const auto echo = object.echo(sensor.position());
    const double off = std::abs(wrap(echo.direction - sensor.yaw));
    const double share = object.kind == Kind::edge ? 0.3 : 1.0;
    const double heard = rng.uniform(), tail = rng.uniform(), noise = rng.normal();
    if (off <= ranger.half_angle && heard < share * 0.98 * std::exp(-2.0 * std::pow(off / ranger.half_angle, 2))) {
      const double sd = ranger.scale * ranger.noise.sd(echo.range) * (tail < ranger.outlier_share ? 5.0 : 1.0);
      beam.range = echo.range + sd * noise;
      if (beam.range > s.min_range && beam.range < s.max_range)
        beam.echo = Echo::hit;
      else
        beam.range = 0.0;
    }
    s.beams.push_back(beam);
  }
  return s;
}

/// A straight drive: the odometry reports the steps as planned, the truth strays from it.
struct Drive {
  std::vector<MovedScan> scans;
  Pose2 last;  ///< true base at the last scan, in the world
};
inline Drive drive(const Object& object, int stops, double length, const Ranger& ranger,
                   const models::OdometryNoise& odometry, Rng& rng) {
  Drive d;
  const double step = stops > 1 ? length / (stops - 1) : 0.0;
  const Matrix3 covariance = odometry.straight(step);
  const Matrix3 root = square_root<3>(covariance);
  d.last = {-0.5 * length, 0.0, 0.0};
  for (int k = 0; k < stops; ++k) {
    const Pose2 planned{k == 0 ? 0.0 : step, 0.0, 0.0};
    if (k > 0) {
      const Vector3 error = sample_gaussian<3>(root, rng);
      d.last = d.last * Pose2{planned.x + error[0], planned.y + error[1], planned.yaw + error[2]};
    }
    d.scans.push_back({{planned, k == 0 ? Matrix3::Zero() : covariance}, scan(object, d.last, ranger, k, rng)});
  }
  return d;
}

/// An object whose nearest surface is `range` from the middle of the drive, at right angles to it within `spread`.
inline Object place(Kind kind, double range, double spread, Rng& rng) {
  Object o;
  o.kind = kind;
  const double direction = 0.5 * kPi + rng.uniform(-spread, spread);
  const double radius = kind == Kind::cylinder ? rng.uniform(0.10, 0.15) : 0.0;
  o.wall = {range, direction};
  o.cylinder = {(range + radius) * o.wall.normal(), radius};
  return o;
}

}  // namespace noctule::sensors::scene
