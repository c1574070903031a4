/// Pictures in, sightings out; whatever cannot be looked at is counted, and the next picture is looked at again.
#include "modules/camera_module.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "datasets/images.hpp"
#include "heard.hpp"
#include "noctule/camera_image.hpp"
#include "noctule/landmark_detections.hpp"
#include "sim/camera.hpp"

namespace noctule::modules {
namespace {

sim::RoomParameters room_with_signs() {
  sim::RoomParameters room;
  room.walls = {{"south", 2.0, radians(270)}, {"east", 2.0, 0.0}, {"north", 2.0, radians(90)}, {"west", 2.0, kPi}};
  room.signs = {{.landmark = 4, .picture = 1, .wall = "east", .offset = -0.4, .height = 0.35, .size = 0.3},
                {.landmark = 7, .picture = 2, .wall = "east", .offset = 0.4, .height = 0.35, .size = 0.3}};
  return room;
}

sensors::LandmarkCameraParameters looking_for_signs() {
  sensors::SignDetectorParameters signs;
  signs.catalogue = {{4, {}, 1, 0.3}, {7, {}, 2, 0.3}};
  sensors::LandmarkCameraParameters parameters;
  parameters.intrinsics.emplace();
  parameters.mounting.emplace();
  parameters.detectors = {{signs}};
  return parameters;
}

class CameraModuleTest : public ::testing::Test {
 protected:
  void SetUp() override {
    sim::CameraParameters camera;
    image_ = sim::Camera(camera, room_with_signs(), 1).shoot({0, 0, 0}, {0, 0, 0}, 0, 0.0);
    module_ = std::make_unique<CameraModule>(bus_, looking_for_signs());
  }
  /// Publishes a picture under the next number, a second after the one before.
  void show(camera_image message) {
    message.seq = shown_++;
    message.utime = 1'000'000 * shown_;
    bus_.publish("CAMERA_IMAGE", message);
    bus_.drain();
  }
  void show(const Image& image) { show(convert::to_message(CameraImage{{}, image})); }
  [[nodiscard]] module_status status() {
    module_->finish();
    bus_.drain();
    return statuses_.all.back();
  }

  bus::Bus bus_;
  Heard<landmark_detections> sightings_{bus_, "LANDMARK_DETECTIONS"};
  Heard<module_status> statuses_{bus_, "MODULE_STATUS"};
  std::unique_ptr<CameraModule> module_;
  CameraImage image_;
  std::int64_t shown_ = 0;
};

TEST_F(CameraModuleTest, SightingsCarryNumberTimeAndPlaceOfTheirPicture) {
  show(Image{640, 480, 1, std::vector<std::uint8_t>(640 * 480, 128)});  // nothing in it
  show(image_.image);
  ASSERT_EQ(sightings_.all.size(), 2u);
  EXPECT_EQ(sightings_.all[0].detection_count, 0);
  const landmark_detections& seen = sightings_.all[1];
  EXPECT_EQ(seen.seq, 1);
  EXPECT_EQ(seen.utime, 2'000'000);
  ASSERT_EQ(seen.detection_count, 2);
  for (const landmark_detection& d : seen.detections) {
    const double side = d.id == 4 ? 0.4 : -0.4;
    EXPECT_TRUE(d.id == 4 || d.id == 7);
    const double sd_range = std::sqrt(d.covariance_range_bearing_m_rad[0][0]);
    const double sd_bearing = std::sqrt(d.covariance_range_bearing_m_rad[1][1]);
    EXPECT_GE(sd_bearing, radians(0.1)) << "no calibration is better";
    EXPECT_NEAR(d.range_m, std::hypot(2.0, side), 4.0 * sd_range);
    EXPECT_NEAR(d.bearing_rad, std::atan2(side, 2.0), 4.0 * sd_bearing);
  }
  ASSERT_TRUE(module_->example().has_value());
  EXPECT_EQ(module_->example()->landmarks.size(), 2u);
  EXPECT_EQ(module_->example()->image, image_.image);
  EXPECT_EQ(status().errors, 0);
}

TEST_F(CameraModuleTest, JpegIsAsGoodAsRaw) {
  camera_image message = convert::to_message(image_);
  message.encoding = camera_image::ENCODING_JPEG;
  message.bytes = datasets::encode_jpeg(image_.image, 90);
  message.byte_count = static_cast<std::int32_t>(message.bytes.size());
  show(message);
  ASSERT_EQ(sightings_.all.size(), 1u);
  EXPECT_EQ(sightings_.all[0].detection_count, 2);
}

TEST_F(CameraModuleTest, WhatCannotBeLookedAtIsCountedAndTheNextIsSeen) {
  show(Image{640, 480, 3, std::vector<std::uint8_t>(640 * 480 * 3, 0)});
  show(Image{640, 480, 3, std::vector<std::uint8_t>(640 * 480 * 3, 255)});
  show(Image{320, 240, 1, std::vector<std::uint8_t>(320 * 240, 128)});
  camera_image broken = convert::to_message(image_);
  broken.encoding = camera_image::ENCODING_JPEG;
  broken.bytes = datasets::encode_jpeg(image_.image, 90);
  broken.bytes.resize(broken.bytes.size() / 2);
  broken.byte_count = static_cast<std::int32_t>(broken.bytes.size());
  show(broken);
  camera_image short_of_pixels = convert::to_message(image_);
  short_of_pixels.bytes.pop_back();
  --short_of_pixels.byte_count;
  show(short_of_pixels);
  EXPECT_TRUE(sightings_.all.empty());
  show(image_.image);
  ASSERT_EQ(sightings_.all.size(), 1u);
  EXPECT_EQ(sightings_.all[0].detection_count, 2);
  const module_status end = status();
  EXPECT_EQ(end.dropped, 2) << "black and saturated";
  EXPECT_EQ(end.errors, 3) << end.last_error;
}

TEST_F(CameraModuleTest, AClockThatJumpsBackCostsOnePicture) {
  show(image_.image);
  shown_ = 5;
  show(image_.image);
  camera_image early = convert::to_message(image_);
  early.seq = shown_++;
  early.utime = 10;
  bus_.publish("CAMERA_IMAGE", early);
  bus_.drain();
  EXPECT_EQ(sightings_.all.size(), 2u);
  early.seq = shown_++;
  early.utime = 20;
  bus_.publish("CAMERA_IMAGE", early);
  bus_.drain();
  EXPECT_EQ(sightings_.all.size(), 3u);
  EXPECT_EQ(status().dropped, 1);
}

TEST_F(CameraModuleTest, NoPictureAtAllIsSaid) {
  EXPECT_NE(status().warning.find("no image has come"), std::string::npos);
}

TEST(CameraModuleParameters, WhatIsMissingIsNamed) {
  auto parameters = looking_for_signs();
  EXPECT_EQ(parameters.validate(), "");
  parameters.detectors.clear();
  EXPECT_EQ(parameters.validate(), "detectors: expected at least one, got none");
  parameters.mounting.reset();
  EXPECT_EQ(parameters.validate(), "mounting: expected where the camera sits on the robot, got nothing");
  parameters.intrinsics.reset();
  EXPECT_EQ(parameters.validate(), "intrinsics: expected the calibration of the camera, got none");
  bus::Bus bus;
  EXPECT_THROW(CameraModule(bus, parameters), InputError);
}

}  // namespace
}  // namespace noctule::modules
