#include "convert/check.hpp"
#include "convert/convert.hpp"
#include "core/angles.hpp"

namespace noctule::convert {
namespace {

constexpr std::int32_t kLargestSide = 16384;  // of an image [pixels]
enum class ImageEncoding : std::int8_t { grey = camera_image::ENCODING_GREY, bgr = camera_image::ENCODING_BGR };

ultrasonic_beam to_beam(const UltrasonicBeam& value) {
  const Pose2& sensor = value.sensor_in_base;
  return {sensor.x, sensor.y, sensor.yaw, value.range, static_cast<std::int8_t>(value.echo)};
}

UltrasonicBeam from_beam(const ultrasonic_beam& m, const Check& check) {
  return {check.pose("sensor_x_m", m.sensor_x_m, "sensor_y_m", m.sensor_y_m, "sensor_yaw_rad", m.sensor_yaw_rad),
          check.not_negative("range_m", m.range_m), check.code("echo", m.echo, Echo::invalid)};
}

landmark_detection to_detection(const LandmarkDetection& value) {
  landmark_detection m{};
  m.kind = static_cast<std::int8_t>(value.kind);
  m.range_m = value.range;
  m.bearing_rad = value.bearing;
  fill(m.covariance_range_bearing_m_rad, value.covariance);
  m.id = value.id;
  m.score = value.score;
  return m;
}

LandmarkDetection from_detection(const landmark_detection& m, const Check& check) {
  return {check.code("kind", m.kind, DetectionKind::range_only),
          check.not_negative("range_m", m.range_m),
          check.finite("bearing_rad", m.bearing_rad),
          check.covariance("covariance_range_bearing_m_rad", m.covariance_range_bearing_m_rad),
          m.id,
          check.within("score", m.score, 0.0, 1.0)};
}

}  // namespace

odometry to_message(const Odometry& value) {
  auto m = stamped<odometry>(value.stamp, kBaseFrame);
  m.dx_m = value.increment.x;
  m.dy_m = value.increment.y;
  m.dyaw_rad = value.increment.yaw;
  fill(m.covariance_x_y_yaw_m_rad, value.covariance);
  return m;
}

Odometry from_message(const odometry& m) {
  const Check check("odometry");
  return {check.stamp(m, kBaseFrame), check.pose("dx_m", m.dx_m, "dy_m", m.dy_m, "dyaw_rad", m.dyaw_rad),
          check.covariance("covariance_x_y_yaw_m_rad", m.covariance_x_y_yaw_m_rad)};
}

ultrasonic_scan to_message(const UltrasonicScan& value) {
  auto m = stamped<ultrasonic_scan>(value.stamp, kBaseFrame);
  m.half_angle_rad = value.half_angle;
  m.min_range_m = value.min_range;
  m.max_range_m = value.max_range;
  fill(m.beam_count, m.beams, value.beams, to_beam);
  return m;
}

UltrasonicScan from_message(const ultrasonic_scan& m) {
  const Check check("ultrasonic_scan");
  UltrasonicScan value;
  value.stamp = check.stamp(m, kBaseFrame);
  value.half_angle = check.within("half_angle_rad", m.half_angle_rad, 0.0, kPi);
  value.min_range = check.not_negative("min_range_m", m.min_range_m);
  value.max_range = check.within("max_range_m", m.max_range_m, m.min_range_m, std::numeric_limits<double>::max());
  value.beams = check.list("beam_count", m.beam_count, "beams", m.beams, from_beam);
  return value;
}

landmark_detections to_message(const LandmarkDetections& value) {
  auto m = stamped<landmark_detections>(value.stamp, kBaseFrame);
  m.sensor_x_m = value.sensor_in_base.x;
  m.sensor_y_m = value.sensor_in_base.y;
  m.sensor_yaw_rad = value.sensor_in_base.yaw;
  fill(m.detection_count, m.detections, value.detections, to_detection);
  return m;
}

LandmarkDetections from_message(const landmark_detections& m) {
  const Check check("landmark_detections");
  LandmarkDetections value;
  value.stamp = check.stamp(m, kBaseFrame);
  value.sensor_in_base =
      check.pose("sensor_x_m", m.sensor_x_m, "sensor_y_m", m.sensor_y_m, "sensor_yaw_rad", m.sensor_yaw_rad);
  value.detections = check.list("detection_count", m.detection_count, "detections", m.detections, from_detection);
  return value;
}

ground_truth to_message(const GroundTruth& value) {
  auto m = stamped<ground_truth>(value.stamp, kMapFrame);
  m.x_m = value.base_in_map.x;
  m.y_m = value.base_in_map.y;
  m.yaw_rad = value.base_in_map.yaw;
  return m;
}

GroundTruth from_message(const ground_truth& m) {
  const Check check("ground_truth");
  return {check.stamp(m, kMapFrame), check.pose("x_m", m.x_m, "y_m", m.y_m, "yaw_rad", m.yaw_rad)};
}

camera_image to_message(const CameraImage& value) {
  auto m = stamped<camera_image>(value.stamp, kCameraFrame);
  m.width = value.image.width;
  m.height = value.image.height;
  m.encoding = value.image.channels == 1 ? camera_image::ENCODING_GREY : camera_image::ENCODING_BGR;
  m.byte_count = static_cast<std::int32_t>(value.image.pixels.size());
  m.bytes = value.image.pixels;
  return m;
}

CameraImage from_message(const camera_image& m) {
  const Check check("camera_image");
  const int channels = check.code("encoding", m.encoding, ImageEncoding::bgr) == ImageEncoding::grey ? 1 : 3;
  CameraImage value{check.stamp(m, kCameraFrame), {}};
  value.image.width = check.integer_within("width", m.width, 1, kLargestSide);
  value.image.height = check.integer_within("height", m.height, 1, kLargestSide);
  value.image.channels = channels;
  check.count("byte_count", m.byte_count, std::int64_t{m.width} * m.height * channels);
  value.image.pixels = m.bytes;
  return value;
}

}  // namespace noctule::convert
