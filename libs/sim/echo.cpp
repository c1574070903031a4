#include "sim/echo.hpp"

#include <algorithm>

namespace noctule::sim {
namespace {

constexpr double kEdgeTolerance = radians(1.0);  // an edge less sharp than this is a flat wall

/// One end of the sound's way.
class Transducer {
 public:
  Transducer(const Pose2& pose, double cos_half_angle)
      : position(pose.position()), axis_(std::cos(pose.yaw), std::sin(pose.yaw)), cos_half_angle_(cos_half_angle) {}

  /// Whether the cone holds the direction (of any length but 0), and how far off the axis it is.
  [[nodiscard]] bool covers(const Vector2& direction, double& off_axis) const {
    const double along = axis_.dot(direction);
    if (along <= 0.0 || along < cos_half_angle_ * direction.norm()) return false;
    off_axis = std::abs(std::atan2(axis_.x() * direction.y() - axis_.y() * direction.x(), along));
    return true;
  }

  Vector2 position;

 private:
  Vector2 axis_;
  double cos_half_angle_;
};

}  // namespace

EchoScene::EchoScene(const RoomGeometry& geometry) : geometry_(geometry) {
  for (const WallSegment& w : geometry.walls()) {
    const Vector2 tangent(-w.normal.y(), w.normal.x());
    faces_.push_back({w.normal.dot(w.from), w.normal, tangent, tangent.dot(w.from), tangent.dot(w.to)});
  }
  for (const RoomCylinder& c : geometry.cylinders()) cylinders_.push_back(c.cylinder);
  for (const Corner& c : geometry.corners()) {
    if (std::abs(c.interior_angle - kPi / 2) <= kRightAngleTolerance) right_angles_.push_back(c.position);
    if (c.interior_angle > kPi + kEdgeTolerance) edges_.push_back(c.position);
  }
}

std::size_t EchoScene::size() const {
  return faces_.size() + cylinders_.size() + right_angles_.size() + edges_.size();
}

void EchoScene::find(const Pose2& emitter, const Pose2& receiver, double half_angle,
                     std::vector<EchoPath>& echoes) const {
  const double cos_half_angle = std::cos(half_angle);
  const Transducer out(emitter, cos_half_angle), in(receiver, cos_half_angle);
  const auto first = static_cast<std::ptrdiff_t>(echoes.size());
  // `visible` stands for `target` where that is beyond the end of its wall, within the tolerance.
  const auto add = [&](double range, const Vector2& target, const Vector2& visible, bool diffracted) {
    EchoPath echo{range, 0.0, 0.0, diffracted};
    if (!in.covers(target - in.position, echo.received_off)) return;
    if (!out.covers(target - out.position, echo.emitted_off)) return;
    const bool hidden =
        !geometry_.convex() && (!geometry_.sees(out.position, visible) || !geometry_.sees(in.position, visible));
    if (!hidden) echoes.push_back(echo);
  };

  for (const Face& f : faces_) {
    const double from = f.rho - f.normal.dot(out.position), to = f.rho - f.normal.dot(in.position);
    if (from <= 0.0 || to <= 0.0) continue;
    const Vector2 image = out.position + 2.0 * from * f.normal;
    const Vector2 foot = in.position + to / (from + to) * (image - in.position);
    const double along = f.tangent.dot(foot);
    const double on_wall = std::clamp(along, f.begin, f.end);
    if (std::abs(along - on_wall) > kFootTolerance) continue;
    add(0.5 * (image - in.position).norm(), foot, foot + (on_wall - along) * f.tangent, false);
  }
  for (const Cylinder& c : cylinders_) {
    const Vector2 middle = 0.5 * (out.position + in.position);
    const double distance = (c.centre - middle).norm();
    if (distance <= c.radius) continue;
    const Vector2 nearest = c.centre - c.radius / distance * (c.centre - middle);
    add(0.5 * ((nearest - out.position).norm() + (nearest - in.position).norm()), nearest, nearest, false);
  }
  for (const Vector2& corner : right_angles_) {
    const Vector2 image = 2.0 * corner - out.position;
    add(0.5 * (image - in.position).norm(), corner, corner, false);
  }
  for (const Vector2& edge : edges_) {
    add(0.5 * ((edge - out.position).norm() + (edge - in.position).norm()), edge, edge, true);
  }
  std::sort(echoes.begin() + first, echoes.end(),
            [](const EchoPath& a, const EchoPath& b) { return a.range < b.range; });
}

}  // namespace noctule::sim
