#include "sim/drive.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "core/error.hpp"
#include "models/motion.hpp"
#include "sim/room_geometry.hpp"
#include "sim/steering.hpp"

namespace noctule::sim {
namespace {

constexpr double kNegligible = 1e-9;    // [m] and [rad]: below, there is nothing to drive or to turn
constexpr double kPatience = 20.0;      // a way-point is out of reach when the detour to it is this much longer
constexpr double kLeastPatience = 1.0;  // [m]

/// A motion before its noise is known.
struct Piece {
  Motion motion;
  double length = 0.0;   ///< [m]
  double turning = 0.0;  ///< [rad], >= 0
  std::size_t turn = 0;  ///< number of the turn it belongs to
};

/// Way-points in the order they are visited.
std::vector<Vector2> itinerary(const PathParameters& path) {
  std::vector<Vector2> places;
  for (int loop = 0; loop < path.loops; ++loop) {
    places.insert(places.end(), path.waypoints.begin(), path.waypoints.end());
  }
  return places;
}

/// Drives and records; knows when the next stop is due.
class Recorder {
 public:
  Recorder(const Pose2& start, double spacing) : pose_(start), spacing_(spacing), to_stop_(spacing) {}

  [[nodiscard]] const Pose2& pose() const { return pose_; }
  [[nodiscard]] double to_stop() const { return to_stop_; }
  void next_turn() { ++turn_; }

  void move(const Pose2& to, double length, double duration) {
    to_stop_ -= length;
    const bool stop = to_stop_ < kNegligible;
    if (stop) to_stop_ = spacing_;
    const Pose2 increment = between(pose_, to);
    pieces_.push_back({{duration, to, increment, Matrix3::Zero(), stop}, length, std::abs(increment.yaw), turn_});
    pose_ = to;
  }

  /// The way ends with a stop.
  [[nodiscard]] std::vector<Piece> finish() && {
    if (!pieces_.empty()) pieces_.back().motion.stop = true;
    return std::move(pieces_);
  }

 private:
  Pose2 pose_;
  double spacing_;
  double to_stop_;
  std::size_t turn_ = 0;
  std::vector<Piece> pieces_;
};

/// Divides a motion of the given duration into equal parts at no less than the odometry's rate.
int parts(double duration, double rate) {
  return std::max(1, static_cast<int>(std::ceil(duration * rate - kNegligible)));
}

void turn_on_the_spot(Recorder& recorder, double angle, const DriveParameters& drive) {
  const double duration = std::abs(angle) / drive.turn_rate;
  const int n = parts(duration, drive.odometry_rate);
  const Pose2 begin = recorder.pose();
  for (int i = 1; i <= n; ++i) {
    const double rate = std::copysign(drive.turn_rate, angle);
    recorder.move(models::predict_unicycle(begin, 0.0, rate, duration * i / n).pose, 0.0, duration / n);
  }
}

void go_straight(Recorder& recorder, double length, const DriveParameters& drive) {
  while (length > kNegligible) {
    const double way = std::min(length, recorder.to_stop());
    const double duration = way / drive.speed;
    const int n = parts(duration, drive.odometry_rate);
    const Pose2 begin = recorder.pose();
    for (int i = 1; i <= n; ++i) {
      recorder.move(models::predict_unicycle(begin, drive.speed, 0.0, duration * i / n).pose, way / n, duration / n);
    }
    length -= way;
  }
}

std::vector<Piece> turn_and_go(const PathParameters& path, const DriveParameters& drive) {
  Recorder recorder(path.start, path.stop_spacing);
  for (const Vector2& place : itinerary(path)) {
    const Vector2 way = place - recorder.pose().position();
    if (way.norm() < kNegligible) continue;
    recorder.next_turn();
    const double angle = wrap(std::atan2(way.y(), way.x()) - recorder.pose().yaw);
    if (std::abs(angle) > kNegligible) turn_on_the_spot(recorder, angle, drive);
    go_straight(recorder, way.norm(), drive);
  }
  return std::move(recorder).finish();
}

/// Steers towards each way-point until it is near, with limited steering angle and rate.
std::vector<Piece> steer(const PathParameters& path, const DriveParameters& drive) {
  Recorder recorder(path.start, path.stop_spacing);
  const double dt = 1.0 / drive.odometry_rate;
  double steering = 0.0;
  for (const Vector2& place : itinerary(path)) {
    recorder.next_turn();
    const double distance = (place - recorder.pose().position()).norm();
    double patience = std::max(kLeastPatience, kPatience * distance);
    for (;;) {
      const Pose2& pose = recorder.pose();
      const Vector2 way = place - pose.position();
      if (way.norm() < drive.waypoint_radius) break;
      if (patience < 0.0) {
        std::ostringstream out;
        out << "drive.max_steering_deg: expected steering that reaches way-point (" << 100.0 * place.x() << ", "
            << 100.0 * place.y() << ") cm, got circles of radius "
            << 100.0 * drive.wheelbase / std::sin(drive.max_steering) << " cm that miss it";
        throw InputError(out.str());
      }
      const double step = std::min(dt, recorder.to_stop() / drive.speed);
      steering = steer_towards(place, pose, steering, drive.max_steering, drive.steering_rate, step);
      const double length = drive.speed * step;
      recorder.move(models::predict_front_axle(pose, drive.speed, steering, drive.wheelbase, step).pose, length, step);
      patience -= length;
    }
  }
  return std::move(recorder).finish();
}

/// Covariance of the odometry's error over one piece: along and across its own direction of travel.
Matrix3 covariance(const Piece& piece, const models::OdometryNoise& noise, double step_length, double turn_angle) {
  Matrix3 p = noise.straight(piece.length);
  if (piece.length > 0.0) p(0, 0) *= step_length / piece.length;
  const Pose2& way = piece.motion.increment;
  const Pose2 travel{0.0, 0.0, piece.length > 0.0 ? std::atan2(way.y, way.x) : 0.0};
  const Matrix3 rotate = compose_jacobian_right(travel);
  p = (rotate * p * rotate.transpose()).eval();
  if (turn_angle > kNegligible) p += piece.turning / turn_angle * noise.turn_on_the_spot();
  return p;
}

std::vector<Motion> add_noise(const std::vector<Piece>& pieces, const models::OdometryNoise& noise) {
  std::vector<double> turns(pieces.empty() ? 0 : pieces.back().turn + 1, 0.0);
  for (const Piece& p : pieces) turns[p.turn] += p.turning;
  std::vector<Motion> motions;
  auto begin = pieces.begin();
  while (begin != pieces.end()) {
    const auto end = std::find_if(begin, pieces.end(), [](const Piece& p) { return p.motion.stop; }) + 1;
    const double step = std::accumulate(begin, end, 0.0, [](double sum, const Piece& p) { return sum + p.length; });
    for (; begin != end; ++begin) {
      motions.push_back(begin->motion);
      motions.back().covariance = covariance(*begin, noise, step, turns[begin->turn]);
    }
  }
  return motions;
}

void check_clearance(const std::vector<Motion>& motions, const RoomParameters& room) {
  const RoomGeometry geometry(room);
  for (const Motion& m : motions) {
    const Vector2 p = m.pose.position();
    const Clearance clearance = geometry.clearance(p, p);
    if (geometry.contains(p) && clearance.distance >= kPathClearance) continue;
    std::ostringstream out;
    out << "path.waypoints_cm: expected a way that the drive can follow " << 100.0 * kPathClearance
        << " cm from every obstacle, got (" << 100.0 * p.x() << ", " << 100.0 * p.y() << ") cm, "
        << 100.0 * clearance.distance << " cm from " << clearance.obstacle;
    throw InputError(out.str());
  }
}

}  // namespace

std::vector<Motion> plan_motions(const WorldParameters& world, const RobotParameters& robot) {
  const bool turns = robot.drive.model == DriveModel::turn_and_go;
  const auto motions =
      add_noise(turns ? turn_and_go(world.path, robot.drive) : steer(world.path, robot.drive), robot.odometry);
  check_clearance(motions, world.room);
  return motions;
}

}  // namespace noctule::sim
