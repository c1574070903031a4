#include "datasets/boxed_images.hpp"

#include <algorithm>
#include <cstdio>

#include "core/error.hpp"
#include "datasets/images.hpp"
#include "datasets/table.hpp"

namespace noctule::datasets {

BoxedImages read_boxed_images(const BoxedImagesParameters& parameters) {
  const Table table(parameters.path / "groundtruth_rect.txt",
                    {.columns = {"x", "y", "width", "height"}, .separator = ','});
  BoxedImages all;
  const int count = parameters.frames > 0 ? std::min(parameters.frames, table.rows()) : table.rows();
  for (int k = 0; k < count; ++k) {
    const Vector2 corner(table(k, 0), table(k, 1)), size(table.at_least(1.0, k, 2), table.at_least(1.0, k, 3));
    all.boxes.push_back({corner - Vector2(1.5, 1.5) + 0.5 * size, size});
    char name[16];
    std::snprintf(name, sizeof name, "%04d.jpg", k + 1);
    const auto file = parameters.path / "img" / name;
    all.images.push_back(read_image(file));
    const Image &first = all.images.front(), &last = all.images.back();
    if (last.width != first.width || last.height != first.height || last.channels != first.channels) {
      throw InputError(file.string() + ": expected a picture of " + std::to_string(first.width) + " x " +
                       std::to_string(first.height) + " x " + std::to_string(first.channels) + " as before, got " +
                       std::to_string(last.width) + " x " + std::to_string(last.height) + " x " +
                       std::to_string(last.channels));
    }
  }
  return all;
}

}  // namespace noctule::datasets
