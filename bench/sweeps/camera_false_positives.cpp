/// What the detectors of signs, markers and posts find where there are none: every frame of videos, every picture of
/// folders, and drawn clutter. Usage: camera_false_positives [drawn = 1000] [video, picture or folder ...]
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core/utility.hpp>
#include <string>

#include "core/error.hpp"
#include "datasets/images.hpp"
#include "sensors/camera/make_landmark_detector.hpp"
#include "statistics/sensors/camera_scene.hpp"

namespace {

using namespace noctule;
using namespace noctule::sensors;

struct Counts {
  int frames = 0, signs = 0, markers = 0, posts = 0;
};

std::vector<LandmarkDetectorParameters> parameters() {
  PostDetectorParameters posts;
  posts.catalogue.push_back({.id = 0, .colour = {200.0, 40.0, 40.0}, .radius = 0.06, .height = 0.5});
  return {camera_scene::sign_catalogue(8, 0.3), FiducialParameters{.family = MarkerFamily::aruco_4x4_50}, posts};
}

/// All detectors for pictures of one size.
class Detectors {
 public:
  void look(const Image& image, Counts& counts) {
    if (image.width != width_ || image.height != height_) {
      width_ = image.width;
      height_ = image.height;
      const models::CameraIntrinsics camera{
          .width = width_, .height = height_, .cx = 0.5 * (width_ - 1), .cy = 0.5 * (height_ - 1)};
      all_.clear();
      for (const auto& p : parameters()) all_.push_back(make_landmark_detector(p, camera, {}));
    }
    const CameraImage taken{{}, image};
    ++counts.frames;
    counts.signs += static_cast<int>(all_[0]->detect(taken).detections.size());
    counts.markers += static_cast<int>(all_[1]->detect(taken).detections.size());
    counts.posts += static_cast<int>(all_[2]->detect(taken).detections.size());
  }

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::unique_ptr<LandmarkDetector>> all_;
};

void print(const std::string& what, const Counts& c) {
  std::printf("%s,%d,%d,%d,%d\n", what.c_str(), c.frames, c.signs, c.markers, c.posts);
  std::fflush(stdout);
}

void look_at_files(const std::filesystem::path& path, Detectors& detectors) {
  Counts counts;
  if (std::filesystem::is_directory(path)) {
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".png" && extension != ".jpg") continue;
      const Image image = datasets::read_image(entry.path());
      if (image.width >= 64 && image.height >= 64) detectors.look(image, counts);
    }
  } else if (path.extension() == ".avi" || path.extension() == ".mp4") {
    const auto video = datasets::open_video({.path = path});
    while (auto observation = video->next())
      if (const auto* taken = std::get_if<CameraImage>(&*observation)) detectors.look(taken->image, counts);
  } else {
    detectors.look(datasets::read_image(path), counts);
  }
  print(path.filename().string(), counts);
}

}  // namespace

int main(int argc, char** argv) {
  const int drawn = argc > 1 ? std::max(0, std::atoi(argv[1])) : 1000;
  cv::setNumThreads(1);
  Detectors detectors;
  std::printf("pictures,frames,signs,markers,posts\n");
  try {
    for (int k = 2; k < argc; ++k) look_at_files(argv[k], detectors);
  } catch (const InputError& error) {
    std::fprintf(stderr, "camera_false_positives: %s\n", error.what());
    return 2;
  }
  // Signs of somebody else's catalogue before clutter: what is most like ours.
  Counts counts;
  const models::CameraIntrinsics camera;
  const models::CameraMounting mounting{.height = 0.4};
  for (int frame = 0; frame < drawn; ++frame) {
    Rng rng(10001, stream_id("camera_false_positives"), static_cast<std::uint64_t>(frame));
    const camera_scene::Flat flat{
        camera_scene::printed_sign(100 + frame % 50, 0.3),
        camera_scene::facing(mounting, rng.uniform(0.7, 4.0), rng.uniform(-0.4, 0.4), 0.4, rng.uniform(-1.0, 1.0))};
    detectors.look(camera_scene::photograph(camera, {&flat, 1}, {.noise = rng.uniform(0.0, 15.0)}, rng), counts);
  }
  print("drawn signs of another catalogue", counts);
  return 0;
}
