#include "sensors/camera/ground.hpp"

namespace noctule::sensors {

std::optional<LandmarkDetection> ground_contact(const models::CameraIntrinsics& camera,
                                                const models::CameraMounting& mounting, const Vector2& pixel,
                                                const GroundParameters& parameters) {
  const auto ray = models::unproject(camera, pixel);
  if (!ray) return std::nullopt;
  const Matrix3 in_base = mounting.optical_in_base().linear();
  const Vector3 direction = in_base * ray->direction.homogeneous();  // of the base, from the optical centre
  if (!(direction.z() < 0.0)) return std::nullopt;
  const double scale = mounting.height / -direction.z();
  const Vector3 point = scale * direction;

  // The point on the floor moves with the ray (two), with the turn about the camera's level axis, with the height.
  const Vector3 level(-std::sin(mounting.yaw), std::cos(mounting.yaw), 0.0);
  Eigen::Matrix<double, 3, 4> direction_by;
  direction_by << in_base.leftCols<2>() * ray->by_pixel, level.cross(direction), Vector3::Zero();
  Eigen::Matrix<double, 3, 4> by = scale * direction_by + point * (direction_by.row(2) / -direction.z());
  by.col(3) = point / mounting.height;
  const Eigen::Vector4d sd(parameters.pixel_sd, parameters.pixel_sd, parameters.pitch_sd, parameters.height_sd);
  const Eigen::Matrix<double, 3, 4> spread = by * sd.asDiagonal();

  LandmarkDetection contact = plane_sighting(mounting, in_base.transpose() * point,
                                             in_base.transpose() * (spread * spread.transpose()) * in_base);
  if (!(contact.range <= parameters.max_range)) return std::nullopt;
  return contact;
}

}  // namespace noctule::sensors
