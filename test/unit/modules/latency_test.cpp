#include "modules/latency.hpp"

#include <gtest/gtest.h>

namespace noctule::modules {
namespace {

TEST(LatencyHistogram, PercentilesAreWithinThreePercent) {
  LatencyHistogram histogram;
  for (int i = 1; i <= 100000; ++i) histogram.add(1e-6 * i);
  EXPECT_EQ(histogram.count(), 100000);
  for (const double fraction : {0.01, 0.5, 0.95, 0.99}) {
    EXPECT_NEAR(histogram.percentile(fraction), 0.1 * fraction, 0.03 * 0.1 * fraction);
  }
  EXPECT_EQ(histogram.percentile(1.0), 0.1);
  EXPECT_EQ(histogram.max(), 0.1);
}

TEST(LatencyHistogram, HoldsWhatIsBeyondItsScale) {
  LatencyHistogram histogram;
  histogram.add(0.0);
  histogram.add(1e9);
  EXPECT_EQ(histogram.count(), 2);
  EXPECT_EQ(histogram.max(), 1e9);
  EXPECT_LE(histogram.percentile(0.5), 2e-8);
}

TEST(LatencyHistogram, EmptyIsZero) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentile(0.5), 0.0);
  histogram.add(1.0);
  histogram.clear();
  EXPECT_EQ(histogram.count(), 0);
  EXPECT_EQ(histogram.percentile(0.99), 0.0);
}

}  // namespace
}  // namespace noctule::modules
