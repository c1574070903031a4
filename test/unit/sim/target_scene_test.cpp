#include "sim/target_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace noctule::sim {
namespace {

TargetFilmParameters with(TargetFilm film) {
  TargetFilmParameters p;
  p.film = film;
  return p;
}

constexpr TargetFilm kFilms[] = {TargetFilm::smooth,    TargetFilm::oscillation, TargetFilm::teleport,
                                 TargetFilm::occlusion, TargetFilm::pan,         TargetFilm::distractor,
                                 TargetFilm::lighting,  TargetFilm::still};

TEST(TargetScene, SameSeedSameFilmInAnyOrder) {
  const TargetScene a(with(TargetFilm::distractor), 3), b(with(TargetFilm::distractor), 3);
  const Image late = a.frame(20), early = a.frame(4);
  EXPECT_EQ(b.frame(4), early);
  EXPECT_EQ(b.frame(20), late);
  EXPECT_NE(TargetScene(with(TargetFilm::distractor), 4).frame(4), early);
}

TEST(TargetScene, TargetsStayInTheImage) {
  for (const TargetFilm film : kFilms) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const TargetScene scene(with(film), seed);
      EXPECT_TRUE(scene.frame(0).consistent());
      for (int k = 0; k < scene.frames(); ++k) {
        const ImageBox box = scene.truth(k);
        EXPECT_GE((box.centre - 0.5 * box.size).minCoeff(), 0.0);
        EXPECT_LE(box.centre.x() + 0.5 * box.size.x(), 320.0);
        EXPECT_LE(box.centre.y() + 0.5 * box.size.y(), 240.0);
      }
    }
  }
}

TEST(TargetScene, WhatIsPaintedIsWhereTruthSays) {
  TargetFilmParameters p = with(TargetFilm::smooth);
  p.noise_sd = 0.0;
  const TargetScene scene(p, 2);
  // A still background: what differs between two frames lies in the two boxes.
  const Image a = scene.frame(0), b = scene.frame(40);
  const ImageBox from = scene.truth(0), to = scene.truth(40);
  int inside = 0, outside = 0;
  for (int v = 0; v < a.height; ++v) {
    for (int u = 0; u < a.width; ++u) {
      const auto at = static_cast<std::size_t>(3 * (v * a.width + u));
      if (std::equal(a.pixels.begin() + static_cast<std::ptrdiff_t>(at),
                     a.pixels.begin() + static_cast<std::ptrdiff_t>(at) + 3,
                     b.pixels.begin() + static_cast<std::ptrdiff_t>(at)))
        continue;
      const Vector2 pixel(u, v);
      const bool within = (pixel - from.centre).norm() <= 17.5 || (pixel - to.centre).norm() <= 17.5;
      ++(within ? inside : outside);
    }
  }
  EXPECT_EQ(outside, 0);
  EXPECT_GT(inside, 800);
}

TEST(TargetScene, JumpsAndHidesAsItSays) {
  const TargetScene jumps(with(TargetFilm::teleport), 1);
  EXPECT_EQ(jumps.losses(), (std::vector<int>{60, 120}));
  EXPECT_NEAR(std::abs(jumps.truth(60).centre.x() - jumps.truth(59).centre.x()), 150.0, 2.0);
  const TargetScene hides(with(TargetFilm::occlusion), 1);
  int hidden = 0, longest = 0;
  for (int k = 0; k < hides.frames(); ++k) {
    hidden = hides.visible(k) <= 0.0 ? hidden + 1 : 0;
    longest = std::max(longest, hidden);
  }
  EXPECT_NEAR(longest, 15, 1);
  EXPECT_FALSE(hides.losses().empty());
  for (const int k : hides.losses()) EXPECT_GE(hides.visible(k), 0.5);
  const TargetScene still(with(TargetFilm::still), 1);
  EXPECT_EQ(still.truth(0), still.truth(100));
}

TEST(TargetScene, RefusesWhatMakesNoFilm) {
  TargetFilmParameters p;
  p.width = 100;
  EXPECT_THROW(TargetScene(p, 1), InputError);
}

}  // namespace
}  // namespace noctule::sim
