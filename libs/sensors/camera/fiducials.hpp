#pragma once
/// Square markers of the ArUco and AprilTag families.
#include <memory>

#include "core/parameters.hpp"
#include "sensors/camera/landmark_detector.hpp"

namespace noctule::sensors {

enum class MarkerFamily {
  aruco_4x4_50,
  aruco_5x5_100,
  aruco_6x6_250,
  aruco_7x7_1000,
  aruco_original,
  april_16h5,
  april_25h9,
  april_36h10,
  april_36h11
};

struct FiducialParameters {
  MarkerFamily family = MarkerFamily::april_36h11;
  double side = 0.16;            ///< of the black square [m]
  std::int64_t first_id = 0;     ///< identity of marker 0
  double min_side_px = 14.0;     ///< smaller pictures of a marker are left out
  double min_correlation = 0.8;  ///< of the marker's picture with the image

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = FiducialParameters;
    v.choice("family", &P::family,
             {{"aruco_4x4_50", MarkerFamily::aruco_4x4_50},
              {"aruco_5x5_100", MarkerFamily::aruco_5x5_100},
              {"aruco_6x6_250", MarkerFamily::aruco_6x6_250},
              {"aruco_7x7_1000", MarkerFamily::aruco_7x7_1000},
              {"aruco_original", MarkerFamily::aruco_original},
              {"april_16h5", MarkerFamily::april_16h5},
              {"april_25h9", MarkerFamily::april_25h9},
              {"april_36h10", MarkerFamily::april_36h10},
              {"april_36h11", MarkerFamily::april_36h11}},
             "dictionary of the markers");
    v.field("side_cm", &P::side, unit::centimetre, "side of the black square", positive());
    v.field("first_id", &P::first_id, unit::one, "identity of marker 0 as a landmark; marker n is n more", at_least(0));
    v.field("min_side_px", &P::min_side_px, unit::one, "smaller pictures of a marker are left out", at_least(8.0));
    v.field("min_correlation", &P::min_correlation, unit::one,
            "least correlation of the marker's picture with the image, once aligned", between(0.0, 1.0));
  }
};

/// Markers found and read by OpenCV's aruco, then aligned with the image pixel by pixel (planar_alignment.hpp). The
/// landmark is the middle of the marker.
[[nodiscard]] std::unique_ptr<LandmarkDetector> make_fiducial_detector(const FiducialParameters& parameters,
                                                                       const models::CameraIntrinsics& camera,
                                                                       const models::CameraMounting& mounting);

}  // namespace noctule::sensors
