#include "models/camera.hpp"

#include <cmath>

namespace noctule::models {
namespace {

struct Distorted {
  Vector2 point;
  Matrix2 by_ray;
};

/// The lens: where a ray (x/z, y/z) meets the plane z = 1 behind it. Brown (1966), as in ROS and OpenCV.
Distorted distort(const CameraIntrinsics& c, const Vector2& ray) {
  const double x = ray.x(), y = ray.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double by_r2 = c.k1 + r2 * (2.0 * c.k2 + r2 * 3.0 * c.k3);
  Distorted d;
  d.point << x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x),
      y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y;
  const double cross = 2.0 * x * y * by_r2 + 2.0 * c.p1 * x + 2.0 * c.p2 * y;
  d.by_ray << radial + 2.0 * x * x * by_r2 + 2.0 * c.p1 * y + 6.0 * c.p2 * x, cross, cross,
      radial + 2.0 * y * y * by_r2 + 6.0 * c.p1 * y + 2.0 * c.p2 * x;
  return d;
}

}  // namespace

Eigen::Isometry3d CameraMounting::optical_in_base() const {
  Eigen::Isometry3d camera_in_base = Eigen::Isometry3d::Identity();
  camera_in_base.translation() << position.x(), position.y(), height;
  camera_in_base.linear() = (Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
                             Eigen::AngleAxisd(roll, Vector3::UnitX()))
                                .toRotationMatrix();
  Eigen::Isometry3d optical_in_camera = Eigen::Isometry3d::Identity();
  optical_in_camera.linear() << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return camera_in_base * optical_in_camera;
}

std::optional<CameraProjection> project(const CameraIntrinsics& camera, const Vector3& point) {
  if (!(point.z() >= 1e-6)) return std::nullopt;
  const double inverse_z = 1.0 / point.z();
  const Vector2 ray = point.head<2>() * inverse_z;
  const Distorted d = distort(camera, ray);
  const Vector2 focal(camera.fx, camera.fy);
  Eigen::Matrix<double, 2, 3> ray_by_point;
  ray_by_point << inverse_z, 0.0, -ray.x() * inverse_z, 0.0, inverse_z, -ray.y() * inverse_z;
  return CameraProjection{focal.cwiseProduct(d.point) + Vector2(camera.cx, camera.cy),
                          focal.asDiagonal() * d.by_ray * ray_by_point};
}

std::optional<CameraRay> unproject(const CameraIntrinsics& camera, const Vector2& pixel) {
  constexpr int kSteps = 30;
  constexpr double kTolerance = 1e-12;
  const Vector2 target((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
  Vector2 ray = target;
  for (int step = 0; step < kSteps; ++step) {
    const Distorted d = distort(camera, ray);
    const Vector2 residual = target - d.point;
    // Beyond the fold of the lens model the same pixel has a second, false ray.
    if (!(d.by_ray.determinant() > 0.0) || !(d.by_ray.trace() > 0.0)) return std::nullopt;
    const Matrix2 inverse = d.by_ray.inverse();
    if (residual.norm() < kTolerance) {
      const Vector2 per_focal(1.0 / camera.fx, 1.0 / camera.fy);
      return CameraRay{ray, inverse * per_focal.asDiagonal()};
    }
    ray += inverse * residual;
  }
  return std::nullopt;
}

}  // namespace noctule::models
