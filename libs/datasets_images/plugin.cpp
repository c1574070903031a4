/// The plug-in behind datasets/images.hpp: the only code that links OpenCV's coders.
#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "datasets/images.hpp"

namespace noctule::datasets {
namespace {

/// Copies 8-bit pixels; nothing else is a picture here.
bool copy(const cv::Mat& from, Image& to) {
  if (from.empty() || from.depth() != CV_8U || (from.channels() != 1 && from.channels() != 3)) return false;
  to.width = from.cols;
  to.height = from.rows;
  to.channels = from.channels();
  const auto row = static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.channels);
  to.pixels.resize(row * static_cast<std::size_t>(to.height));
  for (int y = 0; y < to.height; ++y) {
    std::copy_n(from.ptr<std::uint8_t>(y), row, to.pixels.begin() + static_cast<std::ptrdiff_t>(row) * y);
  }
  return true;
}

/// A JPEG that ends too early decodes to a picture with a grey rest: its last bytes say so.
bool cut_off(std::span<const std::uint8_t> bytes) {
  const std::size_t n = bytes.size();
  const bool jpeg = n > 3 && bytes[0] == 0xff && bytes[1] == 0xd8;
  if (!jpeg) return false;
  const auto tail = bytes.last(std::min<std::size_t>(n, 64));  // cameras may pad
  constexpr std::uint8_t kEnd[] = {0xff, 0xd9};
  return std::ranges::search(tail, kEnd).empty();
}

/// Spoiled bytes may ask for gigabytes: a JPEG's size stands in its first "start of frame".
bool too_large(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMostPixels = 64'000'000;
  if (bytes.size() < 4 || bytes[0] != 0xff || bytes[1] != 0xd8) return false;
  const auto number = [&](std::size_t i) { return std::size_t{bytes[i]} << 8 | bytes[i + 1]; };
  for (std::size_t i = 2; i + 9 < bytes.size() && bytes[i] == 0xff;) {
    const std::uint8_t marker = bytes[i + 1];
    const bool start_of_frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (start_of_frame) return number(i + 5) * number(i + 7) > kMostPixels;
    i += 2 + number(i + 2);
  }
  return true;  // no size, no picture
}

bool decode(std::span<const std::uint8_t> bytes, Image& image) {
  if (bytes.empty() || cut_off(bytes) || too_large(bytes)) return false;
  try {
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8U, const_cast<std::uint8_t*>(bytes.data()));
    const cv::Mat decoded = cv::imdecode(raw, cv::IMREAD_ANYCOLOR);
    return copy(decoded, image);
  } catch (const cv::Exception&) {
    return false;
  }
}

bool encode(const Image& image, const std::string& extension, int quality, std::vector<std::uint8_t>& bytes) {
  try {
    const cv::Mat pixels(image.height, image.width, image.channels == 1 ? CV_8UC1 : CV_8UC3,
                         const_cast<std::uint8_t*>(image.pixels.data()));
    std::vector<int> options;
    if (extension == ".jpg" || extension == ".jpeg") options = {cv::IMWRITE_JPEG_QUALITY, quality};
    return cv::imencode(extension, pixels, bytes, options);
  } catch (const cv::Exception&) {
    return false;
  }
}

class Capture : public VideoStream {
 public:
  explicit Capture(cv::VideoCapture capture) : capture_(std::move(capture)) {}

  bool next(Image& image, double& time) override {
    if (!capture_.read(frame_) || !copy(frame_, image)) return false;
    time = 1e-3 * capture_.get(cv::CAP_PROP_POS_MSEC);
    return true;
  }

 private:
  cv::VideoCapture capture_;
  cv::Mat frame_;
};

VideoStream* open_file(const std::string& path) {
  // Named, for else OpenCV asks every camera driver it knows whether the file is its device.
  cv::VideoCapture capture(path, cv::CAP_FFMPEG);
  return capture.isOpened() ? new Capture(std::move(capture)) : nullptr;
}

VideoStream* open_device(const CameraDeviceParameters& p) {
  cv::VideoCapture capture(p.device, cv::CAP_V4L2);
  if (!capture.isOpened()) return nullptr;
  capture.set(cv::CAP_PROP_FRAME_WIDTH, p.width);
  capture.set(cv::CAP_PROP_FRAME_HEIGHT, p.height);
  capture.set(cv::CAP_PROP_FPS, p.rate);
  return new Capture(std::move(capture));
}

/// Problems are told by the caller, in one line.
const auto kQuiet = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);

}  // namespace
}  // namespace noctule::datasets

extern "C" {
extern const noctule::datasets::ImagePlugin noctule_image_plugin;
const noctule::datasets::ImagePlugin noctule_image_plugin{&noctule::datasets::decode, &noctule::datasets::encode,
                                                          &noctule::datasets::open_file,
                                                          &noctule::datasets::open_device};
}
