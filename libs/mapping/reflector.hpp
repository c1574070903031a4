#pragma once
/// A wall, cylinder or point prepared for many arcs: its sines are computed once, and directions are unit vectors
/// instead of angles (models/ultrasonic.hpp says the same for one echo at a time).
#include <cmath>

#include "core/features.hpp"

namespace noctule::mapping {

class Reflector {
 public:
  explicit Reflector(const Wall& w)
      : type_(ContourType::wall), offset_(w.rho), theta_(wrap(w.theta)), vector_(w.normal()) {}
  explicit Reflector(const Cylinder& c)
      : type_(c.radius > 0.0 ? ContourType::arc : ContourType::point), offset_(c.radius), vector_(c.centre) {}

  [[nodiscard]] ContourType type() const { return type_; }
  [[nodiscard]] bool is_wall() const { return type_ == ContourType::wall; }
  [[nodiscard]] int dimension() const { return type_ == ContourType::arc ? 3 : 2; }
  [[nodiscard]] Wall wall() const { return {offset_, theta_}; }
  [[nodiscard]] Cylinder cylinder() const { return {vector_, offset_}; }
  /// Along a wall; a matter of convention for the others.
  [[nodiscard]] Vector2 tangent() const { return {-vector_.y(), vector_.x()}; }

  /// What a sensor at `p` [m] gets: the range [m] (negative behind a wall or inside a cylinder) and the direction of
  /// the echo, a unit vector.
  struct Sight {
    double range;
    Vector2 direction;
  };
  [[nodiscard]] Sight sight(const Vector2& p) const {
    if (is_wall()) return {offset_ - vector_.dot(p), vector_};
    const Vector2 d = vector_ - p;
    const double length = std::max(d.norm(), 1e-9);
    return {length - offset_, d / length};
  }

  /// d range / d (rho, theta, 0), (x, y, radius) or (x, y, 0).
  [[nodiscard]] Vector3 gradient(const Vector2& p, const Sight& s) const {
    if (is_wall()) return {1.0, vector_.y() * p.x() - vector_.x() * p.y(), 0.0};
    return {s.direction.x(), s.direction.y(), type_ == ContourType::arc ? -1.0 : 0.0};
  }

  /// The reflector with `step` added to its parameters; a radius stays >= 0, a point a point.
  [[nodiscard]] Reflector moved(const Vector3& step) const {
    if (is_wall()) return Reflector(Wall{offset_ + step[0], theta_ + step[1]});
    Reflector r = *this;
    r.vector_ += step.head<2>();
    if (type_ == ContourType::arc) r.offset_ = std::max(0.0, offset_ + step[2]);
    return r;
  }

 private:
  ContourType type_;
  double offset_;       // rho or radius
  double theta_ = 0.0;  // of a wall
  Vector2 vector_;      // normal or centre
};

}  // namespace noctule::mapping
