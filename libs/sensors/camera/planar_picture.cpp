#include "sensors/camera/planar_picture.hpp"

#include <opencv2/calib3d.hpp>

namespace noctule::sensors {

std::array<Vector3, 4> PlanarPicture::corners() const {
  const double x = 0.5 * width, y = 0.5 * height;
  return {Vector3(-x, -y, 0.0), Vector3(x, -y, 0.0), Vector3(x, y, 0.0), Vector3(-x, y, 0.0)};
}

std::optional<std::vector<Vector2>> picture_outline(const models::CameraIntrinsics& camera,
                                                    const PlanarPicture& picture, const PlanarPose& pose) {
  std::vector<Vector2> outline;
  for (const Vector3& corner : picture.corners()) {
    const auto p = models::project(camera, pose.rotation * corner + pose.translation);
    if (!p) return std::nullopt;
    outline.push_back(p->pixel);
  }
  return outline;
}

std::optional<PlanarPose> pose_from_corners(const models::CameraIntrinsics& camera, const PlanarPicture& picture,
                                            const std::vector<Vector2>& corners) {
  std::vector<cv::Point2d> rays;
  std::vector<cv::Point3d> points;
  const auto known = picture.corners();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto ray = models::unproject(camera, corners[i]);
    if (!ray) return std::nullopt;
    rays.emplace_back(ray->direction.x(), ray->direction.y());
    points.emplace_back(known[i].x(), known[i].y(), 0.0);
  }
  cv::Vec3d turn, shift;
  if (!cv::solvePnP(points, rays, cv::Matx33d::eye(), cv::noArray(), turn, shift, false, cv::SOLVEPNP_IPPE))
    return std::nullopt;
  cv::Matx33d rotation;
  cv::Rodrigues(turn, rotation);
  PlanarPose pose;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.rotation(i, j) = rotation(i, j);
    pose.translation[i] = shift[i];
  }
  // The front must be seen.
  const bool front = pose.rotation.col(2).dot(pose.translation) > 0.0;
  if (!pose.rotation.allFinite() || !pose.translation.allFinite() || pose.translation.z() <= 0.0 || !front)
    return std::nullopt;
  return pose;
}

}  // namespace noctule::sensors
