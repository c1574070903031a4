#pragma once
/// Range from where a thing stands on the floor.
#include <optional>

#include "core/parameters.hpp"
#include "sensors/camera/landmark_detector.hpp"

namespace noctule::sensors {

/// What is uncertain about a contact with the floor.
struct GroundParameters {
  double pixel_sd = 1.0;           ///< of the contact's place in the image [pixels]
  double pitch_sd = radians(0.5);  ///< of the camera, as the base sways [rad]
  double height_sd = 0.005;        ///< of the camera over the floor [m]
  double max_range = 5.0;          ///< farther contacts are left out [m]

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = GroundParameters;
    v.field("pixel_sd", &P::pixel_sd, unit::one, "sd of a contact's place in the image, in pixels", positive());
    v.field("pitch_sd_deg", &P::pitch_sd, unit::degree, "sd of the camera's pitch as the base sways", at_least(0.0));
    v.field("height_sd_cm", &P::height_sd, unit::centimetre, "sd of the camera's height over the floor", at_least(0.0));
    v.field("max_range_m", &P::max_range, unit::metre, "farther contacts are left out", positive());
  }
};

/// Sighting of a point of the floor that is seen at a pixel; nothing at and above the horizon, and beyond the largest
/// range. Range and bearing with their covariance, without identity.
[[nodiscard]] std::optional<LandmarkDetection> ground_contact(const models::CameraIntrinsics& camera,
                                                              const models::CameraMounting& mounting,
                                                              const Vector2& pixel, const GroundParameters& parameters);

}  // namespace noctule::sensors
