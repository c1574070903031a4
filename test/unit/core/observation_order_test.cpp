#include "core/observation_order.hpp"

#include <gtest/gtest.h>

namespace noctule {
namespace {

template <class Kind>
Observation at(std::int64_t utime) {
  Kind value;
  value.stamp.utime = utime;
  return value;
}

TEST(PutInOrder, SortsByTimeThenOdometryThenTruthThenSightings) {
  std::vector<Observation> o{at<UltrasonicScan>(5), at<GroundTruth>(5), at<Odometry>(5), at<LandmarkDetections>(5),
                             at<GroundTruth>(2)};
  put_in_order(o);
  EXPECT_TRUE(std::holds_alternative<GroundTruth>(o[0]));
  EXPECT_TRUE(std::holds_alternative<Odometry>(o[1]));
  EXPECT_TRUE(std::holds_alternative<GroundTruth>(o[2]));
  EXPECT_TRUE(std::holds_alternative<UltrasonicScan>(o[3]));
  EXPECT_TRUE(std::holds_alternative<LandmarkDetections>(o[4]));
}

TEST(PutInOrder, NumbersEachKindFromZeroWithoutGaps) {
  std::vector<Observation> o{at<Odometry>(3), at<GroundTruth>(1), at<Odometry>(2), at<GroundTruth>(9)};
  put_in_order(o);
  EXPECT_EQ(stamp_of(o[0]), (Stamp{1, 0}));
  EXPECT_EQ(stamp_of(o[1]), (Stamp{2, 0}));
  EXPECT_EQ(stamp_of(o[2]), (Stamp{3, 1}));
  EXPECT_EQ(stamp_of(o[3]), (Stamp{9, 1}));
}

}  // namespace
}  // namespace noctule
