#pragma once
/// Calibration files of ROS (camera_calibration_parsers), of the model plumb_bob.
#include <string>
#include <vector>

#include "models/camera.hpp"

namespace noctule::models {

/// A matrix, row by row.
struct RosMatrix {
  int rows = 0, cols = 0;
  std::vector<double> data;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("rows", &RosMatrix::rows, unit::one, "rows", between(0, 16));
    v.field("cols", &RosMatrix::cols, unit::one, "columns", between(0, 16));
    v.field("data", &RosMatrix::data, unit::one, "elements, row by row");
  }
};

struct RosCameraInfo {
  int image_width = 0, image_height = 0;
  std::string camera_name;
  std::string distortion_model = "plumb_bob";
  RosMatrix camera_matrix, distortion_coefficients;
  RosMatrix rectification_matrix, projection_matrix;  ///< of a stereo pair; not used

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = RosCameraInfo;
    v.field("image_width", &P::image_width, unit::one, "pixels", between(8, 16384));
    v.field("image_height", &P::image_height, unit::one, "pixels", between(8, 16384));
    v.field("camera_name", &P::camera_name, "name of the camera");
    v.field("distortion_model", &P::distortion_model, "plumb_bob");
    v.group("camera_matrix", &P::camera_matrix, "3 x 3");
    v.group("distortion_coefficients", &P::distortion_coefficients, "k1, k2, p1, p2 and k3");
    v.group("rectification_matrix", &P::rectification_matrix, "3 x 3, not used");
    v.group("projection_matrix", &P::projection_matrix, "3 x 4, not used");
  }
  /// Empty when it is a pinhole camera with at most five coefficients.
  [[nodiscard]] std::string validate() const {
    const auto& k = camera_matrix.data;
    const std::size_t n = distortion_coefficients.data.size();
    if (distortion_model != "plumb_bob") return "distortion_model: expected plumb_bob, got " + distortion_model;
    if (k.size() != 9 || k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0 || !(k[0] > 0.0) ||
        !(k[4] > 0.0))
      return "camera_matrix: data: expected fx, 0, cx, 0, fy, cy, 0, 0, 1";
    if (n != 0 && n != 4 && n != 5)
      return "distortion_coefficients: data: expected 4 or 5 numbers, got " + std::to_string(n);
    return "";
  }

  /// Of a file that validate() found sound.
  [[nodiscard]] CameraIntrinsics intrinsics() const {
    const auto& k = camera_matrix.data;
    std::vector<double> d = distortion_coefficients.data;
    d.resize(5, 0.0);
    return {image_width, image_height, k[0], k[4], k[2], k[5], d[0], d[1], d[2], d[3], d[4]};
  }
};

}  // namespace noctule::models
