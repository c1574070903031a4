/// One picture of 640 x 480 with two signs and a marker, on one core; beside it the plain OpenCV calls that find
/// features and markers and neither pose nor covariance.
#include <benchmark/benchmark.h>

#include <array>
#include <opencv2/aruco.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>

#include "sensors/camera/make_landmark_detector.hpp"
#include "sensors/camera/opencv.hpp"
#include "statistics/sensors/camera_scene.hpp"

namespace {

using namespace noctule;
using namespace noctule::sensors;

constexpr double kWidth = 0.3, kMarker = 0.15;
constexpr int kSigns = 8;
const models::CameraIntrinsics kCamera{.k1 = -0.1, .k2 = 0.02};
const models::CameraMounting kMounting{.height = 0.4};

const CameraImage& picture() {
  static const CameraImage image = [] {
    const std::array<camera_scene::Flat, 3> flats{
        {{camera_scene::printed_sign(1, kWidth), camera_scene::facing(kMounting, 2.0, 0.3, 0.4, 0.2)},
         {camera_scene::printed_sign(2, kWidth), camera_scene::facing(kMounting, 2.5, -0.1, 0.4, -0.4)},
         {camera_scene::printed_marker(3, kMarker), camera_scene::facing(kMounting, 1.5, -0.35, 0.45, 0.0)}}};
    Rng rng(1);
    return CameraImage{{}, camera_scene::photograph(kCamera, flats, {}, rng)};
  }();
  return image;
}

void run(benchmark::State& state, const std::vector<LandmarkDetectorParameters>& all) {
  cv::setNumThreads(1);
  std::vector<std::unique_ptr<LandmarkDetector>> detectors;
  for (const auto& parameters : all) detectors.push_back(make_landmark_detector(parameters, kCamera, kMounting));
  std::size_t found = 0;
  for (auto _ : state) {
    found = 0;
    for (const auto& detector : detectors) found += detector->detect(picture()).detections.size();
  }
  state.counters["found"] = static_cast<double>(found);
}

const FiducialParameters kFiducials{.family = MarkerFamily::aruco_4x4_50, .side = kMarker};

void signs(benchmark::State& state) {
  run(state, {camera_scene::sign_catalogue(kSigns, kWidth)});
}
BENCHMARK(signs)->Unit(benchmark::kMillisecond);

void fiducials(benchmark::State& state) {
  run(state, {kFiducials});
}
BENCHMARK(fiducials)->Unit(benchmark::kMillisecond);

void signs_and_fiducials(benchmark::State& state) {
  run(state, {camera_scene::sign_catalogue(kSigns, kWidth), kFiducials});
}
BENCHMARK(signs_and_fiducials)->Unit(benchmark::kMillisecond);

void keypoints(benchmark::State& state) {
  run(state, {KeypointParameters{}});
}
BENCHMARK(keypoints)->Unit(benchmark::kMillisecond);

/// OpenCV alone: ORB with its defaults but for the number, and its brute-force matcher on eight signs.
void opencv_orb_and_match(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto orb = cv::ORB::create(500);
  cv::Mat known;
  for (int k = 0; k < kSigns; ++k) {
    const PlanarPicture sign = camera_scene::printed_sign(k, kWidth);
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    cv::ORB::create(300)->detectAndCompute(as_mat(sign.grey), cv::noArray(), points, descriptors);
    known.push_back(descriptors);
  }
  for (auto _ : state) {
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    orb->detectAndCompute(as_mat(picture().image), cv::noArray(), points, descriptors);
    std::vector<std::vector<cv::DMatch>> matches;
    cv::BFMatcher(cv::NORM_HAMMING).knnMatch(descriptors, known, matches, 2);
    benchmark::DoNotOptimize(matches);
  }
}
BENCHMARK(opencv_orb_and_match)->Unit(benchmark::kMillisecond);

/// OpenCV alone: its marker detector with its defaults.
void opencv_markers(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
  for (auto _ : state) {
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    cv::aruco::detectMarkers(as_mat(picture().image), dictionary, corners, ids);
    benchmark::DoNotOptimize(corners);
  }
}
BENCHMARK(opencv_markers)->Unit(benchmark::kMillisecond);

}  // namespace
