#include "sim/simulator.hpp"

#include <cmath>
#include <utility>

#include "core/check.hpp"
#include "core/gaussian.hpp"
#include "core/rng.hpp"
#include "sim/room_geometry.hpp"
#include "sim/wall_pictures.hpp"

namespace noctule::sim {
namespace {

constexpr double kClockTolerance = 1e-6;  // of the time between two pictures [s]
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
  const RoomGeometry geometry(world.room);
  known_.room = geometry.known_room();
  if (robot.camera) {
    known_.landmarks = known_landmarks(world.room, geometry);
    camera_.emplace(*robot.camera, world.room, seed);
  }
  known_.start_in_map = world.path.start;
  duration_ = scans_due_ * scan_duration_;
  for (const Motion& m : motions_) duration_ += m.duration + (m.stop ? scan_duration_ : 0.0);
}

std::optional<Observation> Simulator::next() {
  if (ready_.empty()) {
    if (scans_due_ > 0) {
      listen();
    } else if (next_motion_ < motions_.size()) {
      move();
    } else {
      return std::nullopt;
    }
  }
  Observation observation = std::move(ready_.front());
  ready_.pop_front();
  return observation;
}

void Simulator::move() {
  const Motion& motion = motions_[next_motion_];
  time_ += motion.duration;
  pose_ = motion.pose;
  scans_due_ = motion.stop ? 1 : 0;
  Rng rng(seed_, kOdometry, next_motion_);
  const Vector3 error = sample_gaussian<3>(square_root<3>(motion.covariance), rng);
  const Pose2& clean = motion.increment;
  ready_.emplace_back(Odometry{{utime(), static_cast<std::int64_t>(next_motion_)},
                               {clean.x + error.x(), clean.y + error.y(), wrap(clean.yaw + error.z())},
                               motion.covariance});
  ++next_motion_;
  ready_.emplace_back(truth());
  if (camera_ && camera_->parameters().rate > 0.0 && time_ >= next_picture_) {
    next_picture_ = time_ + 1.0 / camera_->parameters().rate - kClockTolerance;
    ready_.emplace_back(shoot(&motion));
  }
}

void Simulator::listen() {
  time_ += scan_duration_;
  --scans_due_;
  UltrasonicScan scan = sonar_.scan(pose_, scans_++, models::noise_factor(schedule_, time_ / duration_));
  scan.stamp.utime = utime();
  ready_.emplace_back(truth());
  ready_.emplace_back(std::move(scan));
  if (camera_ && camera_->parameters().rate == 0.0) ready_.emplace_back(shoot(nullptr));
}

/// A picture of now; blurred by the motion that has just ended, if any.
CameraImage Simulator::shoot(const Motion* motion) {
  Pose2 shift;  // of the base in half the exposure
  if (motion != nullptr && motion->duration > 0.0) {
    const double part = 0.5 * camera_->parameters().exposure / motion->duration;
    shift = {part * motion->increment.x, part * motion->increment.y, part * motion->increment.yaw};
  }
  CameraImage image = camera_->shoot(pose_ * Pose2{-shift.x, -shift.y, -shift.yaw}, pose_ * shift, pictures_++, time_);
  image.stamp.utime = utime();
  return image;
}

GroundTruth Simulator::truth() {
  return {{utime(), truths_++}, pose_};
}

std::int64_t Simulator::utime() const {
  return std::llround(1e6 * time_);
}

}  // namespace noctule::sim
