#pragma once
/// Flat pictures of known size and where they stand.
#include <array>
#include <optional>
#include <vector>

#include "core/image.hpp"
#include "core/pose2.hpp"
#include "models/camera.hpp"

namespace noctule::sensors {

/// The picture in its own frame: origin in the middle, x along its rows, y down its columns [m], z away from who looks
/// at its front.
struct PlanarPicture {
  Image grey;
  double width = 0.0;   ///< [m]
  double height = 0.0;  ///< [m]

  /// Top left, top right, bottom right, bottom left [m].
  [[nodiscard]] std::array<Vector3, 4> corners() const;
};

/// The picture's frame in the optical frame.
struct PlanarPose {
  Matrix3 rotation = Matrix3::Identity();
  Vector3 translation = Vector3::Zero();  ///< of the middle [m]
};

/// Corners of the picture in the image; nothing where one of them lies behind the camera.
[[nodiscard]] std::optional<std::vector<Vector2>> picture_outline(const models::CameraIntrinsics& camera,
                                                                  const PlanarPicture& picture, const PlanarPose& pose);

/// Pose from the four corners [pixels], in the order of PlanarPicture::corners(): the better of the two that a square
/// seen from afar allows (Collins, Bartoli 2014: infinitesimal plane-based pose estimation), refined.
[[nodiscard]] std::optional<PlanarPose> pose_from_corners(const models::CameraIntrinsics& camera,
                                                          const PlanarPicture& picture,
                                                          const std::vector<Vector2>& corners);

}  // namespace noctule::sensors
