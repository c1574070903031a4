#pragma once
/// Sequences of the Visual Tracker Benchmark (OTB; Wu, Lim and Yang, CVPR 2013): a folder `img` of pictures 0001.jpg
/// ... and `groundtruth_rect.txt` with a line `x,y,width,height` for each, x and y of the first pixel counted from 1.
#include <filesystem>
#include <vector>

#include "core/image.hpp"
#include "core/image_box.hpp"
#include "core/parameters.hpp"

namespace noctule::datasets {

struct BoxedImagesParameters {
  std::filesystem::path path;
  int frames = 0;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("path", &BoxedImagesParameters::path, "folder of the sequence");
    v.field("frames", &BoxedImagesParameters::frames, unit::one, "how many from the first on; 0: all", at_least(0));
  }
};

struct BoxedImages {
  std::vector<Image> images;
  std::vector<ImageBox> boxes;  ///< one an image
};

/// \throws InputError for a file that is missing, damaged or of another size, or a box without an area
[[nodiscard]] BoxedImages read_boxed_images(const BoxedImagesParameters& parameters);

}  // namespace noctule::datasets
