#pragma once
/// Images as OpenCV sees them; only for sources of this room.
#include <string>

#include "core/image.hpp"

namespace cv {
class Mat;
}

namespace noctule::sensors {

/// \throws InputError `WHAT: expected .., got ..` for an inconsistent image
void check_image(const Image& image, const std::string& what);
/// and for one that is not of this size
void check_image(const Image& image, const std::string& what, int width, int height);

/// Grey levels, each of a square of shrink x shrink pixels averaged; what is left over at the right and lower edge is
/// left out. \param full scratch
void grey_image(const Image& image, int shrink, cv::Mat& full, cv::Mat& grey);

}  // namespace noctule::sensors
