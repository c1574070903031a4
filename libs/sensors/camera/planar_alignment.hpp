#pragma once
/// Where a flat picture of known size stands, from every pixel that shows it: maximum likelihood over the six degrees
/// of freedom, brightness and contrast of the picture, with the covariance that the pixels' noise leaves.
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

struct PlanarAlignment {
  PlanarPose pose;
  Matrix3 covariance = Matrix3::Zero();  ///< of the translation, in the optical frame [m^2]; rotation marginalised
  double correlation = 0.0;              ///< of picture and image over the pixels used, -1 to 1
  double blur_px = 0.0;                  ///< of the image, sd of a Gaussian [pixels]
  double noise = 0.0;                    ///< sd of what is left over per pixel [grey levels]
  int pixels = 0;
};

/// Corners of the picture in the image; nothing where one of them lies behind the camera.
[[nodiscard]] std::optional<std::vector<Vector2>> picture_outline(const models::CameraIntrinsics& camera,
                                                                  const PlanarPicture& picture, const PlanarPose& pose);

/// Pose from the four corners [pixels], in the order of PlanarPicture::corners(): the better of the two that a square
/// seen from afar allows (Collins, Bartoli 2014: infinitesimal plane-based pose estimation), refined.
[[nodiscard]] std::optional<PlanarPose> pose_from_corners(const models::CameraIntrinsics& camera,
                                                          const PlanarPicture& picture,
                                                          const std::vector<Vector2>& corners);

/// Levenberg-Marquardt from a pose that is right to a few pixels. Each pixel (block of pixels where the picture is
/// large) is one measurement of the picture where its ray meets the plane, blurred by a Gaussian whose width is chosen
/// among a few; far residuals count less (Huber). The covariance takes the spread of the residuals as the noise, times
/// what their correlation with their neighbours costs. Nothing where the picture shows too few pixels or no contrast,
/// or the steps lead nowhere.
[[nodiscard]] std::optional<PlanarAlignment> align_planar(const models::CameraIntrinsics& camera, const Image& grey,
                                                          const PlanarPicture& picture, const PlanarPose& start);

}  // namespace noctule::sensors
