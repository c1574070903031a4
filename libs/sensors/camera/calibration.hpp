#pragma once
/// The camera's lens from pictures of a chessboard.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "core/parameters.hpp"
#include "models/camera.hpp"

namespace noctule::sensors {

struct ChessboardParameters {
  int columns = 9;        ///< inner corners along a row
  int rows = 6;           ///< inner corners along a column
  double square = 0.025;  ///< side of a square [m]
  bool third_radial = true;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = ChessboardParameters;
    v.field("columns", &P::columns, unit::one, "inner corners along a row", between(3, 50));
    v.field("rows", &P::rows, unit::one, "inner corners along a column", between(3, 50));
    v.field("square_cm", &P::square, unit::centimetre, "side of a square", positive());
    v.field("third_radial", &P::third_radial, "whether k3 is estimated too; false: 0");
  }
};

struct CameraCalibration {
  models::CameraIntrinsics camera;
  Eigen::Matrix<double, 9, 1> sd;  ///< of fx, fy, cx, cy, k1, k2, p1, p2, k3
  double rms = 0.0;                ///< of what is left over per corner [pixels]
  std::vector<double> image_rms;   ///< of each picture; below 0: no board was found [pixels]
};

/// Zhang's method (2000) on the board's inner corners to a fraction of a pixel, by OpenCV.
/// \throws InputError on pictures of different sizes, or fewer than three with the whole board
[[nodiscard]] CameraCalibration calibrate_camera(std::span<const Image> images, const ChessboardParameters& board);

}  // namespace noctule::sensors
