#include "sensors/camera/target_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "core/limits.hpp"

namespace noctule::sensors {
namespace {

/// A random texture, the same for the same seed, seen through a window; targets are finer than backgrounds.
Image texture(int width, int height, Vector2 shift, int channels = 1, std::uint64_t seed = 7) {
  Image image{width, height, channels, {}};
  std::vector<std::array<double, 3>> waves;  // 12 for each channel: frequencies and phase
  for (std::uint32_t k = 0; k < 12 * static_cast<std::uint32_t>(channels); ++k) {
    Rng rng(seed, stream_id("texture"), 0, k);
    const double pitch = seed == 7 ? 0.15 : 0.3;
    waves.push_back({rng.normal(0.0, pitch), rng.normal(0.0, pitch), rng.uniform(0.0, kTwoPi)});
  }
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
        double level = 128.0;
        for (std::size_t k = 12 * c; k < 12 * c + 12; ++k)
          level += 18.0 * std::sin(waves[k][0] * (u + shift.x()) + waves[k][1] * (v + shift.y()) + waves[k][2]);
        image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(level, 0.0, 255.0)));
      }
    }
  }
  return image;
}

void put(const Image& patch, int left, int top, Image& image) {
  const auto channels = static_cast<std::size_t>(image.channels);
  for (int v = 0; v < patch.height; ++v) {
    const auto from = static_cast<std::size_t>(v * patch.width) * channels;
    const auto to = static_cast<std::size_t>((top + v) * image.width + left) * channels;
    std::copy_n(patch.pixels.begin() + static_cast<std::ptrdiff_t>(from),
                static_cast<std::size_t>(patch.width) * channels,
                image.pixels.begin() + static_cast<std::ptrdiff_t>(to));
  }
}

ImageBox box_at(int left, int top, int size) {
  return {Vector2(left - 0.5, top - 0.5) + Vector2::Constant(0.5 * size), Vector2::Constant(size)};
}

TEST(Appearance, IdenticalPatchHasSimilarityOneAndAnotherHasLess) {
  for (const int channels : {1, 3}) {
    const Image image = texture(160, 120, Vector2::Zero(), channels);
    const ImageBox target = box_at(40, 30, 32);
    FrameFeatures frame(target.size);
    frame.update(image);
    const Appearance appearance({}, frame, target);
    const Similarity same = appearance.compare(frame, target);
    EXPECT_NEAR(same.colour, 1.0, 1e-5);
    EXPECT_NEAR(same.gradient, 1.0, 1e-5);
    EXPECT_NEAR(appearance.log_likelihood(same), 0.0, 2e-3);
    const Similarity other = appearance.compare(frame, box_at(100, 70, 32));
    EXPECT_LT(other.joint(), 0.75);
    EXPECT_TRUE(std::isfinite(appearance.log_likelihood({0.0, 0.0})));
  }
}

TEST(Appearance, DoesNotDependOnBrightnessAndContrastOfGreyImages) {
  Image image = texture(160, 120, Vector2::Zero());
  const ImageBox target = box_at(40, 30, 32);
  FrameFeatures frame(target.size);
  frame.update(image);
  const Appearance appearance({}, frame, target);
  for (std::uint8_t& v : image.pixels) v = static_cast<std::uint8_t>(20 + v / 2);
  frame.update(image);
  EXPECT_GT(appearance.compare(frame, target).joint(), 0.97);
}

TEST(MotionSaliency, TakesOutAPanAndKeepsWhatMoves) {
  for (const EgoMotion kind : {EgoMotion::homography, EgoMotion::similarity}) {
    MotionSaliencyParameters p;
    p.ego_motion = kind;
    MotionSaliency compensated(p);
    p.ego_motion = EgoMotion::none;
    MotionSaliency plain(p);
    const Image patch = texture(24, 24, Vector2::Zero(), 1, 99);
    for (int k = 0; k < 2; ++k) {
      Image image = texture(320, 240, {5.0 * k, 2.0 * k});
      put(patch, 200 + 12 * k, 100, image);
      compensated.update(image);
      plain.update(image);
    }
    EXPECT_TRUE(compensated.compensated());
    EXPECT_FALSE(plain.compensated());
    double total = 0.0, near = 0.0, plain_far = 0.0;
    for (int row = 0; row < compensated.rows(); ++row) {
      for (int column = 0; column < compensated.columns(); ++column) {
        const auto cell = static_cast<std::size_t>(row * compensated.columns() + column);
        const double v = compensated.cells()[cell];
        total += v;
        const Vector2 away = Vector2(8.0 * column + 4.0, 8.0 * row + 4.0) - Vector2(218.0, 112.0);
        (away.norm() < 40.0 ? near : plain_far) += away.norm() < 40.0 ? v : plain.cells()[cell];
      }
    }
    EXPECT_GT(total, 0.0);
    EXPECT_GT(near, 0.9 * total);
    EXPECT_GT(plain_far, 5.0 * (total - near));
    EXPECT_GT(plain_far, 0.5 * near);
  }
}

TEST(MotionSaliency, DensityIntegratesToOneAndIsThatOfTheDraws) {
  MotionSaliency saliency({});
  const Image patch = texture(24, 24, Vector2::Zero(), 1, 99);
  for (int k = 0; k < 2; ++k) {
    Image image = texture(203, 101, Vector2::Zero());  // no multiple of a cell
    put(patch, 60 + 30 * k, 40, image);
    saliency.update(image);
  }
  saliency.prepare({24.0, 24.0});
  double integral = 0.0;
  for (int v = 0; v < 101; ++v) {
    for (int u = 0; u < 203; ++u) {
      const double density = saliency.log_density(Vector2(u, v));
      ASSERT_TRUE(std::isfinite(density));
      integral += std::exp(density);
    }
  }
  EXPECT_NEAR(integral, 1.0, 1e-9);
  EXPECT_EQ(saliency.log_density({-0.6, 50.0}), -kInf);
  EXPECT_EQ(saliency.log_density({202.6, 50.0}), -kInf);
  // E[1/g over the image's area] under g is 1 whatever g.
  double mean = 0.0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    Rng rng(1, 2, static_cast<std::uint64_t>(i));
    mean += std::exp(-saliency.log_density(saliency.draw(rng))) / (203.0 * 101.0 * kDraws);
  }
  EXPECT_NEAR(mean, 1.0, 0.15);  // a weight is at most 20
}

TEST(MotionSaliency, NothingMovesInAStillPicture) {
  MotionSaliency saliency({});
  for (int k = 0; k < 2; ++k) saliency.update(texture(160, 120, Vector2::Zero()));
  EXPECT_EQ(saliency.moving_share(), 0.0);
  saliency.prepare({20.0, 20.0});
  EXPECT_NEAR(saliency.log_density({80.0, 60.0}), -std::log(160.0 * 120.0), 1e-9);
}

TEST(TargetMotion, KalmanProposalsAgreeWhereTheModelIsNearlyLinear) {
  const TargetMotion motion;
  TargetState before;
  before << 100.0, 80.0, 3.0, -1.0, 0.1;
  const TargetMeasurement z(105.0, 81.0, 34.0), sd(3.0, 3.0, 1.0);
  const TargetGaussian e = extended_update(motion, before, 30.0, z, sd),
                       u = unscented_update(motion, before, 30.0, z, sd);
  EXPECT_LT((e.mean - u.mean).cwiseQuotient(motion.noise_sd()).norm(), 0.02);
  EXPECT_LT((e.covariance - u.covariance).norm(), 0.01 * e.covariance.norm());
  // Centre: prior N(103, 16), measured 105 with variance 9.
  EXPECT_NEAR(e.mean[0], (103.0 / 16.0 + 105.0 / 9.0) / (1.0 / 16.0 + 1.0 / 9.0), 1e-9);
  EXPECT_NEAR(e.covariance(0, 0), 1.0 / (1.0 / 16.0 + 1.0 / 9.0), 1e-9);
}

TEST(SearchMixture, WeightsMakeTheMeanThatOfThePriorWhateverTheSaliency) {
  MotionSaliency saliency({});
  for (int k = 0; k < 2; ++k) {
    Image image = texture(160, 120, Vector2::Zero());
    put(texture(24, 24, Vector2::Zero(), 1, 99), 20 + 30 * k, 20, image);
    saliency.update(image);
  }
  saliency.prepare({24.0, 24.0});
  const TargetMotion motion;
  TargetState before;
  before << 100.0, 80.0, 3.0, -1.0, 0.1;
  for (const double local : {0.0, 0.3, 0.8, 1.0}) {
    const SearchMixture mixture{.local = local};
    constexpr int kDraws = 40000;
    double one = 0.0, square = 0.0, x = 0.0, x_square = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      Rng rng(3, stream_id("mixture"), static_cast<std::uint64_t>(i));
      const bool is_local = rng.uniform() < local;
      const TargetDraw draw = mixture.draw(motion, saliency, before, is_local, rng);
      ASSERT_TRUE(std::isfinite(draw.log_ratio));
      const double w = std::exp(draw.log_ratio), wx = w * draw.state[0];
      one += w / kDraws;
      square += w * w / kDraws;
      x += wx / kDraws;
      x_square += wx * wx / kDraws;
    }
    // Prior: N(103, 16) with probability `local`, else uniform over 160 columns.
    const double expected = local * 103.0 + (1.0 - local) * 79.5;
    EXPECT_NEAR(one, 1.0, 4.0 * std::sqrt(std::max(square - one * one, 0.0) / kDraws) + 1e-9) << local;
    EXPECT_NEAR(x, expected, 4.0 * std::sqrt((x_square - x * x) / kDraws)) << local;
  }
}

class TargetTrackers : public ::testing::TestWithParam<TargetProposal> {
 protected:
  TargetTrackerParameters parameters() const {
    TargetTrackerParameters p;
    p.particles = 100;
    p.proposal = GetParam();
    return p;
  }
  static Image frame(int k, int channels = 1) {
    static const Image grey = texture(160, 120, Vector2::Zero()), colour = texture(160, 120, Vector2::Zero(), 3);
    Image image = channels == 1 ? grey : colour;
    put(texture(28, 28, Vector2::Zero(), channels, 99), 40 + 2 * k, 40 + k, image);
    return image;
  }
  static ImageBox truth(int k) { return box_at(40 + 2 * k, 40 + k, 28); }
};

TEST_P(TargetTrackers, FollowATargetAndRepeatThemselves) {
  for (const int channels : {1, 3}) {
    TargetTracker tracker(parameters(), 1), again(parameters(), 1);
    tracker.start(frame(0, channels), truth(0));
    again.start(frame(0, channels), truth(0));
    for (int k = 1; k < 15; ++k) {
      const TargetEstimate e = tracker.track(frame(k, channels));
      EXPECT_GT(overlap(e.box, truth(k)), 0.6) << k;
      EXPECT_FALSE(e.lost);
      EXPECT_EQ(again.track(frame(k, channels)).box, e.box);
    }
    EXPECT_EQ(tracker.particles(), again.particles());
  }
}

TEST_P(TargetTrackers, AreLostInFramesWithNothingToSeeAndNeverNotANumber) {
  TargetTracker tracker(parameters(), 1);
  tracker.start(frame(0), truth(0));
  for (int k = 1; k < 12; ++k) {
    Image image = frame(k);
    if (k >= 3) std::ranges::fill(image.pixels, k % 2 == 0 ? std::uint8_t{0} : std::uint8_t{255});
    const TargetEstimate e = tracker.track(image);
    EXPECT_TRUE(e.box.is_sound());
    EXPECT_TRUE(std::isfinite(e.confidence));
    EXPECT_EQ(e.lost, k >= 4) << k;
    for (const TargetState& s : tracker.particles()) EXPECT_TRUE(s.allFinite());
  }
}

TEST_P(TargetTrackers, RefuseBadInputAndGoOn) {
  TargetTracker tracker(parameters(), 1), undisturbed(parameters(), 1);
  EXPECT_THROW(static_cast<void>(tracker.track(frame(0))), std::logic_error);
  EXPECT_THROW(tracker.start(frame(0), {{500.0, 40.0}, {28.0, 28.0}}), InputError);
  EXPECT_THROW(tracker.start(frame(0), {{60.0, 40.0}, {2.0, 28.0}}), InputError);
  EXPECT_THROW(tracker.start(frame(0), {{kNan, 40.0}, {28.0, 28.0}}), InputError);
  tracker.start(frame(0), truth(0));
  undisturbed.start(frame(0), truth(0));
  EXPECT_THROW(static_cast<void>(tracker.track(texture(80, 60, Vector2::Zero()))), InputError);
  Image broken = frame(1);
  broken.pixels.pop_back();
  EXPECT_THROW(static_cast<void>(tracker.track(broken)), InputError);
  EXPECT_EQ(tracker.track(frame(1)).box, undisturbed.track(frame(1)).box);
}

INSTANTIATE_TEST_SUITE_P(All, TargetTrackers,
                         ::testing::Values(TargetProposal::dynamics, TargetProposal::saliency, TargetProposal::kalman,
                                           TargetProposal::unscented));

TEST(TargetTracker, WeightsAreFiniteWhereAllSearchAndWhereNoneDoes) {
  for (const double search : {0.0, 1.0}) {
    TargetTrackerParameters p;
    p.particles = 100;
    p.least_search = search;
    p.lost_local = 0.0;
    TargetTracker tracker(p, 1);
    Image image = texture(160, 120, Vector2::Zero());
    tracker.start(image, box_at(40, 40, 28));
    for (int k = 0; k < 6; ++k) {
      EXPECT_TRUE(tracker.track(image).box.is_sound());
      EXPECT_TRUE(std::isfinite(tracker.estimate().confidence));
      for (const TargetState& s : tracker.particles()) EXPECT_TRUE(s.allFinite());
    }
    EXPECT_EQ(tracker.local_share(), 1.0 - search);
  }
}

TEST(TargetTracker, OnlySaliencyFindsATargetThatJumps) {
  int found = 0, by_dynamics = 0;
  constexpr int kSeeds = 10;
  const Image background = texture(320, 240, Vector2::Zero()), patch = texture(28, 28, Vector2::Zero(), 1, 99);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    for (const TargetProposal proposal : {TargetProposal::saliency, TargetProposal::dynamics}) {
      TargetTrackerParameters p;
      p.proposal = proposal;
      TargetTracker tracker(p, seed);
      double best = 0.0;
      for (int k = 0; k < 10; ++k) {
        const int left = (k < 6 ? 30 : 200) + 2 * k, top = k < 6 ? 40 : 160;
        Image image = background;
        put(patch, left, top, image);
        if (k == 0) {
          tracker.start(image, box_at(left, top, 28));
          continue;
        }
        const double o = overlap(tracker.track(image).box, box_at(left, top, 28));
        if (k >= 6) best = std::max(best, o);
      }
      (proposal == TargetProposal::saliency ? found : by_dynamics) += best > 0.5 ? 1 : 0;
    }
  }
  EXPECT_GE(found, 9);
  EXPECT_EQ(by_dynamics, 0);
}

}  // namespace
}  // namespace noctule::sensors
