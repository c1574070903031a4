#pragma once
/// Which surfaces of a room answer a ping, by the specular first-echo rule: a smooth surface is heard only along its
/// own normal, wherever in the cone that lies.
#include <vector>

#include "sim/room_geometry.hpp"

namespace noctule::sim {

/// The way of the sound to a surface that answers, heard or not, and back.
struct EchoPath {
  double range = 0.0;         ///< half the way of the sound [m]
  double emitted_off = 0.0;   ///< angle from the emitter's axis to where the sound leaves [rad], >= 0
  double received_off = 0.0;  ///< angle from the receiver's axis to where it comes from [rad], >= 0
  bool diffracted = false;    ///< by an edge, which is weak
};

class EchoScene {
 public:
  explicit EchoScene(const RoomGeometry&);

  /// Everything that reflects sound of the emitter into the receiver, both cones of `half_angle`, nearest first,
  /// appended to `echoes`. Poses in the map; give the same pose twice for a ranger that hears itself:
  /// - wall: at the foot of the perpendicular, which must lie on the wall (kFootTolerance);
  /// - cylinder: at its nearest point (for two rangers: nearest to the middle between them, which is not exactly
  ///   specular but longer by less than their distance squared over the range);
  /// - corner of 90 degrees (kRightAngleTolerance): bounces twice and returns parallel to itself;
  /// - edge that juts into the room: diffraction.
  /// Walls hide what is behind them; cylinders do not, they only come first.
  /// No allocation while `echoes` has room for size() more.
  void find(const Pose2& emitter, const Pose2& receiver, double half_angle, std::vector<EchoPath>& echoes) const;
  /// Greatest number of echoes of one call.
  [[nodiscard]] std::size_t size() const;

  static constexpr double kFootTolerance = 0.005;  // [m]
  static constexpr double kRightAngleTolerance = radians(5.0);

 private:
  struct Face {
    double rho;  // of the outward normal: negative where the origin lies behind the wall
    Vector2 normal;
    Vector2 tangent;
    double begin;  // along the tangent
    double end;
  };

  RoomGeometry geometry_;
  std::vector<Face> faces_;
  std::vector<Cylinder> cylinders_;
  std::vector<Vector2> right_angles_;
  std::vector<Vector2> edges_;
};

}  // namespace noctule::sim
