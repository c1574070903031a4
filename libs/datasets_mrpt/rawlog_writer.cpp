#include "datasets_mrpt/rawlog_writer.hpp"

#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/serialization/CArchive.h>

#include <optional>
#include <string>

#include "datasets_mrpt/convert.hpp"

namespace noctule::datasets {
namespace {

mrpt::obs::CObservation::Ptr to_observation(const UltrasonicScan& scan) {
  auto out = mrpt::obs::CObservationRange::Create();
  out->timestamp = to_time(scan.stamp.utime);
  out->sensorLabel = "ULTRASONIC";
  out->sensorConeApperture = static_cast<float>(2.0 * scan.half_angle);
  out->minSensorDistance = static_cast<float>(scan.min_range);
  out->maxSensorDistance = static_cast<float>(scan.max_range);
  for (const UltrasonicBeam& beam : scan.beams) {
    auto& m = out->sensedData.emplace_back();
    m.sensorID = static_cast<std::uint16_t>(out->sensedData.size() - 1);
    m.sensorPose = to_mrpt_3d(beam.sensor_in_base).asTPose();
    m.sensedDistance = beam.echo == Echo::hit ? static_cast<float>(beam.range) : 0.0f;
  }
  return out;
}

// Nothing when none of the sightings has both range and bearing.
mrpt::obs::CObservation::Ptr to_observation(const LandmarkDetections& detections) {
  auto out = mrpt::obs::CObservationBearingRange::Create();
  out->timestamp = to_time(detections.stamp.utime);
  out->sensorLabel = "LANDMARKS";
  out->sensorLocationOnRobot = to_mrpt_3d(detections.sensor_in_base);
  out->validCovariances = true;
  for (const LandmarkDetection& d : detections.detections) {
    if (d.kind != DetectionKind::range_bearing) continue;
    auto& m = out->sensedData.emplace_back();
    m.range = static_cast<float>(d.range);
    m.yaw = static_cast<float>(d.bearing);
    m.pitch = 0.0f;
    m.landmarkID = static_cast<std::int32_t>(d.id);
    m.covariance.setZero();
    m.covariance.asEigen().topLeftCorner<2, 2>() = d.covariance;
  }
  if (out->sensedData.empty() && !detections.detections.empty()) return {};
  return out;
}

class Writer : public RawlogSink {
 public:
  explicit Writer(const std::filesystem::path& path) : path_(path.string()) {
    if (!file_.open(path_)) throw InputError(path_ + ": expected a file that can be written, got: cannot be created");
  }

  void write(const Observation& observation) override {
    std::visit([this](const auto& value) { take(value); }, observation);
  }

  void close() override {
    end_frame();
    if (motion_) put_action();  // to where nothing was sighted any more
    file_.close();
  }

 private:
  void take(const GroundTruth&) {}
  void take(const CameraImage&) {}
  void take(const Odometry& odometry) {
    end_frame();
    const PoseGaussian increment{odometry.increment, odometry.covariance};
    motion_ = motion_ ? *motion_ * increment : increment;
    motion_utime_ = odometry.stamp.utime;
  }
  template <class Sighting>
  void take(const Sighting& sighting) {
    const auto observation = to_observation(sighting);
    if (!observation) return;
    if (frame_ && sighting.stamp.utime != frame_utime_) end_frame();
    if (!frame_) begin_frame(sighting.stamp.utime);
    frame_->insert(observation);
  }

  void begin_frame(std::int64_t utime) {
    put_action();
    frame_.emplace();
    frame_utime_ = utime;
  }
  // What leads to the next frame; empty where there was no odometry.
  void put_action() {
    mrpt::obs::CActionCollection actions;
    if (motion_) {
      mrpt::obs::CActionRobotMovement2D movement;
      movement.timestamp = to_time(motion_utime_);
      // A rawlog keeps the covariance of this method alone; that of emOdometry is made anew, from MRPT's own motion
      // model, whenever it is read.
      movement.estimationMethod = mrpt::obs::CActionRobotMovement2D::emScan2DMatching;
      movement.rawOdometryIncrementReading = to_mrpt(motion_->mean);
      mrpt::math::CMatrixDouble33 covariance;
      covariance.asEigen() = motion_->covariance;
      movement.poseChange = mrpt::poses::CPosePDFGaussian::Create(to_mrpt(motion_->mean), covariance);
      actions.insert(movement);
    }
    motion_.reset();
    put(actions);
  }
  void end_frame() {
    if (frame_) put(*frame_);
    frame_.reset();
  }
  void put(const mrpt::serialization::CSerializable& object) {
    try {
      mrpt::serialization::archiveFrom(file_) << object;
    } catch (const std::exception&) {
      throw InputError(path_ + ": expected a file that can be written, got: no more can be written to it");
    }
  }

  std::string path_;
  mrpt::io::CFileGZOutputStream file_;
  std::optional<PoseGaussian> motion_;  // since the last frame
  std::int64_t motion_utime_ = 0;
  std::optional<mrpt::obs::CSensoryFrame> frame_;
  std::int64_t frame_utime_ = 0;
};

}  // namespace

RawlogSink* create_rawlog(const std::filesystem::path& path) {
  return new Writer(path);
}

}  // namespace noctule::datasets
