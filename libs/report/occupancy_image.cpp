#include "report/occupancy_image.hpp"

#include <stdexcept>

#include "eval/number_text.hpp"

namespace noctule::report {
namespace {

char shade(float occupancy) {
  constexpr int kOccupied = 0, kFree = 254, kUnknown = 205;
  int value = kUnknown;
  if (occupancy > kOccupiedAbove && occupancy <= 1.0F) value = kOccupied;
  if (occupancy < kFreeBelow && occupancy >= 0.0F) value = kFree;
  return static_cast<char>(value);
}

}  // namespace

std::string to_pgm(const OccupancyImage& image) {
  const auto columns = static_cast<std::size_t>(image.columns), rows = static_cast<std::size_t>(image.rows);
  if (image.columns < 0 || image.rows < 0 || image.occupancy.size() != columns * rows) {
    throw std::invalid_argument("occupancy image: the number of cells is not columns x rows");
  }
  std::string pgm = "P5\n" + std::to_string(columns) + " " + std::to_string(rows) + "\n255\n";
  for (std::size_t row = rows; row-- > 0;) {
    for (std::size_t column = 0; column < columns; ++column) pgm += shade(image.occupancy[row * columns + column]);
  }
  return pgm;
}

std::string to_map_yaml(const OccupancyImage& image, const std::string& image_name) {
  return "image: " + image_name + "\nmode: trinary\nresolution: " + eval::shortest(image.resolution) + "\norigin: [" +
         eval::shortest(image.origin.x()) + ", " + eval::shortest(image.origin.y()) + ", 0]\nnegate: 0" +
         "\noccupied_thresh: " + eval::shortest(kOccupiedAbove) + "\nfree_thresh: " + eval::shortest(kFreeBelow) + "\n";
}

}  // namespace noctule::report
