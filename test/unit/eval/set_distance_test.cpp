#include "eval/set_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace noctule::eval {
namespace {

using Points = std::vector<Vector2>;

TEST(Ospa, ClosedForms) {
  const Points x{{0, 0}, {100, 0}}, y{{3, 4}};
  const Ospa o = ospa(x, y, {.order = 1.0, .cutoff = 100.0});
  EXPECT_NEAR(o.total, 52.5, 1e-12);
  EXPECT_NEAR(o.localisation, 2.5, 1e-12);
  EXPECT_NEAR(o.cardinality, 50.0, 1e-12);
  const Ospa o2 = ospa(x, y, {.order = 2.0, .cutoff = 100.0});
  EXPECT_NEAR(o2.total, std::sqrt((25.0 + 1e4) / 2), 1e-12);
  EXPECT_NEAR(o2.localisation, std::sqrt(25.0 / 2), 1e-12);
  EXPECT_NEAR(o2.cardinality, std::sqrt(1e4 / 2), 1e-12);
}

TEST(Ospa, EmptySets) {
  const Points x{{0, 0}, {7, 0}}, none;
  EXPECT_EQ(ospa(none, none).total, 0.0);
  EXPECT_NEAR(ospa(x, none, {.cutoff = 30.0}).total, 30.0, 1e-12);
  EXPECT_NEAR(ospa(none, x, {.order = 2.0, .cutoff = 30.0}).total, 30.0, 1e-12);
  EXPECT_NEAR(ospa(none, x, {.cutoff = 30.0}).cardinality, 30.0, 1e-12);
  EXPECT_EQ(ospa(none, x).localisation, 0.0);
}

TEST(Ospa, WhatIsBeyondTheCutOffCostsTheCutOff) {
  const Points x{{0, 0}}, y{{1e6, 0}};
  const Ospa o = ospa(x, y, {.order = 2.0, .cutoff = 10.0});
  EXPECT_NEAR(o.localisation, 10.0, 1e-12);
  EXPECT_EQ(o.cardinality, 0.0);
}

TEST(Gospa, ClosedForms) {
  const Points x{{0, 0}, {100, 0}}, y{{3, 4}};
  const Gospa g = gospa(x, y, {.order = 1.0, .cutoff = 100.0});
  EXPECT_NEAR(g.total, 55.0, 1e-12);
  EXPECT_NEAR(g.localisation, 5.0, 1e-12);
  EXPECT_NEAR(g.false_alarms, 50.0, 1e-12);
  EXPECT_EQ(g.missed, 0.0);
  EXPECT_EQ(g.assigned_count, 1);
  EXPECT_EQ(g.false_count, 1);
  EXPECT_EQ(g.missed_count, 0);
  EXPECT_NEAR(gospa(y, x, {.cutoff = 100.0}).missed, 50.0, 1e-12);
}

TEST(Gospa, APairBeyondTheCutOffIsMissedAndFalse) {
  const Gospa g = gospa(Points{{0, 0}}, Points{{11, 0}}, {.order = 2.0, .cutoff = 10.0});
  EXPECT_EQ(g.assigned_count, 0);
  EXPECT_EQ(g.missed_count, 1);
  EXPECT_EQ(g.false_count, 1);
  EXPECT_NEAR(g.total, 10.0, 1e-12);
  EXPECT_NEAR(g.missed, std::sqrt(50.0), 1e-12);
  EXPECT_EQ(gospa(Points{}, Points{}).total, 0.0);
}

TEST(Cola, CountsObjects) {
  const Points x{{0, 0}, {100, 0}, {50, 50}}, y{{3, 4}};
  EXPECT_NEAR(cola(x, y, {.cutoff = 10.0}), 0.5 + 2.0, 1e-12);
  EXPECT_NEAR(cola(x, Points{}, {.order = 2.0, .cutoff = 10.0}), std::sqrt(3.0), 1e-12);
  EXPECT_EQ(cola(x, x), 0.0);
}

TEST(SetDistances, Refusals) {
  const Points x{{0, 0}};
  EXPECT_THROW((void)ospa(x, x, {.order = 0.5}), std::invalid_argument);
  EXPECT_THROW((void)gospa(x, x, {.cutoff = 0.0}), std::invalid_argument);
  EXPECT_THROW((void)cola(x, x, {.cutoff = std::numeric_limits<double>::infinity()}), std::invalid_argument);
  EXPECT_THROW((void)ospa(x, Points{{std::nan(""), 0}}), std::invalid_argument);
  EXPECT_THROW((void)ospa(Eigen::MatrixXd::Constant(1, 1, -1.0)), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::eval
