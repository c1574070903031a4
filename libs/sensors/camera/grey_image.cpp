#include "sensors/camera/grey_image.hpp"

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "sensors/camera/opencv.hpp"

namespace noctule::sensors {

void check_image(const Image& image, const std::string& what) {
  if (image.consistent()) return;
  throw InputError(what + ": expected width x height x channels bytes in 1 or 3 channels, got " +
                   std::to_string(image.pixels.size()) + " bytes for " + std::to_string(image.width) + " x " +
                   std::to_string(image.height) + " x " + std::to_string(image.channels));
}

void check_image(const Image& image, const std::string& what, int width, int height) {
  check_image(image, what);
  if (image.width == width && image.height == height) return;
  throw InputError(what + ": expected images of " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels as before, got " + std::to_string(image.width) + " x " + std::to_string(image.height));
}

void grey_image(const Image& image, int shrink, cv::Mat& full, cv::Mat& grey) {
  const cv::Mat view = as_mat(image);
  if (image.channels == 3) cv::cvtColor(view, full, cv::COLOR_BGR2GRAY);
  const cv::Mat& source = image.channels == 3 ? full : view;
  if (shrink == 1) {
    source.copyTo(grey);
    return;
  }
  const cv::Size size(image.width / shrink, image.height / shrink);
  cv::resize(source(cv::Rect(0, 0, size.width * shrink, size.height * shrink)), grey, size, 0.0, 0.0, cv::INTER_AREA);
}

}  // namespace noctule::sensors
