#include "datasets/images.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "core/error.hpp"
#include "core/rng.hpp"

namespace noctule::datasets {
namespace {

namespace fs = std::filesystem;

Image gradient(int width, int height, int channels) {
  Image image{width, height, channels, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) image.pixels.push_back(static_cast<std::uint8_t>(2 * x + 3 * y + 40 * c));
    }
  }
  return image;
}

template <class Action>
std::string refusal(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

class ImagesTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_ = fs::temp_directory_path() / ("noctule_images_" + std::to_string(::getpid()));
};

TEST_F(ImagesTest, PngKeepsEveryBitAndJpegAlmost) {
  for (const int channels : {1, 3}) {
    const Image image = gradient(37, 21, channels);
    write_image(folder_ / "a.png", image);
    EXPECT_EQ(read_image(folder_ / "a.png"), image);
    const Image jpeg = decode_image(encode_jpeg(image, 95));
    ASSERT_EQ(jpeg.channels, channels);
    ASSERT_EQ(jpeg.pixels.size(), image.pixels.size());
    double squares = 0.0;
    for (std::size_t i = 0; i < jpeg.pixels.size(); ++i) squares += std::pow(jpeg.pixels[i] - image.pixels[i], 2);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(jpeg.pixels.size())), 4.0);
  }
}

TEST_F(ImagesTest, DamagedPicturesAreRefusedAndNameTheirFile) {
  const std::vector<std::uint8_t> whole = encode_jpeg(gradient(64, 48, 3));
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 50) {
    EXPECT_THROW(static_cast<void>(decode_image(std::span(whole).first(size))), InputError) << size << " bytes";
  }
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {  // wrong bytes: a picture or a refusal, nothing else
    std::vector<std::uint8_t> spoiled = whole;
    for (int k = 0; k < 5; ++k) spoiled[rng.index(spoiled.size())] = static_cast<std::uint8_t>(rng.index(256));
    try {
      EXPECT_TRUE(decode_image(spoiled).consistent());
    } catch (const InputError&) {
    }
  }
  std::ofstream(folder_ / "no.png") << "this is a letter";
  EXPECT_EQ(refusal([&] { static_cast<void>(read_image(folder_ / "no.png")); }),
            (folder_ / "no.png").string() + ": expected a picture, got 16 bytes that are none");
  EXPECT_THROW(static_cast<void>(read_image(folder_ / "absent.png")), InputError);
  EXPECT_THROW(static_cast<void>(encode_jpeg({3, 3, 1, {1, 2}})), InputError);
  EXPECT_THROW(write_image(folder_ / "name.txt", gradient(8, 8, 1)), InputError);
}

TEST_F(ImagesTest, AFolderIsPlayedInTheOrderOfItsNames) {
  for (const char* name : {"b.png", "a.png", "c.png"}) write_image(folder_ / name, gradient(8 + name[0] - 'a', 8, 1));
  std::ofstream(folder_ / "notes.txt") << "no picture";
  const auto play = [&](const ImageFolderParameters& p) {
    std::vector<std::pair<std::int64_t, int>> seen;
    const auto source = open_images(p);
    while (const auto o = source->next()) {
      const auto& image = std::get<CameraImage>(*o);
      EXPECT_EQ(image.stamp.seq, static_cast<std::int64_t>(seen.size()));
      seen.emplace_back(image.stamp.utime, image.image.width);
    }
    return seen;
  };
  using Seen = std::vector<std::pair<std::int64_t, int>>;
  EXPECT_EQ(play({folder_, 4.0, {}}), (Seen{{0, 8}, {250'000, 9}, {500'000, 10}}));
  const fs::path times = folder_ / "times.txt";
  std::ofstream(times) << "1.5\n1.75\n4\n";
  EXPECT_EQ(play({folder_, 4.0, times}), (Seen{{1'500'000, 8}, {1'750'000, 9}, {4'000'000, 10}}));
  std::ofstream(times) << "1.5\n1.25\n4\n";
  EXPECT_THROW(play({folder_, 4.0, times}), InputError) << "a clock that jumps back";
  std::ofstream(times) << "1.5\n1.75\n";
  EXPECT_NE(refusal([&] {
              play({folder_, 4.0, times});
            }).find("expected 3 times, one for each picture, got 2"),
            std::string::npos);
  fs::create_directory(folder_ / "empty");
  EXPECT_THROW(static_cast<void>(open_images({folder_ / "empty", 4.0, {}})), InputError);
  EXPECT_THROW(static_cast<void>(open_images({folder_ / "absent", 4.0, {}})), InputError);
  std::ofstream(folder_ / "b.png") << "broken";
  EXPECT_NE(refusal([&] { play({folder_, 4.0, {}}); }).find("b.png: expected a picture"), std::string::npos);
}

TEST_F(ImagesTest, VideosAndCamerasThatAreNotThere) {
  std::ofstream(folder_ / "film.avi") << "no film";
  EXPECT_NE(refusal([&] {
              static_cast<void>(open_video({folder_ / "film.avi", 0.0}));
            }).find("expected a video"),
            std::string::npos);
  EXPECT_THROW(static_cast<void>(open_video({folder_ / "absent.avi", 0.0})), InputError);
  EXPECT_EQ(refusal([] { static_cast<void>(open_camera({.device = 250})); }),
            "/dev/video250: expected a camera, got none that can be opened");
}

TEST_F(ImagesTest, AVideoYieldsItsPicturesInTime) {
  const fs::path film = "/usr/share/doc/opencv-doc/examples/data/vtest.avi";
  if (!fs::exists(film)) GTEST_SKIP() << "opencv-doc is not installed, or its videos are compressed";
  const auto source = open_video({film, 0.0});
  std::int64_t last = -1;
  for (int i = 0; i < 20; ++i) {
    const auto o = source->next();
    ASSERT_TRUE(o.has_value());
    const auto& image = std::get<CameraImage>(*o);
    EXPECT_EQ(image.stamp.seq, i);
    EXPECT_GT(image.stamp.utime, last);
    EXPECT_TRUE(image.image.consistent());
    EXPECT_EQ(image.image.width, 768);
    last = image.stamp.utime;
  }
  EXPECT_NEAR(static_cast<double>(last), 19 * 1e5, 2e5) << "ten pictures a second";
}

}  // namespace
}  // namespace noctule::datasets
