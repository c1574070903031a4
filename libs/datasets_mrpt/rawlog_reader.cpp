#include "datasets_mrpt/rawlog_reader.hpp"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <utility>

#include "datasets/echo.hpp"
#include "datasets_mrpt/convert.hpp"
#include "datasets_mrpt/virtual_ring.hpp"

namespace noctule::datasets {
namespace {

using mrpt::serialization::CSerializable;

/// Bytes in memory as MRPT's archives read them. A read beyond the end throws: MRPT itself would go on with what the
/// memory held, for instance as the number of elements of a list.
class Bytes {
 public:
  explicit Bytes(const std::string& bytes) : bytes_(bytes) {}

  std::size_t Read(void* to, std::size_t count) {
    if (count > bytes_.size() - position_) {
      ran_out_ = true;
      throw std::runtime_error("the bytes end");
    }
    std::memcpy(to, bytes_.data() + position_, count);
    position_ += count;
    return count;
  }
  std::size_t Write(const void*, std::size_t) { throw std::logic_error("only to be read"); }
  [[nodiscard]] std::string getStreamDescription() const { return "rawlog"; }

  [[nodiscard]] bool at_end() const { return position_ == bytes_.size(); }
  [[nodiscard]] bool ran_out() const { return ran_out_; }

 private:
  const std::string& bytes_;
  std::size_t position_ = 0;
  bool ran_out_ = false;
};

class Reader {
 public:
  Reader(const RawlogParameters& parameters, Recording& recording) : p_(parameters), recording_(recording) {}

  void read(const std::string& bytes) {
    Bytes stream(bytes);
    auto archive = mrpt::serialization::archiveFrom(stream);
    while (!stream.at_end()) {
      CSerializable::Ptr object;
      try {
        object = archive.ReadObject();
      } catch (const std::exception&) {
        if (!stream.ran_out() || objects_ == 0)
          throw refuse("an object of a rawlog", "damaged bytes or an unknown class");
        note("cut off inside object " + std::to_string(objects_) + "; read up to there");
        break;
      }
      take(object);
      ++objects_;
    }
    finish();
  }

 private:
  [[nodiscard]] std::string place() const { return p_.path.string() + ": object " + std::to_string(objects_); }
  [[nodiscard]] InputError refuse(const std::string& expected, const std::string& got) const {
    return InputError(place() + ": expected " + expected + ", got " + got);
  }
  void note(const std::string& text) { recording_.notes.push_back(p_.path.string() + ": " + text); }
  void require_finite(bool finite, const char* what) const {
    if (!finite) throw refuse(std::string("a finite ") + what, "one that is not");
  }

  void take(const CSerializable::Ptr& object) {
    using namespace mrpt::obs;
    if (const auto actions = std::dynamic_pointer_cast<CActionCollection>(object)) {
      take_actions(*actions);
    } else if (const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(object)) {
      take_frame(*frame);
    } else if (const auto observation = std::dynamic_pointer_cast<CObservation>(object)) {
      take_observation(*observation, required_utime(*observation));
    } else {
      ++left_out_[object ? object->GetRuntimeClass()->className : "nothing"];
    }
  }

  [[nodiscard]] std::int64_t required_utime(const mrpt::obs::CObservation& observation) const {
    const auto utime = to_utime(observation.timestamp);
    if (!utime) throw refuse("a time (frame_period_s gives one to frames that have none)", "none");
    return *utime;
  }

  // The motion to the next frame; several in a row add up.
  void take_actions(const mrpt::obs::CActionCollection& actions) {
    for (const auto& action : actions) {
      const auto* movement = dynamic_cast<const mrpt::obs::CActionRobotMovement2D*>(action.get());
      if (movement == nullptr || !movement->poseChange) {
        ++left_out_[action->GetRuntimeClass()->className];
        continue;
      }
      const auto [covariance, mean] = movement->poseChange->getCovarianceAndMean();
      PoseGaussian motion{to_pose(mean), Matrix3(covariance.asEigen())};
      require_finite(motion.mean.finite(), "pose change");
      if (p_.odometry_covariance == OdometryCovariance::model) {
        motion.covariance = p_.odometry_noise.covariance(motion.mean);
      }
      require_finite(motion.covariance.allFinite(), "covariance");
      pending_ = pending_ ? *pending_ * motion : motion;
      pending_utime_ = to_utime(movement->timestamp);
    }
  }

  // All observations of a frame belong to one pose and take the time of the earliest.
  void take_frame(const mrpt::obs::CSensoryFrame& frame) {
    std::optional<std::int64_t> earliest;
    if (p_.frame_period == 0.0) {
      for (const auto& observation : frame) {
        const std::int64_t utime = required_utime(*observation);
        earliest = std::min(earliest.value_or(utime), utime);
      }
    }
    begin_frame(earliest);
    for (const auto& observation : frame) take_observation(*observation, frame_utime_);
  }

  // Completes the motion to a frame, which has the time of its action if it has none of its own.
  void begin_frame(std::optional<std::int64_t> utime) {
    if (!utime) utime = pending_utime_;
    if (p_.frame_period > 0.0) utime = std::llround(static_cast<double>(frames_) * p_.frame_period * 1e6);
    if (!utime && !pending_) return;
    if (!utime) throw refuse("a time of an action without observations (or frame_period_s)", "none");
    if (frames_ > 0 && *utime <= frame_utime_) {
      throw refuse("a frame after " + std::to_string(frame_utime_) +
                       " us as the one before (or frame_period_s, where the recorded times are useless)",
                   std::to_string(*utime) + " us");
    }
    if (pending_) recording_.observations.emplace_back(Odometry{{*utime, 0}, pending_->mean, pending_->covariance});
    pending_.reset();
    pending_utime_.reset();
    frame_utime_ = *utime;
    ++frames_;
  }

  void take_observation(const mrpt::obs::CObservation& observation, std::int64_t utime) {
    using namespace mrpt::obs;
    if (const auto* laser = dynamic_cast<const CObservation2DRangeScan*>(&observation)) {
      UltrasonicScan scan = virtual_scan(*laser, p_.ring, place());
      scan.stamp.utime = utime;
      recording_.observations.emplace_back(std::move(scan));
      ++virtual_scans_;
    } else if (const auto* ranges = dynamic_cast<const CObservationRange*>(&observation)) {
      take_ranges(*ranges, utime);
    } else if (const auto* sightings = dynamic_cast<const CObservationBearingRange*>(&observation)) {
      take_sightings(*sightings, utime);
    } else if (const auto* odometry = dynamic_cast<const CObservationOdometry*>(&observation)) {
      const Pose2 pose = to_pose(odometry->odometry);
      require_finite(pose.finite(), "odometry");
      odometry_poses_.emplace_back(utime, pose);
    } else {
      ++left_out_[observation.GetRuntimeClass()->className];
    }
  }

  void take_ranges(const mrpt::obs::CObservationRange& ranges, std::int64_t utime) {
    UltrasonicScan scan{
        {utime, 0}, 0.5 * ranges.sensorConeApperture, ranges.minSensorDistance, ranges.maxSensorDistance, {}};
    for (const auto& m : ranges.sensedData) {
      const double range = m.sensedDistance;
      require_finite(std::isfinite(range), "range");
      if (range < 0.0) throw refuse("a range of 0 m or more", std::to_string(range));
      const Pose2 sensor = to_level_pose(mrpt::poses::CPose3D(m.sensorPose), place());
      require_finite(sensor.finite(), "pose of a sensor");
      scan.beams.push_back(beam(sensor, range == 0.0 ? kNoEcho : range, scan));
    }
    recording_.observations.emplace_back(std::move(scan));
  }

  void take_sightings(const mrpt::obs::CObservationBearingRange& sightings, std::int64_t utime) {
    LandmarkDetections detections{{utime, 0}, to_level_pose(sightings.sensorLocationOnRobot, place()), {}};
    const double range_sd = sightings.sensor_std_range > 0.0f ? sightings.sensor_std_range : p_.range_sd;
    const double bearing_sd = sightings.sensor_std_yaw > 0.0f ? sightings.sensor_std_yaw : p_.bearing_sd;
    for (const auto& m : sightings.sensedData) {
      LandmarkDetection d;
      d.range = m.range;
      d.bearing = wrap(m.yaw);
      require_finite(std::isfinite(d.range) && std::isfinite(d.bearing), "sighting");
      if (d.range < 0.0) throw refuse("a range of 0 m or more", std::to_string(d.range));
      if (!(std::abs(m.pitch) < 1e-3f)) throw refuse("sightings in the plane", "pitch " + std::to_string(m.pitch));
      if (sightings.validCovariances) {
        d.covariance = m.covariance.asEigen().topLeftCorner<2, 2>();
        require_finite(d.covariance.allFinite(), "covariance");
      } else {
        d.covariance << range_sd * range_sd, 0.0, 0.0, bearing_sd * bearing_sd;
      }
      if (p_.known_ids) d.id = m.landmarkID;
      detections.detections.push_back(d);
    }
    recording_.observations.emplace_back(std::move(detections));
  }

  void finish() {
    add_increments();
    if (pending_ && (pending_utime_ || p_.frame_period > 0.0)) begin_frame(pending_utime_);
    if (pending_) note("the last action has neither a time nor a frame after it and is left out");
    if (virtual_scans_ > 0) {
      recording_.world.name += ", virtual ultrasonic ring";
      note(std::to_string(virtual_scans_) + " scans of a virtual ultrasonic ring, made of laser scans");
    }
    std::string left_out;
    for (const auto& [name, count] : left_out_) {
      left_out += (left_out.empty() ? "" : ", ") + std::to_string(count) + " " + name;
    }
    if (recording_.observations.empty()) {
      throw InputError(p_.path.string() + ": expected actions, laser scans, ranges or sightings, got " +
                       (left_out.empty() ? "nothing" : left_out));
    }
    if (!left_out.empty()) note("left out " + left_out);
  }

  // CObservationOdometry holds poses; the increments between them in the order of time.
  void add_increments() {
    std::stable_sort(odometry_poses_.begin(), odometry_poses_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < odometry_poses_.size(); ++i) {
      const Pose2 increment = between(odometry_poses_[i - 1].second, odometry_poses_[i].second);
      recording_.observations.emplace_back(
          Odometry{{odometry_poses_[i].first, 0}, increment, p_.odometry_noise.covariance(increment)});
    }
  }

  const RawlogParameters& p_;
  Recording& recording_;
  std::int64_t objects_ = 0;  // read so far; the next one's number, from 0
  std::int64_t frames_ = 0;
  std::int64_t frame_utime_ = 0;  // of the last frame
  std::optional<PoseGaussian> pending_;
  std::optional<std::int64_t> pending_utime_;
  std::vector<std::pair<std::int64_t, Pose2>> odometry_poses_;
  std::int64_t virtual_scans_ = 0;
  std::map<std::string, std::int64_t> left_out_;  // class -> count
};

}  // namespace

void read_rawlog(const RawlogParameters& parameters, const std::string& bytes, Recording& recording) {
  Reader(parameters, recording).read(bytes);
}

}  // namespace noctule::datasets
