#pragma once
/// Pinhole camera with radial and tangential lens distortion (the "plumb_bob" model of ROS, OpenCV's five
/// coefficients), and how it sits on the robot.
#include <Eigen/Geometry>
#include <optional>

#include "core/parameters.hpp"
#include "core/pose2.hpp"

namespace noctule::models {

/// Points of the optical frame: z forward along the axis, x to the right, y down [m] (REP-103). Pixels (u, v): u to the
/// right, v down, (0, 0) at the middle of the first pixel.
struct CameraIntrinsics {
  int width = 640;                                        ///< [pixels]
  int height = 480;                                       ///< [pixels]
  double fx = 500.0, fy = 500.0, cx = 319.5, cy = 239.5;  ///< [pixels]
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = CameraIntrinsics;
    v.field("width", &P::width, unit::one, "width of the image in pixels", between(8, 16384));
    v.field("height", &P::height, unit::one, "height of the image in pixels", between(8, 16384));
    v.field("fx", &P::fx, unit::one, "focal length in pixels, along a row", positive());
    v.field("fy", &P::fy, unit::one, "focal length in pixels, along a column", positive());
    v.field("cx", &P::cx, unit::one, "column of the optical axis");
    v.field("cy", &P::cy, unit::one, "row of the optical axis");
    v.field("k1", &P::k1, unit::one, "radial distortion, of r^2");
    v.field("k2", &P::k2, unit::one, "radial distortion, of r^4");
    v.field("p1", &P::p1, unit::one, "tangential distortion");
    v.field("p2", &P::p2, unit::one, "tangential distortion");
    v.field("k3", &P::k3, unit::one, "radial distortion, of r^6");
  }
};

/// Where the camera sits on the robot. With roll = pitch = yaw = 0 it looks forward, its image upright.
struct CameraMounting {
  Vector2 position = Vector2::Zero();         ///< of the optical centre in base_link [m]
  double height = 0.3;                        ///< of the optical centre over the floor [m]
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  ///< [rad], REP-103: pitch > 0 looks down, yaw > 0 looks left

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = CameraMounting;
    v.field("position_cm", &P::position, unit::centimetre, "optical centre in base_link (x forward, y left)");
    v.field("height_cm", &P::height, unit::centimetre, "optical centre over the floor", positive());
    v.field("roll_deg", &P::roll, unit::degree, "rotation about the forward axis", between(-180, 180));
    v.field("pitch_deg", &P::pitch, unit::degree, "above 0 looks down", between(-90, 90));
    v.field("yaw_deg", &P::yaw, unit::degree, "above 0 looks left", between(-180, 180));
  }

  /// Optical frame in base_link; the floor is z = 0.
  [[nodiscard]] Eigen::Isometry3d optical_in_base() const;
  /// Sensor of the sightings: the camera's place and heading in the plane.
  [[nodiscard]] Pose2 sensor_in_base() const { return {position.x(), position.y(), yaw}; }
};

/// Pixel of a ray, with its derivative.
struct CameraProjection {
  Vector2 pixel;
  Eigen::Matrix<double, 2, 3> by_point;  ///< [pixels per metre]
};

/// Pixel of a point of the optical frame; nothing at and behind the camera (z < 1e-6 m). The pixel may lie outside the
/// image.
[[nodiscard]] std::optional<CameraProjection> project(const CameraIntrinsics& camera, const Vector3& point);

/// Ray (x/z, y/z) through a pixel, its derivative by the pixel.
struct CameraRay {
  Vector2 direction;
  Matrix2 by_pixel;
};
/// Undoes the distortion by Newton steps to 1e-12; nothing where the lens model folds and no ray leads to the pixel.
[[nodiscard]] std::optional<CameraRay> unproject(const CameraIntrinsics& camera, const Vector2& pixel);

}  // namespace noctule::models
