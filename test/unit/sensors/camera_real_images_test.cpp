/// The pictures and the video of Debian's package opencv-doc.
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "config/config.hpp"
#include "core/error.hpp"
#include "models/ros_camera_info.hpp"
#include "sensors/camera/calibration.hpp"
#include "sensors/camera/make_landmark_detector.hpp"
#include "statistics/sensors/camera_scene.hpp"

namespace noctule::sensors {
namespace {

const std::filesystem::path kPictures = "/usr/share/doc/opencv-doc/examples/data";

#define REQUIRE_PICTURES() \
  if (!std::filesystem::exists(kPictures / "box.png")) GTEST_SKIP() << "needs Debian's package opencv-doc"

Image read(const std::filesystem::path& path) {
  const cv::Mat m = cv::imread(path.string(), cv::IMREAD_COLOR);
  if (m.empty()) throw InputError(path.string() + ": no picture");
  return {m.cols, m.rows, 3, {m.data, m.data + m.total() * 3}};
}

models::CameraIntrinsics camera_of(const Image& image) {
  return {.width = image.width, .height = image.height, .cx = 0.5 * (image.width - 1), .cy = 0.5 * (image.height - 1)};
}

/// Share of two convex outlines' union that both cover.
double overlap(const PixelOutline& a, const PixelOutline& b) {
  const auto points = [](const PixelOutline& outline) {
    std::vector<cv::Point2f> p;
    for (const Vector2& v : outline) p.emplace_back(static_cast<float>(v.x()), static_cast<float>(v.y()));
    return p;
  };
  std::vector<cv::Point2f> common;
  const double both = cv::intersectConvexConvex(points(a), points(b), common);
  return both / (cv::contourArea(points(a)) + cv::contourArea(points(b)) - both);
}

/// Corners of box.png in the scene by SIFT and a homography: slow, and nothing of ours.
PixelOutline box_by_sift() {
  const cv::Mat box = cv::imread((kPictures / "box.png").string(), cv::IMREAD_GRAYSCALE);
  const cv::Mat scene = cv::imread((kPictures / "box_in_scene.png").string(), cv::IMREAD_GRAYSCALE);
  const auto sift = cv::SIFT::create();
  std::vector<cv::KeyPoint> in_box, in_scene;
  cv::Mat of_box, of_scene;
  sift->detectAndCompute(box, cv::noArray(), in_box, of_box);
  sift->detectAndCompute(scene, cv::noArray(), in_scene, of_scene);
  std::vector<std::vector<cv::DMatch>> nearest;
  cv::BFMatcher(cv::NORM_L2).knnMatch(of_box, of_scene, nearest, 2);
  std::vector<cv::Point2f> from, to;
  for (const auto& n : nearest) {
    if (n[0].distance > 0.75F * n[1].distance) continue;
    from.push_back(in_box[static_cast<std::size_t>(n[0].queryIdx)].pt);
    to.push_back(in_scene[static_cast<std::size_t>(n[0].trainIdx)].pt);
  }
  const cv::Mat view = cv::findHomography(from, to, cv::RANSAC, 3.0);
  const float w = static_cast<float>(box.cols), h = static_cast<float>(box.rows);
  const std::vector<cv::Point2f> corners{{0.0F, 0.0F}, {w, 0.0F}, {w, h}, {0.0F, h}};
  std::vector<cv::Point2f> seen;
  cv::perspectiveTransform(corners, seen, view);
  PixelOutline outline;
  for (const cv::Point2f& p : seen) outline.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y));
  return outline;
}

TEST(RealImages, TheBoxIsFoundInItsScene) {
  REQUIRE_PICTURES();
  SignDetectorParameters signs = camera_scene::sign_catalogue(7, 0.3);
  signs.catalogue[3].image = kPictures / "box.png";
  signs.features = 500;
  const Image scene = read(kPictures / "box_in_scene.png");
  auto detector = make_landmark_detector(signs, camera_of(scene), {}, read);
  const LandmarkDetections seen = detector->detect({{}, scene});
  ASSERT_EQ(seen.detections.size(), 1U);
  EXPECT_EQ(seen.detections[0].id, 3);
  EXPECT_GT(overlap(detector->outlines()[0], box_by_sift()), 0.95);
}

TEST(RealImages, ShowNoSignsAndNoMarkers) {
  REQUIRE_PICTURES();
  const SignDetectorParameters signs = camera_scene::sign_catalogue(2, 0.3);
  int pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kPictures)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".png" && extension != ".jpg") continue;
    const cv::Mat m = cv::imread(entry.path().string(), cv::IMREAD_COLOR);
    if (m.empty() || m.cols < 64 || m.rows < 64) continue;
    const Image image{m.cols, m.rows, 3, {m.data, m.data + m.total() * 3}};
    ++pictures;
    for (const LandmarkDetectorParameters& parameters :
         {LandmarkDetectorParameters(signs), LandmarkDetectorParameters(FiducialParameters{})}) {
      auto detector = make_landmark_detector(parameters, camera_of(image), {});
      EXPECT_TRUE(detector->detect({{}, image}).detections.empty()) << entry.path().filename();
    }
  }
  EXPECT_GT(pictures, 50);
}

Image board_picture(const models::CameraIntrinsics& camera, const PlanarPose& pose, int trial) {
  // 10 x 7 squares of 2.5 cm with a square of white around: 9 x 6 inner corners.
  constexpr int kColumns = 12, kRows = 9, kTexels = 40;
  Image board{kColumns * kTexels, kRows * kTexels, 1, {}};
  for (int y = 0; y < board.height; ++y) {
    for (int x = 0; x < board.width; ++x) {
      const int column = x / kTexels, row = y / kTexels;
      const bool inside = column > 0 && row > 0 && column < kColumns - 1 && row < kRows - 1;
      board.pixels.push_back(inside && (column + row) % 2 == 0 ? 20 : 235);
    }
  }
  Rng rng(1, stream_id("board"), static_cast<std::uint64_t>(trial));
  const camera_scene::Flat flat{{board, kColumns * 0.025, kRows * 0.025}, pose};
  return camera_scene::photograph(camera, {&flat, 1}, {.blur = 0.6, .noise = 1.5, .gain = 0.8, .offset = 10.0}, rng);
}

TEST(Calibration, FindsTheLensThatTookThePictures) {
  const models::CameraIntrinsics truth{.fx = 520.0, .fy = 515.0, .cx = 325.0, .cy = 236.0, .k1 = -0.2, .k2 = 0.05};
  std::vector<Image> images;
  for (int k = 0; k < 10; ++k) {
    Rng rng(2, stream_id("board"), static_cast<std::uint64_t>(k));
    PlanarPose pose;
    pose.rotation = (Eigen::AngleAxisd(rng.uniform(-0.5, 0.5), Vector3::UnitX()) *
                     Eigen::AngleAxisd(rng.uniform(-0.5, 0.5), Vector3::UnitY()) *
                     Eigen::AngleAxisd(rng.uniform(-0.4, 0.4), Vector3::UnitZ()))
                        .toRotationMatrix();
    pose.translation << rng.uniform(-0.08, 0.08), rng.uniform(-0.06, 0.06), rng.uniform(0.38, 0.5);
    images.push_back(board_picture(truth, pose, k));
  }
  images.push_back({640, 480, 1, std::vector<std::uint8_t>(640 * 480, 90)});  // without a board
  const CameraCalibration c = calibrate_camera(images, {.third_radial = false});
  EXPECT_LT(c.rms, 0.15);
  EXPECT_LT(c.image_rms.back(), 0.0);
  const auto near = [&](double value, double expected, int i) {
    EXPECT_NEAR(value, expected, 4.0 * c.sd[i]) << "element " << i;
  };
  near(c.camera.fx, truth.fx, 0);
  near(c.camera.fy, truth.fy, 1);
  near(c.camera.cx, truth.cx, 2);
  near(c.camera.cy, truth.cy, 3);
  near(c.camera.k1, truth.k1, 4);
  EXPECT_LT(c.sd[0], 1.0);

  EXPECT_THROW((void)calibrate_camera(std::span(images).last(1), {}), InputError);
  images.push_back({64, 48, 1, std::vector<std::uint8_t>(64 * 48)});
  EXPECT_THROW((void)calibrate_camera(images, {}), InputError);
}

/// The thirteen pictures of OpenCV's sample against the calibration that comes with them.
TEST(Calibration, AgreesWithTheSampleOfOpenCv) {
  REQUIRE_PICTURES();
  std::vector<Image> images;
  for (int k = 1; k <= 14; ++k) {
    const auto path = kPictures / ("left" + std::string(k < 10 ? "0" : "") + std::to_string(k) + ".jpg");
    if (std::filesystem::exists(path)) images.push_back(read(path));
  }
  ASSERT_EQ(images.size(), 13U);
  const CameraCalibration c = calibrate_camera(images, {.square = 0.05});
  cv::FileStorage file((kPictures / "left_intrinsics.yml").string(), cv::FileStorage::READ);
  cv::Mat matrix, lens;
  file["camera_matrix"] >> matrix;
  file["distortion_coefficients"] >> lens;
  EXPECT_NEAR(c.camera.fx, matrix.at<double>(0, 0), 4.0);
  EXPECT_NEAR(c.camera.fy, matrix.at<double>(1, 1), 4.0);
  EXPECT_NEAR(c.camera.cx, matrix.at<double>(0, 2), 4.0);
  EXPECT_NEAR(c.camera.cy, matrix.at<double>(1, 2), 4.0);
  EXPECT_NEAR(c.camera.k1, lens.at<double>(0), 0.05);
  EXPECT_LT(c.rms, 0.5);
}

TEST(RosCameraInfo, IsReadAsOurOwn) {
  const char* text = R"(image_width: 640
image_height: 480
camera_name: head
camera_matrix:
  rows: 3
  cols: 3
  data: [520.5, 0, 321.5, 0, 519.5, 238.5, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.2, 0.05, 0.001, -0.002, 0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0]
)";
  const models::CameraIntrinsics c = config::parse<models::RosCameraInfo>(text).intrinsics();
  EXPECT_EQ(c.fx, 520.5);
  EXPECT_EQ(c.fy, 519.5);
  EXPECT_EQ(c.cx, 321.5);
  EXPECT_EQ(c.cy, 238.5);
  EXPECT_EQ(c.k1, -0.2);
  EXPECT_EQ(c.p1, 0.001);
  EXPECT_EQ(c.p2, -0.002);
  const std::vector<std::string> fisheye{"distortion_model=equidistant"}, skewed{"camera_matrix.data=[1, 2, 3]"};
  EXPECT_THROW((void)config::parse<models::RosCameraInfo>(text, "x", fisheye), InputError);
  EXPECT_THROW((void)config::parse<models::RosCameraInfo>(text, "x", skewed), InputError);
}

}  // namespace
}  // namespace noctule::sensors
