#include "datasets_mrpt/rawlog_reader.hpp"

#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationBeaconRanges.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/observation_order.hpp"
#include "datasets_mrpt/convert.hpp"

namespace noctule::datasets {
namespace {

using namespace mrpt::obs;

// A rawlog in memory.
class Bytes {
 public:
  Bytes& operator<<(const mrpt::serialization::CSerializable& object) {
    mrpt::serialization::archiveFrom(stream_) << object;
    return *this;
  }
  [[nodiscard]] std::string text() {
    return {static_cast<const char*>(stream_.getRawBufferData()), stream_.getTotalBytesCount()};
  }

 private:
  mrpt::io::CMemoryStream stream_;
};

CActionCollection action(const Pose2& increment, double variance, std::int64_t utime = 0) {
  CActionRobotMovement2D movement;
  if (utime != 0) movement.timestamp = to_time(utime);
  mrpt::math::CMatrixDouble33 covariance;
  covariance.setDiagonal(variance);
  movement.estimationMethod = CActionRobotMovement2D::emScan2DMatching;  // keeps the covariance
  movement.poseChange = mrpt::poses::CPosePDFGaussian::Create(to_mrpt(increment), covariance);
  CActionCollection actions;
  actions.insert(movement);
  return actions;
}

CObservationRange::Ptr range(double distance, std::int64_t utime) {
  auto out = CObservationRange::Create();
  out->timestamp = utime != 0 ? to_time(utime) : mrpt::Clock::time_point();
  out->minSensorDistance = 0.1f;
  out->maxSensorDistance = 4.0f;
  out->sensorConeApperture = 0.5f;
  out->sensedData.emplace_back().sensedDistance = static_cast<float>(distance);
  return out;
}

CSensoryFrame frame(double distance, std::int64_t utime) {
  CSensoryFrame out;
  out.insert(range(distance, utime));
  return out;
}

Recording read(const std::string& bytes, RawlogParameters p = {}) {
  p.path = "log";
  Recording recording;
  read_rawlog(p, bytes, recording);
  put_in_order(recording.observations);
  return recording;
}

std::string refused(const std::string& bytes, const RawlogParameters& p = {}) {
  try {
    static_cast<void>(read(bytes, p));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(RawlogReader, AnActionIsTheMotionToItsFrame) {
  Bytes log;
  log << frame(1.0, 100) << action({0.5, 0, 0.1}, 1e-4, 150) << frame(2.0, 200) << action({0.3, 0, 0}, 1e-4)
      << action({0.2, 0, 0}, 1e-4) << frame(0.0, 300) << action({0.1, 0, 0}, 1e-4, 350);
  const auto o = read(log.text()).observations;
  ASSERT_EQ(o.size(), 6u);
  EXPECT_EQ(std::get<UltrasonicScan>(o[0]).stamp, (Stamp{100, 0}));
  const auto& first = std::get<Odometry>(o[1]);
  EXPECT_EQ(first.stamp, (Stamp{200, 0}));
  EXPECT_LT(difference(first.increment, {0.5, 0, 0.1}).norm(), 1e-15);
  EXPECT_EQ(first.covariance(0, 0), 1e-4);
  EXPECT_EQ(std::get<UltrasonicScan>(o[2]).stamp, (Stamp{200, 1}));
  const auto& sum = std::get<Odometry>(o[3]);
  EXPECT_NEAR(sum.increment.x, 0.5, 1e-12);
  EXPECT_NEAR(sum.covariance(0, 0), 2e-4, 1e-12);
  EXPECT_EQ(std::get<UltrasonicScan>(o[4]).beams[0].echo, Echo::none);
  EXPECT_EQ(std::get<Odometry>(o[5]).stamp, (Stamp{350, 2}));
}

TEST(RawlogReader, StatesTheCovarianceOfTheModelWhenAsked) {
  Bytes log;
  log << frame(1.0, 100) << action({0.5, 0, 0.1}, 1e-4) << frame(2.0, 200);
  const models::OdometryRandomWalk noise{.along = 0.2};
  const auto o =
      read(log.text(), {.odometry_covariance = OdometryCovariance::model, .odometry_noise = noise}).observations;
  EXPECT_LT((std::get<Odometry>(o[1]).covariance - noise.covariance({0.5, 0, 0.1})).norm(), 1e-15);
}

TEST(RawlogReader, GivesFramesAPeriodWhereTheirTimesAreUseless) {
  Bytes log;
  log << frame(1.0, 100) << action({0.5, 0, 0}, 1e-4) << frame(2.0, 100) << action({0.5, 0, 0}, 1e-4) << frame(3.0, 0);
  EXPECT_EQ(
      refused(log.text()),
      "log: object 2: expected a frame after 100 us as the one before (or frame_period_s, where the recorded times "
      "are useless), got 100 us");
  const auto o = read(log.text(), {.frame_period = 0.5}).observations;
  ASSERT_EQ(o.size(), 5u);
  EXPECT_EQ(std::get<Odometry>(o[3]).stamp, (Stamp{1'000'000, 1}));
  EXPECT_EQ(std::get<UltrasonicScan>(o[4]).stamp, (Stamp{1'000'000, 2}));
}

TEST(RawlogReader, SingleObservationsBecomeIncrementsInOrderOfTime) {
  Bytes log;
  const auto odometry = [](const Pose2& pose, std::int64_t utime) {
    CObservationOdometry out;
    out.timestamp = to_time(utime);
    out.odometry = to_mrpt(pose);
    return out;
  };
  log << odometry({1, 1, 0.5 * kPi}, 100) << *range(1.0, 200) << odometry({1, 3, 0.5 * kPi}, 300)
      << odometry({1, 2, 0.5 * kPi}, 200);
  const auto o = read(log.text()).observations;
  ASSERT_EQ(o.size(), 3u);
  EXPECT_LT(difference(std::get<Odometry>(o[0]).increment, {1, 0, 0}).norm(), 1e-12);
  EXPECT_EQ(std::get<Odometry>(o[0]).stamp, (Stamp{200, 0}));
  EXPECT_EQ(std::get<UltrasonicScan>(o[1]).stamp, (Stamp{200, 0}));
  EXPECT_EQ(std::get<Odometry>(o[2]).stamp, (Stamp{300, 1}));
}

TEST(RawlogReader, RangesBecomeBeamsWithTheirLimits) {
  auto out = range(0.05, 100);
  for (const float d : {2.0f, 4.5f}) {
    out->sensedData.emplace_back().sensedDistance = d;
    out->sensedData.back().sensorPose = {0.1, 0.2, 0.3, 1.0, 0.0, 0.0};
  }
  CSensoryFrame one;
  one.insert(out);
  const auto scan = std::get<UltrasonicScan>(read((Bytes() << one).text()).observations[0]);
  EXPECT_NEAR(scan.half_angle, 0.25, 1e-7);
  EXPECT_EQ(scan.beams[0].echo, Echo::saturated);
  EXPECT_EQ(scan.beams[1].echo, Echo::hit);
  EXPECT_EQ(scan.beams[1].sensor_in_base, (Pose2{0.1, 0.2, 1.0}));
  EXPECT_EQ(scan.beams[2].echo, Echo::none);
}

CObservationBearingRange sightings() {
  CObservationBearingRange out;
  out.timestamp = to_time(100);
  out.sensor_std_range = 0.25f;
  out.sensor_std_yaw = 0.0f;
  out.sensedData.resize(1);
  out.sensedData[0] = {2.0f, 0.5f, 0.0f, 7, {}};
  return out;
}

TEST(RawlogReader, SightingsTakeTheirOwnCovarianceOrThatOfTheSensorOrTheParameters) {
  const auto detection = [](const CObservationBearingRange& s, const RawlogParameters& p) {
    return std::get<LandmarkDetections>(read((Bytes() << s).text(), p).observations[0]).detections[0];
  };
  auto s = sightings();
  auto d = detection(s, {.bearing_sd = 0.125});
  EXPECT_EQ(d.id, 7);
  EXPECT_EQ(d.range, 2.0);
  EXPECT_EQ(d.bearing, 0.5);
  EXPECT_EQ(d.covariance(0, 0), 0.0625);
  EXPECT_EQ(d.covariance(1, 1), 0.015625);
  s.validCovariances = true;
  s.sensedData[0].covariance.setDiagonal(0.5);
  d = detection(s, {.known_ids = false});
  EXPECT_EQ(d.id, -1);
  EXPECT_EQ(d.covariance, Matrix2(0.5 * Matrix2::Identity()));
}

TEST(RawlogReader, RefusesNumbersThatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused((Bytes() << action({nan, 0, 0}, 1e-4) << frame(1.0, 100)).text()),
            "log: object 0: expected a finite pose change, got one that is not");
  EXPECT_EQ(refused((Bytes() << action({0, 0, 0}, nan) << frame(1.0, 100)).text()),
            "log: object 0: expected a finite covariance, got one that is not");
  EXPECT_EQ(refused((Bytes() << frame(nan, 100)).text()),
            "log: object 0: expected a finite range, got one that is not");
  EXPECT_NE(refused((Bytes() << frame(-1.0, 100)).text()).find("expected a range of 0 m or more, got -1"),
            std::string::npos);
  auto s = sightings();
  s.sensedData[0].pitch = 0.3f;
  EXPECT_NE(refused((Bytes() << s).text()).find("expected sightings in the plane, got pitch 0.3"), std::string::npos);
  EXPECT_NE(refused((Bytes() << frame(1.0, 0)).text()).find("object 0: expected a time"), std::string::npos);
}

TEST(RawlogReader, CountsWhatItLeavesOut) {
  CObservationBeaconRanges beacons;
  beacons.timestamp = to_time(100);
  EXPECT_EQ(refused((Bytes() << beacons << beacons).text()),
            "log: expected actions, laser scans, ranges or sightings, got 2 mrpt::obs::CObservationBeaconRanges");
  const auto notes = read((Bytes() << beacons << *range(1.0, 100)).text()).notes;
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "log: left out 1 mrpt::obs::CObservationBeaconRanges");
  EXPECT_EQ(refused(""), "log: expected actions, laser scans, ranges or sightings, got nothing");
}

// Cut off anywhere, a rawlog gives the objects before the cut and says so.
TEST(RawlogReader, ReadsUpToTheLastWholeObject) {
  Bytes log;
  log << frame(1.0, 100) << action({0.5, 0, 0}, 1e-4) << frame(2.0, 200);
  const std::string whole = log.text();
  const std::size_t one = (Bytes() << frame(1.0, 100)).text().size();
  const std::size_t two = one + (Bytes() << action({0.5, 0, 0}, 1e-4)).text().size();
  for (std::size_t size = one + 1; size < whole.size(); ++size) {
    const Recording r = read(whole.substr(0, size));
    ASSERT_EQ(r.observations.size(), 1u) << size;
    // A cut inside an object is noted, and so is an action that lost its frame.
    ASSERT_EQ(r.notes.size(), (size != two ? 1u : 0u) + (size >= two ? 1u : 0u)) << size;
  }
  EXPECT_NE(refused("this is no rawlog at all").find("log: object 0: expected an object of a rawlog"),
            std::string::npos);
  EXPECT_NE(refused(whole + std::string(200, '\xff')).find("log: object 3: expected an object of a rawlog"),
            std::string::npos);
}

}  // namespace
}  // namespace noctule::datasets
