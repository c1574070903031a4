#include "eval/segments.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace noctule::eval {
namespace {

using Segments = std::vector<Segment>;
constexpr auto kEvery = SegmentStarts::every_pose;
constexpr auto kEnd = SegmentStarts::end_to_end;

TEST(Segments, BySteps) {
  EXPECT_EQ(segments_by_steps(6, 4, kEvery), (Segments{{0, 4}, {1, 5}}));
  EXPECT_EQ(segments_by_steps(6, 2, kEnd), (Segments{{0, 2}, {2, 4}}));
  EXPECT_TRUE(segments_by_steps(0, 1, kEvery).empty());
  EXPECT_TRUE(segments_by_steps(3, 3, kEnd).empty());
  EXPECT_THROW((void)segments_by_steps(3, 0, kEvery), std::invalid_argument);
}

TEST(Segments, ByDistance) {
  const std::vector<double> way{0.0, 0.5, 0.5, 1.0, 1.5, 2.0};
  EXPECT_EQ(segments_by_distance(way, 1.0, kEvery), (Segments{{0, 3}, {1, 4}, {3, 5}}));
  EXPECT_EQ(segments_by_distance(way, 1.0, kEnd), (Segments{{0, 3}, {3, 5}}));
  EXPECT_EQ(segments_by_distance(way, 0.9, kEnd), (Segments{{0, 3}, {3, 5}}));
  EXPECT_TRUE(segments_by_distance(way, 2.1, kEvery).empty());
  EXPECT_THROW((void)segments_by_distance(way, 0.0, kEvery), std::invalid_argument);
}

TEST(Segments, ByTime) {
  const std::vector<std::int64_t> utimes{0, 100'000, 400'000, 500'000, 1'000'000};
  EXPECT_EQ(segments_by_time(utimes, 0.5, kEvery), (Segments{{0, 3}, {1, 4}, {2, 4}, {3, 4}}));
  EXPECT_EQ(segments_by_time(utimes, 0.3, kEnd), (Segments{{0, 2}, {2, 4}}));
  EXPECT_THROW((void)segments_by_time(utimes, -1.0, kEvery), std::invalid_argument);
}

TEST(Segments, NearestDistance) {
  const std::vector<double> way{0.0, 0.9, 1.05, 3.0, 4.02};
  EXPECT_EQ(segments_nearest_distance(way, 1.0, 0.1), (Segments{{0, 2}, {3, 4}}));
  EXPECT_EQ(segments_nearest_distance(way, 1.0, 0.04), (Segments{{3, 4}}));
  EXPECT_TRUE(segments_nearest_distance({}, 1.0, 0.1).empty());
}

}  // namespace
}  // namespace noctule::eval
