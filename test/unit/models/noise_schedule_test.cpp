#include "models/noise_schedule.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace noctule::models {
namespace {

TEST(NoiseSchedule, LastStageBegunIsInForce) {
  const std::vector<NoiseStage> stages{{0.0, 1.0}, {1.0 / 3, 4.0}, {2.0 / 3, 2.0}};
  EXPECT_EQ(noise_factor(stages, 0.0), 1.0);
  EXPECT_EQ(noise_factor(stages, 0.33), 1.0);
  EXPECT_EQ(noise_factor(stages, 1.0 / 3), 4.0);
  EXPECT_EQ(noise_factor(stages, 0.66), 4.0);
  EXPECT_EQ(noise_factor(stages, 0.67), 2.0);
  EXPECT_EQ(noise_factor(stages, 1.0), 2.0);
}

TEST(NoiseSchedule, IsNominalWithoutStagesAndBeforeTheFirst) {
  EXPECT_EQ(noise_factor({}, 0.5), 1.0);
  const std::vector<NoiseStage> late{{0.5, 3.0}};
  EXPECT_EQ(noise_factor(late, 0.4), 1.0);
}

TEST(NoiseSchedule, RefusesStagesOutOfOrder) {
  EXPECT_EQ(check_order(std::vector<NoiseStage>{{0.0, 1.0}, {0.5, 2.0}}), "");
  EXPECT_NE(check_order(std::vector<NoiseStage>{{0.5, 1.0}, {0.5, 2.0}}).find("stage 2"), std::string::npos);
}

}  // namespace
}  // namespace noctule::models
