#pragma once
/// Where a flat picture of known size stands, from every pixel that shows it: maximum likelihood over the six degrees
/// of freedom, brightness and contrast of the picture, with the covariance that the pixels' noise leaves.
#include <optional>

#include "sensors/camera/planar_picture.hpp"

namespace noctule::sensors {

struct PlanarAlignment {
  PlanarPose pose;
  Matrix3 covariance = Matrix3::Zero();  ///< of the translation, in the optical frame [m^2]; rotation marginalised
  double correlation = 0.0;              ///< of picture and image over the pixels used, -1 to 1
  double blur_px = 0.0;                  ///< of the image, sd of a Gaussian [pixels]
  double noise = 0.0;                    ///< sd of what is left over per pixel [grey levels]
  double structure = 0.0;                ///< share of the variance left over that neighbouring pixels have in common
  int pixels = 0;
};

/// Levenberg-Marquardt from a pose that is right to a few pixels. Each pixel (block of pixels where the picture is
/// large) is one measurement of the picture where its ray meets the plane, blurred by a Gaussian whose width is chosen
/// among a few; far residuals count less (Huber). The covariance takes the spread of the residuals as the noise, times
/// what their correlation with their neighbours costs. Where they go together, starts with other tilts are tried.
/// Nothing where the picture shows too few pixels or no contrast, or the steps lead nowhere.
[[nodiscard]] std::optional<PlanarAlignment> align_planar(const models::CameraIntrinsics& camera, const Image& grey,
                                                          const PlanarPicture& picture, const PlanarPose& start);

}  // namespace noctule::sensors
