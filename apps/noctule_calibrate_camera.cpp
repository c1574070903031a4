/// Calibrates a camera from pictures of a chessboard, or takes a calibration file of ROS over.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "apps/common/command_line.hpp"
#include "config/config.hpp"
#include "core/error.hpp"
#include "datasets/images.hpp"
#include "models/ros_camera_info.hpp"
#include "report/files.hpp"
#include "sensors/camera/calibration.hpp"

namespace {

using namespace noctule;

/// "9x6".
void parse_board(const std::string& text, sensors::ChessboardParameters& board) {
  int used = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &board.columns, &board.rows, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size())
    throw InputError("--board: expected inner corners as COLUMNSxROWS, like 9x6, got '" + text + "'");
}

std::string calibrate(const std::vector<std::string>& files, const sensors::ChessboardParameters& board) {
  std::vector<Image> images;
  for (const std::string& file : files) images.push_back(datasets::read_image(file));
  const sensors::CameraCalibration c = sensors::calibrate_camera(images, board);
  int used = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (c.image_rms[i] < 0.0) {
      std::fprintf(stderr, "%s: no whole board, left out\n", files[i].c_str());
    } else {
      ++used;
      std::fprintf(stderr, "%s: rms %.3f pixels\n", files[i].c_str(), c.image_rms[i]);
    }
  }
  char line[240];
  std::snprintf(line, sizeof(line),
                "# Calibrated from %d pictures of a chessboard, rms %.3f pixels; sd of fx %.2g, fy %.2g, cx %.2g, cy "
                "%.2g pixels, of k1 %.2g.\n",
                used, c.rms, c.sd[0], c.sd[1], c.sd[2], c.sd[3], c.sd[4]);
  return line + config::dump(c.camera);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Calibrates a camera from pictures of a chessboard; writes the intrinsics of a camera's YAML.",
               "noctule-calibrate-camera");
  app.set_version_flag("--version", apps::version());
  std::vector<std::string> files;
  std::string board_text = "9x6", out = "-", ros;
  double square = 2.5;
  bool no_k3 = false;
  app.add_option("pictures", files, "pictures of the board, all of one size");
  app.add_option("--board", board_text, "inner corners of the board, COLUMNSxROWS")->capture_default_str();
  app.add_option("--square_cm", square, "side of a square")->capture_default_str();
  app.add_flag("--no-k3", no_k3, "leave the third radial coefficient 0");
  app.add_option("--ros", ros, "take this camera_info YAML of ROS over instead");
  app.add_option("--out", out, "file to write; -: the terminal")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  return apps::run_guarded("noctule-calibrate-camera", [&] {
    if (ros.empty() == files.empty())
      throw InputError("expected either pictures of a chessboard or --ros FILE; see --help");
    std::string text;
    if (!ros.empty()) {
      text = "# From " + ros + ".\n" + config::dump(config::load<models::RosCameraInfo>(ros).intrinsics());
    } else {
      sensors::ChessboardParameters board{.square = 0.01 * square, .third_radial = !no_k3};
      parse_board(board_text, board);
      text = calibrate(files, board);
    }
    if (out == "-") {
      std::cout << text;
    } else {
      report::write_file(out, text);
    }
    return 0;
  });
}
