#include "models/camera.hpp"

#include <gtest/gtest.h>

namespace noctule::models {
namespace {

CameraIntrinsics wide_lens() {
  return {.fx = 420.0,
          .fy = 430.0,
          .cx = 311.0,
          .cy = 251.0,
          .k1 = -0.28,
          .k2 = 0.09,
          .p1 = 1e-3,
          .p2 = -8e-4,
          .k3 = -0.01};
}

TEST(Camera, UnprojectUndoesProject) {
  const CameraIntrinsics camera = wide_lens();
  for (double u = 0.0; u <= 639.0; u += 71.0) {
    for (double v = 0.0; v <= 479.0; v += 53.0) {
      const std::optional<CameraRay> ray = unproject(camera, {u, v});
      ASSERT_TRUE(ray) << u << ", " << v;
      const double z = 3.7;
      const Vector3 point(ray->direction.x() * z, ray->direction.y() * z, z);
      const std::optional<CameraProjection> back = project(camera, point);
      ASSERT_TRUE(back);
      EXPECT_NEAR(back->pixel.x(), u, 1e-8);
      EXPECT_NEAR(back->pixel.y(), v, 1e-8);
    }
  }
}

TEST(Camera, DerivativesAgreeWithDifferences) {
  const CameraIntrinsics camera = wide_lens();
  const double h = 1e-6;
  const Vector3 point(0.7, -0.4, 2.1);
  const CameraProjection at = *project(camera, point);
  for (int k = 0; k < 3; ++k) {
    const Vector3 step = h * Vector3::Unit(k);
    const Vector2 slope = (project(camera, point + step)->pixel - project(camera, point - step)->pixel) / (2.0 * h);
    EXPECT_LT((slope - at.by_point.col(k)).norm(), 1e-5);
  }
  const Vector2 pixel(77.0, 400.0);
  const CameraRay ray = *unproject(camera, pixel);
  for (int k = 0; k < 2; ++k) {
    const Vector2 step = 1e-3 * Vector2::Unit(k);
    const Vector2 slope =
        (unproject(camera, pixel + step)->direction - unproject(camera, pixel - step)->direction) / 2e-3;
    EXPECT_LT((slope - ray.by_pixel.col(k)).norm(), 1e-7);
  }
}

TEST(Camera, SeesNothingBehindItAndNoRayBeyondTheFoldOfTheLens) {
  EXPECT_FALSE(project(CameraIntrinsics{}, {0.1, 0.1, -1.0}));
  EXPECT_FALSE(project(CameraIntrinsics{}, {0.1, 0.1, 0.0}));
  CameraIntrinsics folded;
  folded.k1 = -0.5;  // x (1 - x^2 / 2) never exceeds 0.55
  EXPECT_FALSE(unproject(folded, {319.5 + 0.6 * 500.0, 239.5}));
  EXPECT_TRUE(unproject(folded, {319.5 + 0.5 * 500.0, 239.5}));
}

TEST(Camera, MountingFollowsRep103) {
  CameraMounting mounting;
  mounting.position << 0.1, -0.05;
  mounting.height = 0.4;
  // Without rotation the optical axis is base x, image right is base -y, image down is base -z.
  const Eigen::Isometry3d level = mounting.optical_in_base();
  EXPECT_LT((level * Vector3(0.0, 0.0, 1.0) - Vector3(1.1, -0.05, 0.4)).norm(), 1e-12);
  EXPECT_LT((level * Vector3(1.0, 0.0, 0.0) - Vector3(0.1, -1.05, 0.4)).norm(), 1e-12);
  EXPECT_LT((level * Vector3(0.0, 1.0, 0.0) - Vector3(0.1, -0.05, -0.6)).norm(), 1e-12);
  mounting.yaw = radians(90.0);
  EXPECT_LT((mounting.optical_in_base() * Vector3(0.0, 0.0, 1.0) - Vector3(0.1, 0.95, 0.4)).norm(), 1e-12);
  mounting.yaw = 0.0;
  mounting.pitch = radians(30.0);  // down
  EXPECT_LT((mounting.optical_in_base() * Vector3(0.0, 0.0, 1.0)).z(), 0.4 - 0.49);
}

}  // namespace
}  // namespace noctule::models
