/// Detectors against truth in drawn pictures. The full sweep is bench/sweeps/camera_detection.cpp.
#include <gtest/gtest.h>

#include "core/chi2.hpp"
#include "core/gaussian.hpp"
#include "sensors/camera/make_landmark_detector.hpp"
#include "statistics/sensors/camera_scene.hpp"

namespace noctule::sensors {
namespace {

using camera_scene::Exposure;
using camera_scene::Flat;

const models::CameraIntrinsics kCamera{.k1 = -0.1, .k2 = 0.02};
const models::CameraMounting kMounting{.position = {0.1, 0.0}, .height = 0.4, .pitch = radians(2.0)};
constexpr int kSigns = 4;
constexpr double kWidth = 0.3, kMarker = 0.15;

struct Outcome {
  int trials = 0, found = 0, wrong = 0;
  double nees = 0.0;  ///< mean, of range and bearing together
  double range_rms = 0.0, bearing_rms = 0.0;
};

template <class Picture>
Outcome trials(LandmarkDetector& detector, int n, double range, double angle, const Exposure& exposure,
               const Picture& picture) {
  Outcome o;
  for (int trial = 0; trial < n; ++trial) {
    Rng rng(1, stream_id("camera_detection_test"), static_cast<std::uint64_t>(trial));
    const int which = static_cast<int>(rng.index(kSigns));
    const double bearing = rng.uniform(-0.4, 0.4);
    const double there = range * rng.uniform(0.9, 1.1);
    const Flat flat{picture(which),
                    camera_scene::facing(kMounting, there, bearing, 0.4 + rng.uniform(-0.1, 0.1), angle)};
    const auto seen = detector.detect({{trial, trial}, camera_scene::photograph(kCamera, {&flat, 1}, exposure, rng)});
    ++o.trials;
    for (const LandmarkDetection& d : seen.detections) {
      if (d.id != which) {
        ++o.wrong;
        continue;
      }
      ++o.found;
      const Vector2 error(d.range - there, wrap(d.bearing - bearing));
      o.nees += mahalanobis2<2>(error, d.covariance);
      o.range_rms += error[0] * error[0];
      o.bearing_rms += error[1] * error[1];
    }
  }
  const double found = std::max(1, o.found);
  o.nees /= found;
  o.range_rms = std::sqrt(o.range_rms / found);
  o.bearing_rms = std::sqrt(o.bearing_rms / found);
  return o;
}

/// The covariance holds a share that no noise of these pictures fills (the print, the lens): it may be wide, and must
/// not be narrow.
void expect_consistent(const Outcome& o) {
  EXPECT_EQ(o.wrong, 0);
  EXPECT_LT(o.nees, nees_bounds(2, o.found, 0.99).high);
  EXPECT_GT(o.nees, 0.1);
}

TEST(Signs, AreFoundWhereTheyAre) {
  auto detector = make_landmark_detector(camera_scene::sign_catalogue(kSigns, kWidth), kCamera, kMounting);
  const auto picture = [](int k) { return camera_scene::printed_sign(k, kWidth); };
  for (const auto& [range, angle, noise] : {std::tuple{1.0, 0.0, 2.0}, {2.0, 0.4, 5.0}, {3.0, 0.0, 10.0}}) {
    SCOPED_TRACE(range);
    const Outcome o = trials(*detector, 20, range, angle, {.blur = 0.8, .noise = noise}, picture);
    EXPECT_EQ(o.found, o.trials);
    EXPECT_LT(o.range_rms, 0.004 * range);
    EXPECT_LT(o.bearing_rms, radians(0.02));
    expect_consistent(o);
  }
}

TEST(Fiducials, AreFoundWhereTheyAre) {
  const FiducialParameters parameters{.family = MarkerFamily::aruco_4x4_50, .side = kMarker};
  auto detector = make_landmark_detector(parameters, kCamera, kMounting);
  const auto picture = [](int k) { return camera_scene::printed_marker(k, kMarker); };
  for (const auto& [range, angle, noise] : {std::tuple{1.0, 0.3, 2.0}, {2.0, 0.5, 5.0}}) {
    SCOPED_TRACE(range);
    const Outcome o = trials(*detector, 20, range, angle, {.blur = 0.8, .noise = noise}, picture);
    EXPECT_GE(o.found, o.trials - 1);
    EXPECT_LT(o.range_rms, 0.006 * range);
    EXPECT_LT(o.bearing_rms, radians(0.02));
    expect_consistent(o);
  }
}

TEST(Signs, AreNotTakenForTheirMirrorImageOrForOthers) {
  auto detector = make_landmark_detector(camera_scene::sign_catalogue(kSigns, kWidth), kCamera, kMounting);
  for (int trial = 0; trial < 8; ++trial) {
    Rng rng(2, stream_id("camera_detection_test"), static_cast<std::uint64_t>(trial));
    // Signs 0 to 3 in a mirror, then signs of somebody else's catalogue.
    PlanarPicture picture = camera_scene::printed_sign(trial < 4 ? trial : 100 + trial, kWidth);
    if (trial < 4) {
      const auto side = static_cast<std::ptrdiff_t>(picture.grey.width);
      for (auto row = picture.grey.pixels.begin(); row != picture.grey.pixels.end(); row += side)
        std::reverse(row, row + side);
    }
    const Flat flat{picture, camera_scene::facing(kMounting, 1.5, 0.1, 0.4, 0.2)};
    const Image image = camera_scene::photograph(kCamera, {&flat, 1}, {}, rng);
    EXPECT_TRUE(detector->detect({{trial, trial}, image}).detections.empty());
  }
}

TEST(Signs, PredictionNeitherMovesNorInvents) {
  auto detector = make_landmark_detector(camera_scene::sign_catalogue(kSigns, kWidth), kCamera, kMounting);
  Rng rng(3);
  const Flat flat{camera_scene::printed_sign(1, kWidth), camera_scene::facing(kMounting, 2.0, 0.2, 0.4, 0.0)};
  const CameraImage image{{}, camera_scene::photograph(kCamera, {&flat, 1}, {}, rng)};
  const auto blind = detector->detect(image);
  const Matrix2 spread = Vector2(0.01, 0.0004).asDiagonal();
  const std::vector<LandmarkPrediction> right{{1, 2.1, 0.19, spread}}, wrong{{1, 2.0, -0.3, spread}};
  const auto led = detector->detect(image, right);
  ASSERT_EQ(blind.detections.size(), 1U);
  ASSERT_EQ(led.detections.size(), 1U);
  EXPECT_NEAR(led.detections[0].range, blind.detections[0].range, 1e-3);
  EXPECT_NEAR(led.detections[0].bearing, blind.detections[0].bearing, 1e-4);
  EXPECT_TRUE(detector->detect(image, wrong).detections.empty());
}

TEST(Posts, AreFoundWhereTheyStand) {
  PostDetectorParameters parameters;
  parameters.catalogue.push_back({.id = 7, .colour = {200.0, 40.0, 40.0}, .radius = 0.06, .height = 0.5});
  parameters.catalogue.push_back({.id = 8, .colour = {40.0, 60.0, 200.0}, .radius = 0.06, .height = 0.5});
  auto detector = make_landmark_detector(parameters, kCamera, kMounting);
  Outcome o;
  constexpr int kTrials = 30;
  for (int trial = 0; trial < kTrials; ++trial) {
    Rng rng(4, stream_id("camera_detection_test"), static_cast<std::uint64_t>(trial));
    const camera_scene::Column column{rng.uniform(1.2, 3.0), rng.uniform(-0.4, 0.4), 0.06, 0.5, {200.0, 40.0, 40.0}};
    const auto seen = detector->detect(
        {{trial, trial}, camera_scene::photograph(kCamera, kMounting, column, {.blur = 0.8, .noise = 3.0}, rng)});
    for (const LandmarkDetection& d : seen.detections) {
      if (d.id != 7) {
        ++o.wrong;
        continue;
      }
      ++o.found;
      const Vector2 error(d.range - column.range, wrap(d.bearing - column.bearing));
      o.nees += mahalanobis2<2>(error, d.covariance) / kTrials;
      EXPECT_LT(std::abs(error[0]), 0.05 * column.range);
      EXPECT_LT(std::abs(error[1]), radians(0.1));
    }
  }
  EXPECT_EQ(o.found, kTrials);
  expect_consistent(o);
}

/// What has the colour but floats, or is not as wide as its distance says, is no post.
TEST(Posts, MustStandOnTheFloor) {
  PostDetectorParameters parameters;
  parameters.catalogue.push_back({.id = 7, .colour = {200.0, 40.0, 40.0}, .radius = 0.06, .height = 0.0});
  auto detector = make_landmark_detector(parameters, kCamera, kMounting);
  Rng rng(6);
  const camera_scene::Column thin{1.5, 0.1, 0.03, 0.5, {200.0, 40.0, 40.0}};
  const Image image = camera_scene::photograph(kCamera, kMounting, thin, {}, rng);
  EXPECT_TRUE(detector->detect({{}, image}).detections.empty());
  parameters.check_ground = false;
  EXPECT_EQ(make_landmark_detector(parameters, kCamera, kMounting)->detect({{}, image}).detections.size(), 1U);
}

}  // namespace
}  // namespace noctule::sensors
