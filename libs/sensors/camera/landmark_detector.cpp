#include "sensors/camera/landmark_detector.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "core/check.hpp"
#include "core/error.hpp"
#include "sensors/camera/opencv.hpp"

namespace noctule::sensors {
namespace {

/// Luminance by Rec. 601, in the integer arithmetic of 14 bits that OpenCV uses too.
void to_grey(const Image& image, Image& grey) {
  grey.width = image.width;
  grey.height = image.height;
  grey.channels = 1;
  if (image.channels == 1) {
    grey.pixels = image.pixels;
    return;
  }
  const std::size_t n = image.pixels.size() / 3;
  grey.pixels.resize(n);
  const std::uint8_t* p = image.pixels.data();
  for (std::size_t i = 0; i < n; ++i, p += 3)
    grey.pixels[i] = static_cast<std::uint8_t>((p[0] * 1868 + p[1] * 9617 + p[2] * 4899 + 8192) >> 14);
}

bool usable(const LandmarkDetection& d) {
  if (!std::isfinite(d.range) || !std::isfinite(d.bearing) || !d.covariance.allFinite() || !std::isfinite(d.score))
    return false;
  if (d.kind == DetectionKind::bearing_only) return d.covariance(1, 1) > 0.0;
  return d.range > 0.0 && d.covariance(0, 0) > 0.0 && d.covariance.determinant() > 0.0;
}

}  // namespace

cv::Mat as_mat(const Image& image) {
  return {image.height, image.width, image.channels == 3 ? CV_8UC3 : CV_8UC1,
          const_cast<std::uint8_t*>(image.pixels.data())};
}

LandmarkDetector::LandmarkDetector(const models::CameraIntrinsics& camera, const models::CameraMounting& mounting)
    : camera_(camera), mounting_(mounting) {
  require_sound(camera, "camera");
  require_sound(mounting, "mounting");
}

LandmarkDetections LandmarkDetector::detect(const CameraImage& image, std::span<const LandmarkPrediction> expected) {
  outlines_.clear();
  found_.clear();
  if (!image.image.consistent() || image.image.width != camera_.width || image.image.height != camera_.height) {
    throw InputError("image " + std::to_string(image.stamp.seq) + ": expected " + std::to_string(camera_.width) +
                     " x " + std::to_string(camera_.height) + " pixels of 1 or 3 bytes, got " +
                     std::to_string(image.image.width) + " x " + std::to_string(image.image.height) + " in " +
                     std::to_string(image.image.pixels.size()) + " bytes");
  }
  to_grey(image.image, grey_);
  try {
    find(image, grey_, expected, found_);
  } catch (const cv::Exception& e) {
    throw InputError("image " + std::to_string(image.stamp.seq) + ": OpenCV fails on it (" + e.err + ")");
  }

  LandmarkDetections result{image.stamp, mounting_.sensor_in_base(), {}};
  for (CameraFinding& f : found_) {
    if (!usable(f.detection)) continue;
    result.detections.push_back(f.detection);
    outlines_.push_back(std::move(f.outline));
  }
  return result;
}

LandmarkDetection plane_sighting(const models::CameraMounting& mounting, const Vector3& point,
                                 const Matrix3& covariance) {
  const Eigen::Isometry3d optical_in_base = mounting.optical_in_base();
  const Eigen::Matrix<double, 2, 3> plane = optical_in_base.linear().topRows<2>();
  const Vector2 d = plane * point;
  const double r2 = d.squaredNorm();

  LandmarkDetection sighting;
  sighting.range = std::sqrt(r2);
  sighting.bearing = wrap(std::atan2(d.y(), d.x()) - mounting.yaw);
  Matrix2 by_plane;
  by_plane << d.x() / sighting.range, d.y() / sighting.range, -d.y() / r2, d.x() / r2;
  const Eigen::Matrix<double, 2, 3> by_point = by_plane * plane;
  const Matrix2 c = by_point * covariance * by_point.transpose();
  sighting.covariance = 0.5 * (c + c.transpose());
  return sighting;
}

Vector3 point_of_sighting(const models::CameraMounting& mounting, double range, double bearing, double height) {
  const double direction = mounting.yaw + bearing;
  const Vector3 in_base(mounting.position.x() + range * std::cos(direction),
                        mounting.position.y() + range * std::sin(direction), height);
  return mounting.optical_in_base().inverse() * in_base;
}

}  // namespace noctule::sensors
