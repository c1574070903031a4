#include "sensors/ultrasonic/extractor.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "core/error.hpp"
#include "core/limits.hpp"
#include "statistics/sensors/scene.hpp"

namespace noctule::sensors {
namespace {

using scene::Kind;

Odometry odometry(std::int64_t seq, const Pose2& increment) {
  return {{1000000 * seq, seq}, increment, Matrix3::Zero()};
}

bool finite(const ContourFeature& f) {
  return std::isfinite(f.wall.rho) && std::isfinite(f.wall.theta) && f.wall_covariance.allFinite() &&
         std::isfinite(f.wall_log_likelihood) && f.circle.centre.allFinite() && std::isfinite(f.circle.radius) &&
         f.circle_covariance.allFinite() && std::isfinite(f.circle_log_likelihood) && f.surface.allFinite() &&
         std::isfinite(f.baseline);
}

const scene::Object kHeardWall{Kind::wall, {1.0, radians(85.0)}, {}};

TEST(UltrasonicExtractor, ASingleStopIsAmbiguousWithBothHypotheses) {
  Rng rng(1);
  UltrasonicExtractor extractor({});
  const UltrasonicScan scan = scene::scan(kHeardWall, {}, {}, 7, rng);
  const ContourFeatures result = extractor.update(scan);
  EXPECT_EQ(result.stamp, scan.stamp);
  ASSERT_EQ(result.features.size(), 1u);
  const ContourFeature& f = result.features[0];
  EXPECT_EQ(f.type, ContourType::ambiguous);
  EXPECT_TRUE(f.has_wall && f.has_circle);
  EXPECT_EQ(f.stops, 1);
  EXPECT_EQ(f.baseline, 0.0);
  EXPECT_NEAR(f.wall.rho, 1.0, 0.03);
  EXPECT_NEAR(f.wall.theta, radians(85.0), radians(10.0));
  EXPECT_NEAR(f.circle.radius, 0.08, 1e-6);
  EXPECT_NEAR(f.circle_covariance(2, 2), 0.08 * 0.08, 1e-6);
  EXPECT_NEAR(f.circle.distance(Vector2::Zero()), f.wall.rho, 1e-6);
  EXPECT_NEAR(f.surface.norm(), f.wall.rho, 1e-6);
  for (const ReadingId& id : f.readings) {
    EXPECT_EQ(id.scan_seq, 7);
    EXPECT_EQ(scan.beams[static_cast<std::size_t>(id.beam)].echo, Echo::hit);
  }
}

TEST(UltrasonicExtractor, StandingStillDecidesNothing) {
  Rng rng(2);
  UltrasonicExtractor extractor({});
  double variance = 1.0;
  for (int k = 0; k < 60; ++k) {
    extractor.predict(odometry(k, {}));
    for (const ContourFeature& f : extractor.update(scene::scan(kHeardWall, {}, {}, k, rng)).features) {
      EXPECT_EQ(f.type, ContourType::ambiguous);
      EXPECT_EQ(f.stops, 1);
      EXPECT_EQ(f.baseline, 0.0);
      EXPECT_LE(f.readings.size(), 64u);
      if (k < 10) {  // the readings of one place add up
        EXPECT_LE(f.wall_covariance(1, 1), variance * 1.0001);
        variance = f.wall_covariance(1, 1);
      }
    }
  }
  EXPECT_EQ(extractor.tracks(), 1u);
}

TEST(UltrasonicExtractor, DecidesAWallUnderOneTrackAndNamesItsReadings) {
  Rng rng(3);
  UltrasonicExtractor extractor({});
  std::set<std::int64_t> tracks;
  ContourFeature last;
  for (int k = 0; k < 10; ++k) {
    if (k > 0) extractor.predict(odometry(k, {0.12, 0.0, 0.0}));
    const auto features = extractor.update(scene::scan(kHeardWall, {0.12 * k, 0.0, 0.0}, {}, k, rng)).features;
    for (const ContourFeature& f : features) {
      tracks.insert(f.track);
      last = f;
      bool current = false;
      for (const ReadingId& id : f.readings) current |= id.scan_seq == k;
      EXPECT_TRUE(current);
    }
  }
  EXPECT_EQ(tracks.size(), 1u);
  EXPECT_EQ(last.type, ContourType::wall);
  EXPECT_TRUE(last.has_wall);
  EXPECT_FALSE(last.has_circle);
  EXPECT_GE(last.stops, 8);
  const Wall truth = transformed(inverse(Pose2{0.12 * 9, 0.0, 0.0}), kHeardWall.wall);
  EXPECT_NEAR(last.wall.rho, truth.rho, 0.02);
  EXPECT_NEAR(last.wall.theta, truth.theta, radians(2.0));
}

/// A corner of two walls: every region of a scan is in exactly one feature.
TEST(UltrasonicExtractor, EveryReadingOfAScanIsInAtMostOneFeature) {
  Rng rng(4);
  UltrasonicExtractor extractor({});
  const scene::Object other{Kind::wall, {1.2, radians(-5.0)}, {}};
  for (int k = 0; k < 8; ++k) {
    if (k > 0) extractor.predict(odometry(k, {0.1, 0.0, 0.1}));
    Pose2 base;
    for (int i = 0; i < k; ++i) base = base * Pose2{0.1, 0.0, 0.1};
    UltrasonicScan scan = scene::scan(kHeardWall, base, {}, k, rng);
    const UltrasonicScan second = scene::scan(other, base, {}, k, rng);
    for (std::size_t i = 0; i < scan.beams.size(); ++i)
      if (scan.beams[i].echo != Echo::hit) scan.beams[i] = second.beams[i];
    std::multiset<std::int32_t> used;
    std::set<std::int64_t> tracks;
    for (const ContourFeature& f : extractor.update(scan).features) {
      EXPECT_TRUE(tracks.insert(f.track).second);
      for (const ReadingId& id : f.readings)
        if (id.scan_seq == k) used.insert(id.beam);
    }
    for (const std::int32_t beam : used) EXPECT_EQ(used.count(beam), 1u);
    EXPECT_GE(tracks.size(), 2u);
  }
}

TEST(UltrasonicExtractor, BadBeamsAreIgnoredAndNothingButNumbersComesOut) {
  Rng rng(5);
  UltrasonicExtractor extractor({});
  std::int64_t bad = 0;
  for (int k = 0; k < 12; ++k) {
    extractor.predict(odometry(k, {0.1, 0.0, 0.02}));
    UltrasonicScan scan = scene::scan(kHeardWall, {0.1 * k, 0.0, 0.0}, {}, k, rng);
    for (auto& beam : scan.beams) {
      const double what = rng.uniform();
      if (what > 0.4) continue;
      ++bad;
      beam.echo = Echo::hit;
      beam.range = what < 0.1 ? kNan : what < 0.2 ? -1.0 : what < 0.3 ? 1e300 : 1.0;
      if (what >= 0.3) beam.sensor_in_base.yaw = std::numeric_limits<double>::infinity();
    }
    for (const ContourFeature& f : extractor.update(scan).features) EXPECT_TRUE(finite(f));
  }
  EXPECT_EQ(extractor.counts().beams, bad);
  EXPECT_TRUE(std::isfinite(extractor.noise_scale()));
}

TEST(UltrasonicExtractor, NeverLetsNanOutOfRandomScans) {
  Rng rng(6);
  UltrasonicExtractor extractor({});
  for (int k = 0; k < 300; ++k) {
    const Pose2 step{rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1), rng.uniform(-1.0, 1.0)};
    extractor.predict({{k, k}, step, Matrix3(Vector3(1e-4, 1e-4, 1e-3).asDiagonal())});
    UltrasonicScan scan{{k, k}, radians(15.0), 0.0, 4.0, {}};
    double range = 1.0;
    for (int i = 0; i < 24; ++i) {
      if (rng.uniform() < 0.3) range = rng.uniform() < 0.1 ? 1e-4 : rng.uniform(0.01, 4.0);
      const Pose2 sensor{rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), radians(15.0 * i)};
      scan.beams.push_back({sensor, range, rng.uniform() < 0.8 ? Echo::hit : Echo::none});
    }
    for (const ContourFeature& f : extractor.update(scan).features) ASSERT_TRUE(finite(f));
  }
  EXPECT_LT(extractor.tracks(), 600u);  // bounded by patience
}

TEST(UltrasonicExtractor, DuplicateAndLateMessagesAreIgnoredAndCounted) {
  Rng rng(7);
  UltrasonicExtractor extractor({});
  const UltrasonicScan first = scene::scan(kHeardWall, {}, {}, 1, rng),
                       second = scene::scan(kHeardWall, {}, {}, 2, rng);
  EXPECT_FALSE(extractor.update(second).features.empty());
  EXPECT_TRUE(extractor.update(second).features.empty());
  EXPECT_TRUE(extractor.update(first).features.empty());
  extractor.predict(odometry(5, {0.1, 0.0, 0.0}));
  extractor.predict(odometry(5, {0.1, 0.0, 0.0}));
  extractor.predict(odometry(4, {0.1, 0.0, 0.0}));
  const ExtractorCounts counts = extractor.counts();
  EXPECT_EQ(counts.scans, 2);
  EXPECT_EQ(counts.odometry, 2);
  EXPECT_EQ(counts.odometry_gaps, 0);
}

TEST(UltrasonicExtractor, AGapInTheOdometryStartsAllTracksAnew) {
  Rng rng(8);
  UltrasonicExtractor extractor({});
  extractor.predict(odometry(0, {}));
  const auto before = extractor.update(scene::scan(kHeardWall, {}, {}, 0, rng)).features;
  extractor.predict(odometry(2, {0.1, 0.0, 0.0}));
  const auto after = extractor.update(scene::scan(kHeardWall, {0.2, 0.0, 0.0}, {}, 1, rng)).features;
  ASSERT_EQ(before.size(), 1u);
  ASSERT_EQ(after.size(), 1u);
  EXPECT_NE(before[0].track, after[0].track);
  EXPECT_EQ(extractor.counts().odometry_gaps, 1);
}

TEST(UltrasonicExtractor, RefusesWhatCannotBeUsedAndStaysAsItWas) {
  Rng rng(9);
  UltrasonicExtractor extractor({}), untouched({});
  Odometry bad = odometry(0, {});
  bad.increment.x = kNan;
  EXPECT_THROW(extractor.predict(bad), InputError);
  bad = odometry(0, {});
  bad.covariance(1, 1) = kNan;
  EXPECT_THROW(extractor.predict(bad), InputError);
  bad.covariance(1, 1) = -1.0;
  EXPECT_THROW(extractor.predict(bad), InputError);
  UltrasonicScan scan = scene::scan(kHeardWall, {}, {}, 0, rng);
  const UltrasonicScan good = scan;
  scan.half_angle = kNan;
  EXPECT_THROW((void)extractor.update(scan), InputError);
  const auto a = extractor.update(good).features, b = untouched.update(good).features;
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a[0].wall.rho, b[0].wall.rho);
}

TEST(UltrasonicExtractor, RefusesParametersOutOfTheirRange) {
  ExtractorParameters window, noise;
  window.window = kMaxSightings + 1;
  noise.regions.noise.base = kNan;
  EXPECT_THROW(UltrasonicExtractor{window}, InputError);
  EXPECT_THROW(UltrasonicExtractor{noise}, InputError);
}

TEST(UltrasonicExtractor, AnEmptyScanHasNoFeatures) {
  UltrasonicExtractor extractor({});
  EXPECT_TRUE(extractor.update({{0, 0}, radians(15.0), 0.02, 4.0, {}}).features.empty());
}

TEST(UltrasonicExtractor, SlowMotionReachesTheBaselineWithinAFixedWindow) {
  Rng rng(10);
  ExtractorParameters parameters;
  UltrasonicExtractor extractor(parameters);
  ContourType type = ContourType::ambiguous;
  for (int k = 0; k < 60; ++k) {  // 1.5 cm a scan: twelve scans in a row would span 17 cm only
    if (k > 0) extractor.predict(odometry(k, {0.015, 0.0, 0.0}));
    for (const auto& f : extractor.update(scene::scan(kHeardWall, {0.015 * k, 0.0, 0.0}, {}, k, rng)).features) {
      EXPECT_LE(f.stops, parameters.window);
      type = f.type;
    }
  }
  EXPECT_EQ(type, ContourType::wall);
}

}  // namespace
}  // namespace noctule::sensors
