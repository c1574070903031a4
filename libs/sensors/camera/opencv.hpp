#pragma once
#include "core/image.hpp"

namespace cv {
class Mat;
}

namespace noctule::sensors {

/// The image as OpenCV sees it, without a copy: lives as long as the image, and is not to be written.
[[nodiscard]] cv::Mat as_mat(const Image& image);

}  // namespace noctule::sensors
