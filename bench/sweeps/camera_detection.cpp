/// Landmark detectors of the camera against truth in drawn pictures, over distance, angle, blur and noise.
/// Usage: camera_detection [trials = 100] [seed = 1]. Prints CSV.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <opencv2/core/utility.hpp>
#include <string>

#include "core/gaussian.hpp"
#include "sensors/camera/make_landmark_detector.hpp"
#include "statistics/sensors/camera_scene.hpp"

namespace {

using namespace noctule;
using namespace noctule::sensors;
using camera_scene::Exposure;
using camera_scene::Flat;

constexpr int kSigns = 8;
constexpr double kWidth = 0.3, kMarker = 0.15;

struct View {
  double range = 2.0, angle = 0.0;
  Exposure exposure;
};

struct Row {
  int trials = 0, found = 0, wrong = 0;
  double range2 = 0.0, bearing2 = 0.0, range = 0.0, bearing = 0.0, nees = 0.0, sd_range = 0.0, sd_bearing = 0.0;
  double milliseconds = 0.0;
};

/// \param predicted whether the detector is told where the sign must appear, to 10 cm and 1 degree
Row run(LandmarkDetector& detector, const View& view, int trials, std::uint64_t seed,
        const std::vector<PlanarPicture>& pictures, bool predicted = false) {
  Row row;
  for (int trial = 0; trial < trials; ++trial) {
    Rng rng(seed, stream_id("camera_detection"), static_cast<std::uint64_t>(trial));
    const auto which = static_cast<std::size_t>(rng.index(pictures.size()));
    const double bearing = rng.uniform(-0.4, 0.4), height = detector.mounting().height + rng.uniform(-0.15, 0.15);
    const double angle = (rng.uniform() < 0.5 ? -1.0 : 1.0) * view.angle;
    const Flat flat{pictures[which], camera_scene::facing(detector.mounting(), view.range, bearing, height, angle)};
    const CameraImage image{{trial, trial},
                            camera_scene::photograph(detector.camera(), {&flat, 1}, view.exposure, rng)};
    const double range_sd = 0.1, bearing_sd = radians(1.0);
    std::vector<LandmarkPrediction> expected;
    if (predicted) {
      expected.push_back({static_cast<std::int64_t>(which), view.range + range_sd * rng.normal(),
                          bearing + bearing_sd * rng.normal(),
                          Vector2(range_sd * range_sd, bearing_sd * bearing_sd).asDiagonal()});
    }
    const std::clock_t start = std::clock();
    const LandmarkDetections seen = detector.detect(image, expected);
    row.milliseconds += 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    ++row.trials;
    for (const LandmarkDetection& d : seen.detections) {
      const Vector2 error(d.range - view.range, wrap(d.bearing - bearing));
      if (d.id != static_cast<std::int64_t>(which) || std::abs(error[0]) > 0.3 * view.range) {
        ++row.wrong;
        continue;
      }
      ++row.found;
      row.range += error[0], row.bearing += error[1];
      row.range2 += error[0] * error[0], row.bearing2 += error[1] * error[1];
      row.sd_range += d.covariance(0, 0), row.sd_bearing += d.covariance(1, 1);
      row.nees += mahalanobis2<2>(error, d.covariance) / 2.0;
    }
  }
  return row;
}

void print(const char* what, const View& v, const Row& r) {
  const double n = std::max(1, r.found);
  std::printf("%s,%.2f,%.0f,%.1f,%.0f,%d,%d,%d,%.3f,%.3f,%.3f,%.3f,%.4f,%.4f,%.4f,%.2f\n", what, v.range,
              degrees(v.angle), v.exposure.blur, v.exposure.noise, r.trials, r.found, r.wrong, 1000.0 * r.range / n,
              1000.0 * std::sqrt(r.range2 / n), 1000.0 * std::sqrt(r.sd_range / n), degrees(r.bearing / n),
              degrees(std::sqrt(r.bearing2 / n)), degrees(std::sqrt(r.sd_bearing / n)), r.nees / n,
              r.milliseconds / r.trials);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int trials = argc > 1 ? std::max(1, std::atoi(argv[1])) : 100;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  cv::setNumThreads(1);
  const models::CameraIntrinsics camera{.k1 = -0.1, .k2 = 0.02};
  const models::CameraMounting mounting{.position = {0.1, 0.0}, .height = 0.4, .pitch = radians(2.0)};

  const SignDetectorParameters signs = camera_scene::sign_catalogue(kSigns, kWidth);
  const FiducialParameters fiducials{.family = MarkerFamily::aruco_4x4_50, .side = kMarker};
  std::vector<PlanarPicture> pictures, markers;
  for (int k = 0; k < kSigns; ++k) {
    pictures.push_back(camera_scene::printed_sign(k, kWidth));
    markers.push_back(camera_scene::printed_marker(k, kMarker));
  }
  auto sign_detector = make_landmark_detector(signs, camera, mounting);
  auto fiducial_detector = make_landmark_detector(fiducials, camera, mounting);
  std::printf(
      "detector,range_m,angle_deg,blur_px,noise,trials,found,wrong,range_bias_mm,range_rmse_mm,range_sd_mm,"
      "bearing_bias_deg,bearing_rmse_deg,bearing_sd_deg,nees,ms\n");
  std::vector<View> views;
  for (const double range : {0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 4.5, 5.0, 6.0}) views.push_back({range, 0.0, {}});
  for (const double angle : {20.0, 40.0, 50.0, 55.0, 60.0, 70.0}) views.push_back({2.0, radians(angle), {}});
  for (const double blur : {0.0, 1.5, 2.5}) views.push_back({2.0, 0.0, {.blur = blur}});
  for (const double noise : {0.0, 5.0, 10.0, 20.0}) views.push_back({2.0, 0.0, {.noise = noise}});
  for (const View& view : views) print("fiducial", view, run(*fiducial_detector, view, trials, seed, markers));
  for (const View& view : views) print("sign", view, run(*sign_detector, view, trials, seed, pictures));
  for (const View& view : views) print("sign_predicted", view, run(*sign_detector, view, trials, seed, pictures, true));
}
