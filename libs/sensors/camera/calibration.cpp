#include "sensors/camera/calibration.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/check.hpp"
#include "sensors/camera/opencv.hpp"

namespace noctule::sensors {
namespace {

std::optional<std::vector<cv::Point2f>> board_corners(const Image& image, const cv::Size& board) {
  cv::Mat grey = as_mat(image);
  if (image.channels == 3) cv::cvtColor(as_mat(image), grey, cv::COLOR_BGR2GRAY);
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCorners(grey, board, corners)) return std::nullopt;
  // The window must not reach the next corner.
  double nearest = 1e9;
  for (std::size_t i = 1; i < corners.size(); ++i) nearest = std::min(nearest, cv::norm(corners[i] - corners[i - 1]));
  const int half = std::clamp(static_cast<int>(0.4 * nearest), 2, 11);
  constexpr int kSteps = 40;
  constexpr double kTolerance = 1e-3;  // pixels
  cv::cornerSubPix(grey, corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kSteps, kTolerance});
  return corners;
}

}  // namespace

CameraCalibration calibrate_camera(std::span<const Image> images, const ChessboardParameters& board) {
  require_sound(board, "board");
  std::vector<cv::Point3f> flat;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column)
      flat.emplace_back(static_cast<float>(column * board.square), static_cast<float>(row * board.square), 0.0F);
  }
  CameraCalibration result;
  result.image_rms.assign(images.size(), -1.0);
  std::vector<std::vector<cv::Point2f>> seen;
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto size = [](const Image& image) {
      return std::to_string(image.width) + " x " + std::to_string(image.height);
    };
    if (!images[i].consistent())
      throw InputError("picture " + std::to_string(i + 1) + ": expected pixels of 1 or 3 bytes, got " +
                       size(images[i]) + " in " + std::to_string(images[i].pixels.size()) + " bytes");
    if (images[i].width != images[0].width || images[i].height != images[0].height)
      throw InputError("picture " + std::to_string(i + 1) + ": expected " + size(images[0]) +
                       " pixels as in the first, got " + size(images[i]));
    if (auto corners = board_corners(images[i], {board.columns, board.rows})) {
      seen.push_back(std::move(*corners));
      used.push_back(i);
    }
  }
  constexpr std::size_t kFewest = 3;
  if (used.size() < kFewest) {
    throw InputError("chessboard of " + std::to_string(board.columns) + " x " + std::to_string(board.rows) +
                     " inner corners: expected it whole in 3 pictures or more, found it in " +
                     std::to_string(used.size()) + " of " + std::to_string(images.size()));
  }
  const std::vector<std::vector<cv::Point3f>> boards(seen.size(), flat);
  cv::Mat matrix, lens, intrinsic_sd, pose_sd, per_view;
  std::vector<cv::Mat> turns, shifts;
  const int flags = board.third_radial ? 0 : static_cast<int>(cv::CALIB_FIX_K3);
  result.rms = cv::calibrateCamera(boards, seen, {images[0].width, images[0].height}, matrix, lens, turns, shifts,
                                   intrinsic_sd, pose_sd, per_view, flags);
  for (std::size_t i = 0; i < used.size(); ++i) result.image_rms[used[i]] = per_view.at<double>(static_cast<int>(i));
  for (int i = 0; i < 9; ++i) result.sd[i] = intrinsic_sd.at<double>(i);
  models::CameraIntrinsics& c = result.camera;
  c.width = images[0].width;
  c.height = images[0].height;
  c.fx = matrix.at<double>(0, 0);
  c.fy = matrix.at<double>(1, 1);
  c.cx = matrix.at<double>(0, 2);
  c.cy = matrix.at<double>(1, 2);
  const cv::Mat row = lens.reshape(1, 1);
  c.k1 = row.at<double>(0);
  c.k2 = row.at<double>(1);
  c.p1 = row.at<double>(2);
  c.p2 = row.at<double>(3);
  c.k3 = row.at<double>(4);
  require_sound(c, "camera as calibrated");
  return result;
}

}  // namespace noctule::sensors
