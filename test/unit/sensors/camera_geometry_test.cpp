#include <gtest/gtest.h>

#include <map>

#include "config/config.hpp"
#include "core/chi2.hpp"
#include "core/error.hpp"
#include "core/gaussian.hpp"
#include "sensors/camera/descriptors.hpp"
#include "sensors/camera/ground.hpp"
#include "sensors/camera/landmark_camera.hpp"
#include "statistics/sensors/camera_scene.hpp"

namespace noctule::sensors {
namespace {

models::CameraMounting tilted() {
  return {.position = {0.1, -0.05}, .height = 0.4, .roll = 0.05, .pitch = 0.2, .yaw = 0.7};
}

TEST(PlaneSighting, ComesBackFromItsPoint) {
  for (const double bearing : {-0.6, 0.0, 0.4}) {
    const Vector3 point = point_of_sighting(tilted(), 2.5, bearing, 0.9);
    const LandmarkDetection d = plane_sighting(tilted(), point, Matrix3::Identity());
    EXPECT_NEAR(d.range, 2.5, 1e-12);
    EXPECT_NEAR(d.bearing, bearing, 1e-12);
  }
}

TEST(PlaneSighting, CovarianceIsThatOfDifferences) {
  const Vector3 point = point_of_sighting(tilted(), 1.7, -0.3, 0.1);
  Matrix3 covariance;
  covariance << 4e-4, 1e-4, -2e-4, 1e-4, 9e-4, 3e-4, -2e-4, 3e-4, 16e-4;
  Eigen::Matrix<double, 2, 3> by;
  for (int i = 0; i < 3; ++i) {
    const double h = 1e-6;
    const Vector3 step = h * Vector3::Unit(i);
    const LandmarkDetection a = plane_sighting(tilted(), point + step, covariance);
    const LandmarkDetection b = plane_sighting(tilted(), point - step, covariance);
    by.col(i) << (a.range - b.range) / (2.0 * h), wrap(a.bearing - b.bearing) / (2.0 * h);
  }
  const Matrix2 expected = by * covariance * by.transpose();
  EXPECT_LT((plane_sighting(tilted(), point, covariance).covariance - expected).norm(), 1e-8);
}

TEST(GroundContact, FindsThePointOfTheFloor) {
  const models::CameraIntrinsics camera{.k1 = -0.1};
  for (const double range : {0.8, 1.5, 3.0}) {
    const auto pixel = models::project(camera, point_of_sighting(tilted(), range, 0.2, 0.0));
    ASSERT_TRUE(pixel);
    const auto contact = ground_contact(camera, tilted(), pixel->pixel, {});
    ASSERT_TRUE(contact);
    EXPECT_NEAR(contact->range, range, 1e-9);
    EXPECT_NEAR(contact->bearing, 0.2, 1e-9);
  }
  EXPECT_FALSE(ground_contact(camera, tilted(), Vector2(320.0, 5.0), {}));  // above the horizon
}

/// Pixel, pitch and height are drawn; the spread of what comes out is the covariance.
TEST(GroundContact, CovarianceIsThatOfDraws) {
  const models::CameraIntrinsics camera;
  const models::CameraMounting level{.height = 0.4, .pitch = 0.15};
  const GroundParameters parameters{.pixel_sd = 1.0, .pitch_sd = radians(0.3), .height_sd = 0.004};
  const Vector2 pixel = models::project(camera, point_of_sighting(level, 1.5, 0.25, 0.0))->pixel;
  const auto nominal = ground_contact(camera, level, pixel, parameters);
  ASSERT_TRUE(nominal);
  Rng rng(1);
  constexpr int kDraws = 4000;
  double nees = 0.0;
  for (int k = 0; k < kDraws; ++k) {
    models::CameraMounting off = level;
    off.pitch += parameters.pitch_sd * rng.normal();
    off.height += parameters.height_sd * rng.normal();
    const auto drawn = ground_contact(camera, off, pixel + Vector2(rng.normal(), rng.normal()), parameters);
    ASSERT_TRUE(drawn);
    nees +=
        mahalanobis2<2>(Vector2(drawn->range - nominal->range, drawn->bearing - nominal->bearing), nominal->covariance);
  }
  const Interval bounds = nees_bounds(2, kDraws, 0.999);
  EXPECT_GT(nees / kDraws, bounds.low);
  EXPECT_LT(nees / kDraws, bounds.high * 1.05);  // second order of the range by the pitch
}

TEST(Descriptors, NearestIsThatOfAnExhaustiveSearch) {
  Rng rng(3);
  std::vector<Descriptor> known(300);
  std::vector<int> groups;
  for (Descriptor& d : known) {
    for (auto& word : d) word = rng();
    groups.push_back(static_cast<int>(groups.size()) / 3);
  }
  int found = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Descriptor query = known[rng.index(known.size())];
    for (int flips = 0; flips < 60; ++flips) query[rng.index(4)] ^= std::uint64_t{1} << rng.index(64);
    std::size_t best = 0;
    for (std::size_t i = 1; i < known.size(); ++i)
      if (hamming(query, known[i]) < hamming(query, known[best])) best = i;
    int second = 257;
    for (std::size_t i = 0; i < known.size(); ++i)
      if (groups[i] != groups[best]) second = std::min(second, hamming(query, known[i]));
    const int distance = hamming(query, known[best]);
    const bool accepted = distance <= 64 && distance <= 0.7 * second;
    const auto nearest = nearest_descriptor(query, known, groups, 64, 0.7);
    ASSERT_EQ(nearest.has_value(), accepted);
    if (!nearest) continue;
    ++found;
    EXPECT_EQ(nearest->index, best);
    EXPECT_EQ(nearest->distance, distance);
  }
  EXPECT_GT(found, 100);
}

std::vector<LandmarkDetectorParameters> all_detectors() {
  PostDetectorParameters posts;
  posts.catalogue.emplace_back();
  return {camera_scene::sign_catalogue(4, 0.3), FiducialParameters{.family = MarkerFamily::aruco_4x4_50}, posts,
          KeypointParameters{}};
}

TEST(LandmarkDetectors, RefusePicturesOfAnotherSize) {
  for (const auto& parameters : all_detectors()) {
    auto detector = make_landmark_detector(parameters, {}, {});
    EXPECT_THROW((void)detector->detect({{}, {}}), InputError);
    EXPECT_THROW((void)detector->detect({{}, {320, 240, 1, std::vector<std::uint8_t>(320 * 240)}}), InputError);
    EXPECT_THROW((void)detector->detect({{}, {640, 480, 3, std::vector<std::uint8_t>(640 * 480)}}), InputError);
    EXPECT_THROW((void)detector->detect({{}, {640, 480, 2, std::vector<std::uint8_t>(640 * 480 * 2)}}), InputError);
  }
}

TEST(LandmarkDetectors, SeeNothingInBlackWhiteAndNoise) {
  for (const auto& parameters : all_detectors()) {
    auto detector = make_landmark_detector(parameters, {}, {});
    for (const int channels : {1, 3}) {
      Image image{640, 480, channels, {}};
      const std::size_t bytes = 640U * 480U * static_cast<std::size_t>(channels);
      for (const int level : {0, 128, 255}) {
        image.pixels.assign(bytes, static_cast<std::uint8_t>(level));
        for (int frame = 0; frame < 3; ++frame)
          EXPECT_TRUE(detector->detect({{frame, frame}, image}).detections.empty());
      }
      for (int frame = 0; frame < 10; ++frame) {
        Rng rng(static_cast<std::uint64_t>(frame), stream_id("noise"));
        for (std::uint8_t& p : image.pixels) p = static_cast<std::uint8_t>(rng() & 0xffU);
        EXPECT_TRUE(detector->detect({{frame, frame}, image}).detections.empty());
      }
    }
  }
}

TEST(LandmarkDetectors, RefuseParametersThatMakeNone) {
  EXPECT_THROW((void)make_landmark_detector(SignDetectorParameters{}, {}, {}), InputError);
  EXPECT_THROW((void)make_landmark_detector(PostDetectorParameters{}, {}, {}), InputError);
  SignDetectorParameters twice = camera_scene::sign_catalogue(2, 0.3);
  twice.catalogue[1].id = twice.catalogue[0].id;
  EXPECT_THROW((void)make_landmark_detector(twice, {}, {}), InputError);
  SignDetectorParameters file = camera_scene::sign_catalogue(1, 0.3);
  file.catalogue[0].image = "sign.png";
  EXPECT_THROW((void)make_landmark_detector(file, {}, {}), InputError);  // nobody reads files here
  EXPECT_THROW((void)make_landmark_detector(FiducialParameters{}, {.fx = -1.0}, {}), InputError);
}

TEST(LandmarkDetectors, AreAllNamedInTheCameraFile) {
  const auto parameters = config::load<LandmarkCameraParameters>(std::filesystem::path(NOCTULE_SOURCE_DIR) /
                                                                 "config/cameras/all_detectors.yaml");
  ASSERT_EQ(parameters.detectors.size(), kLandmarkDetectorNames.size());
  for (std::size_t i = 0; i < parameters.detectors.size(); ++i) EXPECT_EQ(parameters.detectors[i].find.index(), i);
  EXPECT_NO_THROW(LandmarkCamera{parameters});
}

/// A room that turns slowly: keypoints are no landmarks before they are stable, then keep their identities, and their
/// bearings move as the camera turns.
TEST(Keypoints, KeepTheirIdentityAndTheirBearing) {
  const models::CameraIntrinsics camera{
      .width = 320, .height = 240, .fx = 250.0, .fy = 250.0, .cx = 159.5, .cy = 119.5};
  KeypointParameters parameters;
  auto detector = make_landmark_detector(parameters, camera, {});
  constexpr int kFrames = 16;
  constexpr int kStep = 3;  // pixels a frame, in a strip that passes by
  Rng rng(5);
  const std::vector<double> strip = camera_scene::background(320 + kFrames * kStep, 240, rng, 60.0);
  std::map<std::int64_t, double> before;
  int seen = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    Image image{320, 240, 1, {}};
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        const double g = strip[static_cast<std::size_t>(y * (320 + kFrames * kStep) + x + frame * kStep)];
        image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(g + 2.0 * rng.normal(), 0.0, 255.0)));
      }
    }
    const LandmarkDetections found = detector->detect({{frame, frame}, image});
    if (frame + 1 < parameters.stable_frames) {
      EXPECT_TRUE(found.detections.empty());
    }
    std::map<std::int64_t, double> now;
    for (const LandmarkDetection& d : found.detections) {
      EXPECT_EQ(d.kind, DetectionKind::bearing_only);
      EXPECT_GE(d.id, parameters.first_id);
      EXPECT_EQ(d.range, 0.0);
      EXPECT_GT(d.covariance(1, 1), 0.0);
      EXPECT_TRUE(now.emplace(d.id, d.bearing).second);
      const auto old = before.find(d.id);
      if (old == before.end()) continue;
      ++seen;
      const double moved = camera.fx * (std::tan(old->second) - std::tan(d.bearing));
      EXPECT_NEAR(moved, -kStep, 1.0);
    }
    before = std::move(now);
  }
  EXPECT_GT(seen, 50);
}

}  // namespace
}  // namespace noctule::sensors
