#include "modules/occupancy_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace noctule::modules {
namespace {

TEST(OccupancyImage, FreeBeforeTheEchoOccupiedAtItUnknownElsewhere) {
  mapping::PosedScan posed;
  posed.scan.half_angle = radians(10.0);
  posed.scan.min_range = 0.02;
  posed.scan.max_range = 4.0;
  for (int i = 0; i < 20; ++i) posed.scan.beams.push_back({{}, 1.0, Echo::hit});
  posed.base_in_map = {0.02, 0.02, 0.0};
  const report::OccupancyImage image = occupancy_image(std::vector{posed}, {});

  const auto at = [&](double x, double y) {
    const int column = static_cast<int>((x - image.origin.x()) / image.resolution);
    const int row = static_cast<int>((y - image.origin.y()) / image.resolution);
    return image.occupancy.at(static_cast<std::size_t>(row * image.columns + column));
  };
  ASSERT_EQ(image.occupancy.size(), static_cast<std::size_t>(image.rows) * static_cast<std::size_t>(image.columns));
  EXPECT_GE(at(0.5, 0.02), 0.0F);
  EXPECT_LT(at(0.5, 0.02), 0.4F);
  EXPECT_GT(at(1.02, 0.02), 0.6F);
  EXPECT_LT(*std::ranges::min_element(image.occupancy), 0.0F) << "some cells are unknown";
}

}  // namespace
}  // namespace noctule::modules
