#include "eval/box_overlap.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/limits.hpp"

namespace noctule::eval {
namespace {

TEST(BoxOverlap, OfShiftedAndScaledBoxes) {
  const ImageBox box{{10.0, 20.0}, {8.0, 4.0}};
  EXPECT_DOUBLE_EQ(overlap(box, box), 1.0);
  EXPECT_DOUBLE_EQ(overlap(box, {{14.0, 20.0}, {8.0, 4.0}}), 16.0 / 48.0);
  EXPECT_DOUBLE_EQ(overlap(box, {{10.0, 20.0}, {4.0, 2.0}}), 0.25);
  EXPECT_DOUBLE_EQ(overlap(box, {{18.0, 20.0}, {8.0, 4.0}}), 0.0);   // they touch
  EXPECT_DOUBLE_EQ(overlap(box, {{100.0, 20.0}, {8.0, 4.0}}), 0.0);  // far in one direction only
  EXPECT_DOUBLE_EQ(overlap(box, {{10.0, 20.0}, {0.0, 4.0}}), 0.0);
  EXPECT_DOUBLE_EQ(overlap(box, {{kNan, 20.0}, {8.0, 4.0}}), 0.0);
}

TEST(BoxTrackScores, OfAPerfectAShiftedAndALostTrack) {
  const std::vector<ImageBox> truth(10, ImageBox{{50.0, 50.0}, {20.0, 20.0}});
  const BoxTrackScores same = box_track_scores(truth, truth);
  EXPECT_DOUBLE_EQ(same.overlap, 1.0);
  EXPECT_NEAR(same.success_auc, 20.0 / 21.0, 1e-12);  // no overlap exceeds 1
  EXPECT_DOUBLE_EQ(same.precision20, 1.0);
  EXPECT_DOUBLE_EQ(same.centre_rmse, 0.0);
  auto half = truth;
  for (std::size_t i = 0; i < 5; ++i) half[i].centre.x() += 30.0;
  const BoxTrackScores lost = box_track_scores(half, truth);
  EXPECT_DOUBLE_EQ(lost.overlap, 0.5);
  EXPECT_DOUBLE_EQ(lost.precision20, 0.5);
  EXPECT_DOUBLE_EQ(lost.centre_rmse, std::sqrt(450.0));
  EXPECT_TRUE(std::isnan(box_track_scores({}, {}).overlap));
  EXPECT_TRUE(std::isnan(box_track_scores({}, {}).success_auc));
  EXPECT_THROW(static_cast<void>(box_track_scores(half, {})), std::invalid_argument);
}

TEST(Reacquisitions, CountFramesUntilTheNextLoss) {
  const std::vector<double> overlaps{1.0, 0.1, 0.5, 0.6, 0.9, 0.0, 0.0, 0.8, 0.0, 0.0};
  const auto back = reacquisitions(overlaps, std::vector{1, 5, 7, 8});
  ASSERT_EQ(back.size(), 4u);
  EXPECT_TRUE(back[0].found);
  EXPECT_EQ(back[0].frames, 2);  // 0.5 is not more than 0.5
  EXPECT_FALSE(back[1].found);
  EXPECT_EQ(back[1].frames, 2);
  EXPECT_TRUE(back[2].found);
  EXPECT_EQ(back[2].frames, 0);
  EXPECT_FALSE(back[3].found);
  EXPECT_THROW(static_cast<void>(reacquisitions(overlaps, std::vector{3, 2})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(reacquisitions(overlaps, std::vector{10})), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::eval
