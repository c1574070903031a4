#include "eval/track_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace noctule::eval {
namespace {

/// At (x, 0) from step `first` to `last`.
Track still(double x, int first, int last) {
  Track t;
  for (int step = first; step <= last; ++step) t.push_back({step, {x, 0.0}});
  return t;
}

constexpr SetDistanceParameters kOne{.order = 1.0, .cutoff = 10.0};

TEST(TrackDistance, IsTheMeanOverTheStepsOfEither) {
  const Window window{0, 9};
  EXPECT_NEAR(track_distance(still(0, 0, 9), still(4, 0, 9), window, kOne), 4.0, 1e-12);
  // Five steps at 4 m, five at the cut-off.
  EXPECT_NEAR(track_distance(still(0, 0, 9), still(4, 5, 9), window, kOne), 7.0, 1e-12);
  // No step in common: the cut-off, whatever the gap between them.
  EXPECT_NEAR(track_distance(still(0, 0, 2), still(0, 8, 9), window, kOne), 10.0, 1e-12);
  EXPECT_NEAR(track_distance(still(0, 0, 9), still(40, 0, 9), window, kOne), 10.0, 1e-12);
  EXPECT_EQ(track_distance(still(0, 20, 30), still(4, 40, 50), window, kOne), 0.0);
  EXPECT_NEAR(track_distance(still(0, 0, 9), still(4, 5, 9), window, {.order = 2.0, .cutoff = 10.0}),
              std::sqrt((5 * 100.0 + 5 * 16.0) / 10), 1e-12);
}

TEST(Ospa2, SeesOnlyTheWindow) {
  const std::vector<Track> truth{still(0, 0, 100)}, estimate{still(1, 0, 49), still(3, 50, 100)};
  EXPECT_NEAR(ospa2(estimate, truth, {10, 19}, kOne).total, 1.0, 1e-12);
  EXPECT_NEAR(ospa2(estimate, truth, {60, 69}, kOne).total, 3.0, 1e-12);
  EXPECT_EQ(ospa2(estimate, truth, {200, 210}, kOne).total, 0.0);
}

TEST(Ospa2, PunishesABrokenIdentityWhereOspaDoesNot) {
  const std::vector<Track> truth{still(0, 0, 9)};
  const std::vector<Track> whole{still(0, 0, 9)}, broken{still(0, 0, 4), still(0, 5, 9)};
  EXPECT_EQ(ospa2(whole, truth, {0, 9}, kOne).total, 0.0);
  const Ospa o = ospa2(broken, truth, {0, 9}, kOne);
  EXPECT_NEAR(o.cardinality, 5.0, 1e-12);   // one track too many out of two
  EXPECT_NEAR(o.localisation, 2.5, 1e-12);  // half of the true track uncovered, over two tracks
}

TEST(Ospa2, PunishesSwitchedIdentities) {
  std::vector<Track> truth{still(0, 0, 9), still(6, 0, 9)}, switched = truth;
  for (std::size_t k = 5; k < 10; ++k) std::swap(switched[0][k].position, switched[1][k].position);
  EXPECT_NEAR(ospa2(switched, truth, {0, 9}, kOne).total, 3.0, 1e-12);
}

TEST(Ospa2, OfOneStepIsOspa) {
  const std::vector<Track> a{still(0, 3, 3), still(8, 3, 3)}, b{still(1, 3, 3)};
  const Ospa tracks = ospa2(a, b, {3, 3}, kOne);
  const Ospa points = ospa(std::vector<Vector2>{{0, 0}, {8, 0}}, std::vector<Vector2>{{1, 0}}, kOne);
  EXPECT_NEAR(tracks.total, points.total, 1e-12);
  EXPECT_NEAR(tracks.localisation, points.localisation, 1e-12);
}

TEST(Ospa2, Refusals) {
  EXPECT_THROW((void)track_distance({}, {}, {3, 2}, kOne), std::invalid_argument);
  EXPECT_THROW((void)track_distance({}, {}, {0, 2}, {.order = 0.0}), std::invalid_argument);
  const std::vector<Track> backwards{{{2, {0, 0}}, {1, {0, 0}}}};
  EXPECT_THROW((void)ospa2(backwards, {}, {0, 5}, kOne), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::eval
