/// Sources put on the bus what they were given, and a log brings it back.
#include "modules/source_module.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "core/error.hpp"
#include "core/observation_order.hpp"
#include "heard.hpp"
#include "noctule/ground_truth.hpp"
#include "noctule/landmark_detections.hpp"
#include "noctule/odometry.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::modules {
namespace {

namespace fs = std::filesystem;

class Prepared : public ObservationSource {
 public:
  explicit Prepared(std::vector<Observation> all) : all_(std::move(all)) { put_in_order(all_); }
  std::optional<Observation> next() override {
    if (at_ == fails_at) throw InputError("recording.csv:7: expected a number, got x");
    return at_ < all_.size() ? std::optional(all_[at_++]) : std::nullopt;
  }
  const KnownWorld& world() const override { return world_; }
  std::size_t fails_at = 1000;

 private:
  std::vector<Observation> all_;
  std::size_t at_ = 0;
  KnownWorld world_;
};

template <class T>
T stamped(std::int64_t utime) {
  T value;
  value.stamp.utime = utime;
  return value;
}

std::vector<Observation> some_observations() {
  auto scan = stamped<UltrasonicScan>(30);
  scan.half_angle = 0.2;
  scan.max_range = 4.0;
  return {stamped<Odometry>(10), stamped<GroundTruth>(10), stamped<Odometry>(30), scan,
          stamped<LandmarkDetections>(40)};
}

class SourceModuleTest : public ::testing::Test {
 protected:
  void SetUp() override {
    log_ = fs::temp_directory_path() / ("noctule_source_" + std::to_string(::getpid()) + ".lcmlog");
  }
  void TearDown() override { fs::remove(log_); }

  std::vector<std::string> run(SourceModule& source) {
    std::vector<std::string> utimes;
    for (auto utime = source.next_utime(); source.step(); utime = source.next_utime()) {
      utimes.push_back(std::to_string(*utime));
    }
    bus_.drain();
    return utimes;
  }

  fs::path log_;
  bus::Bus bus_;
  Heard<odometry> motions_{bus_, "ODOMETRY"};
  Heard<ultrasonic_scan> scans_{bus_, "ULTRASONIC_SCAN"};
  Heard<landmark_detections> detections_{bus_, "LANDMARK_DETECTIONS"};
  Heard<ground_truth> truths_{bus_, "GROUND_TRUTH"};
  Heard<module_status> statuses_{bus_, "MODULE_STATUS"};
};

TEST_F(SourceModuleTest, PublishesAllThenSaysThatItFinished) {
  ObservationModule source(bus_, std::make_unique<Prepared>(some_observations()));
  EXPECT_EQ(run(source), (std::vector<std::string>{"10", "10", "30", "30", "40"}));
  ASSERT_EQ(motions_.all.size(), 2u);
  EXPECT_EQ(motions_.all[1].seq, 1);
  EXPECT_EQ(scans_.all.size(), 1u);
  EXPECT_EQ(detections_.all.size(), 1u);
  EXPECT_EQ(truths_.all.size(), 1u);
  EXPECT_EQ(statuses_.all.back().state, module_status::STATE_FINISHED);
  EXPECT_FALSE(source.step());
}

TEST_F(SourceModuleTest, AnUnreadableRecordingEndsTheRun) {
  auto prepared = std::make_unique<Prepared>(some_observations());
  prepared->fails_at = 2;
  ObservationModule source(bus_, std::move(prepared));
  EXPECT_TRUE(source.step());
  EXPECT_TRUE(source.step());
  EXPECT_THROW((void)source.step(), InputError);
}

TEST_F(SourceModuleTest, ALogBringsBackTheObservationsAlone) {
  {
    bus::Bus recorded;
    recorded.record_to(bus::LogWriter(log_));
    ObservationModule source(recorded, std::make_unique<Prepared>(some_observations()));
    while (source.step()) recorded.drain();
  }
  LogModule source(bus_, log_);
  EXPECT_EQ(run(source), (std::vector<std::string>{"10", "10", "30", "30", "40"}));
  EXPECT_EQ(motions_.all.size(), 2u);
  EXPECT_EQ(scans_.all.at(0).half_angle_rad, 0.2);
  EXPECT_EQ(statuses_.all.back().state, module_status::STATE_FINISHED);
}

TEST_F(SourceModuleTest, ALogOfAnotherTypeVersionIsRefused) {
  {
    bus::LogWriter writer(log_);
    const std::vector<std::uint8_t> of_another_type(64, 1);
    writer.write("ODOMETRY", 5, of_another_type);
  }
  LogModule source(bus_, log_);
  try {
    (void)source.step();
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find(log_.string() + ": message 1 on ODOMETRY: "), 0u) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

TEST_F(SourceModuleTest, ALogThatWasCutOffIsPlayedWithAWarning) {
  {
    bus::Bus recorded;
    recorded.record_to(bus::LogWriter(log_));
    ObservationModule source(recorded, std::make_unique<Prepared>(some_observations()));
    for (int i = 0; i < 3; ++i) (void)source.step();
  }
  fs::resize_file(log_, fs::file_size(log_) - 3);
  LogModule source(bus_, log_);
  EXPECT_FALSE(run(source).empty());
  EXPECT_NE(statuses_.all.back().warning.find("was cut off"), std::string::npos);
}

TEST_F(SourceModuleTest, AMissingLogIsRefused) {
  EXPECT_THROW(LogModule(bus_, "/nowhere/run.lcmlog"), InputError);
}

}  // namespace
}  // namespace noctule::modules
