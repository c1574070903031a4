#pragma once
/// Sonar echoes in the map frame, the raw material of contour mapping.
#include <array>
#include <span>
#include <vector>

#include "core/observations.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::mapping {

/// A scan and where the base was when it was taken.
struct PosedScan {
  UltrasonicScan scan;
  Pose2 base_in_map;
};

/// One echo: the surface touches the circle of radius `range` about `sensor`, somewhere within `half_angle` of `axis`.
struct SonarArc {
  Vector2 sensor = Vector2::Zero();  ///< [m], map frame
  Vector2 axis = Vector2::UnitX();   ///< unit vector, map frame
  double range = 0.0;                ///< [m]
  double sigma = 0.0;                ///< standard deviation of the range [m]
  double half_angle = 0.0;           ///< of the cone [rad]
  int stop = 0;                      ///< readings of one stop share the error of its pose
};

/// How noisy the ranger is just now, in units of its nominal sd, learned from pings whose cones overlap: at one stop
/// they mostly touch the same surface and then differ by noise alone, whatever the pose and the map.
class NoiseScale {
 public:
  explicit NoiseScale(double largest) : largest_(largest) {}

  /// Takes two ranges of overlapping cones of one scan; `sigma` is the nominal sd [m].
  void observe(double range, double neighbour, double sigma);
  /// 1 until enough pairs were seen; never below 1, never above `largest`.
  [[nodiscard]] double value() const;

 private:
  static constexpr std::size_t kWindow = 64;  // pairs, the latest
  double largest_;
  std::array<double, kWindow> differences_{};
  std::size_t seen_ = 0;
};

/// \throws InputError, naming scan and beam, when the pose, the cone or a hit is not finite, or not positive where it
///         must be
void check(const UltrasonicScan& scan, const Pose2& base_in_map);

/// Turns posed scans into arcs, numbers the stops and sets the noise: scans taken within a small distance of each other
/// are one stop.
class ArcReader {
 public:
  /// \param stop_distance [m] the base must move to count as at another stop
  /// \param largest_scale of the noise that is believed, 1: the nominal noise always
  ArcReader(const models::RangeNoise& noise, double stop_distance, double largest_scale)
      : noise_(noise), stop_distance_(stop_distance), scale_(largest_scale) {}

  /// Appends one arc for each Echo::hit of the scan.
  /// \throws InputError as check(); nothing is appended then
  void read(const UltrasonicScan& scan, const Pose2& base_in_map, std::vector<SonarArc>& arcs);

 private:
  models::RangeNoise noise_;
  double stop_distance_;
  NoiseScale scale_;
  int stop_ = -1;
  Vector2 stop_position_ = Vector2::Zero();
};

/// The naive map: every echo on the axis of its cone, p + r (cos a, sin a) in the map frame [m]. It bends walls towards
/// the robot, by up to r (1 - cos half_angle); kept for comparison.
/// \throws InputError as check()
[[nodiscard]] std::vector<Vector2> direct_points(std::span<const PosedScan> scans);

}  // namespace noctule::mapping
