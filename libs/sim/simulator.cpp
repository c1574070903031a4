#include "sim/simulator.hpp"

#include <cmath>
#include <utility>

#include "core/check.hpp"
#include "core/gaussian.hpp"
#include "core/rng.hpp"
#include "sim/room_geometry.hpp"

namespace noctule::sim {
namespace {

constexpr std::uint64_t kOdometry = stream_id("odometry");

const WorldParameters& sound(const WorldParameters& world) {
  require_sound(world, "world '" + world.name + "'");
  return world;
}
const RobotParameters& sound(const RobotParameters& robot) {
  require_sound(robot, "robot '" + robot.name + "'");
  return robot;
}

}  // namespace

Simulator::Simulator(const WorldParameters& world, const RobotParameters& robot, std::uint64_t seed)
    : schedule_(sound(robot).sonar.schedule),
      scan_duration_(robot.sonar.scan_duration()),
      seed_(seed),
      motions_(plan_motions(sound(world), robot)),
      sonar_(robot.sonar, RoomGeometry(world.room), seed),
      pose_(world.path.start),
      scans_due_(world.path.scans_at_start) {
  known_.name = world.name;
  known_.room = RoomGeometry(world.room).known_room();
  known_.start_in_map = world.path.start;
  duration_ = scans_due_ * scan_duration_;
  for (const Motion& m : motions_) duration_ += m.duration + (m.stop ? scan_duration_ : 0.0);
}

std::optional<Observation> Simulator::next() {
  if (held_back_) return std::exchange(held_back_, std::nullopt);
  if (scans_due_ > 0) return listen();
  if (next_motion_ < motions_.size()) return move();
  return std::nullopt;
}

Observation Simulator::move() {
  const Motion& motion = motions_[next_motion_];
  time_ += motion.duration;
  pose_ = motion.pose;
  scans_due_ = motion.stop ? 1 : 0;
  Rng rng(seed_, kOdometry, next_motion_);
  const Vector3 error = sample_gaussian<3>(square_root<3>(motion.covariance), rng);
  const Pose2& clean = motion.increment;
  const Odometry odometry{{utime(), static_cast<std::int64_t>(next_motion_)},
                          {clean.x + error.x(), clean.y + error.y(), wrap(clean.yaw + error.z())},
                          motion.covariance};
  ++next_motion_;
  held_back_ = truth();
  return odometry;
}

Observation Simulator::listen() {
  time_ += scan_duration_;
  --scans_due_;
  UltrasonicScan scan = sonar_.scan(pose_, scans_++, models::noise_factor(schedule_, time_ / duration_));
  scan.stamp.utime = utime();
  held_back_ = std::move(scan);
  return truth();
}

GroundTruth Simulator::truth() {
  return {{utime(), truths_++}, pose_};
}

std::int64_t Simulator::utime() const {
  return std::llround(1e6 * time_);
}

}  // namespace noctule::sim
