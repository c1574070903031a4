#pragma once
/// MRPT rawlogs in and out. MRPT itself is in a plug-in (libs/datasets_mrpt) that is loaded when the first rawlog is
/// opened: linking it would cost every program 170 shared objects and a fifth of a second of start-up.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/parameters.hpp"
#include "datasets/recorded_source.hpp"
#include "models/odometry.hpp"

namespace noctule::datasets {

/// A virtual ultrasonic ring: rangers at the place of a laser scanner, each of which hears the nearest laser return
/// inside its cone. No real ultrasonic sensor: unless `margin` is set nothing is specular, nothing is missed.
struct VirtualRing {
  int sensors = 8;                    ///< spread evenly so that all cones fill the scanner's field; see `yaws`
  std::vector<double> yaws{};         ///< instead: axes of the cones in the frame of the base [rad]
  double half_angle = radians(10.0);  ///< half opening of each cone [rad]
  /// A cone hears nothing when a return so far outside it is nearer than all inside: the surface comes nearest to the
  /// ranger out there, and reflects away from it in here [rad].
  double margin = 0.0;
  double min_range = 0.02;  ///< [m]
  double max_range = 4.0;   ///< [m]

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = VirtualRing;
    v.field("sensors", &P::sensors, unit::one, "number of rangers, spread evenly over the scanner's field",
            at_least(1));
    v.field("yaws_deg", &P::yaws, unit::degree, "instead of `sensors`: axes of the cones in the frame of the base",
            between(-360, 360));
    v.field("half_angle_deg", &P::half_angle, unit::degree, "half the opening of each cone", positive());
    v.field("margin_deg", &P::margin, unit::degree,
            "a cone hears nothing when a return so far outside it is nearer than all inside; 0: it always hears",
            at_least(0.0));
    v.field("min_range_m", &P::min_range, unit::metre, "shorter ranges count as saturated", at_least(0.0));
    v.field("max_range_m", &P::max_range, unit::metre, "longer ranges count as no echo", positive());
  }
  [[nodiscard]] std::string validate() const {
    return min_range < max_range ? "" : "expected min_range_m below max_range_m";
  }
};

enum class OdometryCovariance : std::int8_t { recorded = 0, model = 1 };

struct RawlogParameters {
  std::filesystem::path path{};
  double frame_period = 0.0;  ///< time between two sensory frames where the recorded times are useless [s]; 0: recorded
  bool known_ids = true;      ///< sightings keep the landmark's number; else id -1
  VirtualRing ring{};         ///< made of each laser scan
  OdometryCovariance odometry_covariance = OdometryCovariance::recorded;  ///< of actions; CObservationOdometry has none
  models::OdometryRandomWalk odometry_noise{};
  double range_sd = 0.05;            ///< of sightings that say none [m]
  double bearing_sd = radians(1.0);  ///< of sightings that say none [rad]

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = RawlogParameters;
    v.field("path", &P::path, unit::one, "an MRPT rawlog");
    v.field("frame_period_s", &P::frame_period, unit::second,
            "time between two sensory frames where the recorded times are useless; 0: as recorded", at_least(0.0));
    v.field("known_ids", &P::known_ids, unit::one, "whether sightings carry the landmark's number");
    v.group("ring", &P::ring, "virtual ultrasonic ring made of each laser scan");
    v.choice("odometry_covariance", &P::odometry_covariance,
             {{"recorded", OdometryCovariance::recorded}, {"model", OdometryCovariance::model}},
             "stated covariance of the increments: that of the rawlog, or odometry_noise");
    v.group("odometry_noise", &P::odometry_noise, "stated covariance of increments that the rawlog gives none for");
    v.field("range_sd_m", &P::range_sd, unit::metre, "standard deviation of a sighting's range where none is given",
            positive());
    v.field("bearing_sd_deg", &P::bearing_sd, unit::degree,
            "standard deviation of a sighting's bearing where none is given", positive());
  }
};

/// Both kinds of rawlog: pairs of actions and sensory frames, or single observations.
/// CActionRobotMovement2D, CObservationOdometry -> Odometry; CObservation2DRangeScan -> UltrasonicScan of the virtual
/// ring; CObservationRange -> UltrasonicScan; CObservationBearingRange -> LandmarkDetections. An action is the motion
/// to its sensory frame; both take the time of the frame's earliest observation. Other classes are counted in a note. A
/// rawlog that was cut off is read up to its last whole object, with a note. The map frame is the first pose.
class RawlogSource : public RecordedSource {
 public:
  /// \throws InputError for a missing or damaged file, numbers that are not finite, sensors that are not level, frames
  ///         whose times do not ascend, cones beyond the scanner's field, a rawlog with nothing that can be used, a
  ///         missing plug-in
  explicit RawlogSource(const RawlogParameters& parameters);
};

/// Where the plug-in writes to.
class RawlogSink {
 public:
  virtual ~RawlogSink() = default;
  virtual void write(const Observation& observation) = 0;
  virtual void close() = 0;
};

/// Writes a run as a rawlog that MRPT's programs read (rawlog-edit, kf-slam, RawLogViewer): pairs of an action (the
/// odometry since the pair before) and a sensory frame (all sightings of one time). UltrasonicScan becomes
/// CObservationRange: single-precision ranges, and whatever is not Echo::hit is 0, "no echo". Range-bearing sightings
/// become CObservationBearingRange. Ground truth and sightings without range or bearing have no place in a rawlog and
/// are passed over. kf-slam itself stops at a frame without range-bearing sightings, such as one of ultrasonic ranges
/// alone.
class RawlogWriter {
 public:
  /// \throws InputError when the file cannot be created or the plug-in is missing
  explicit RawlogWriter(const std::filesystem::path& path);
  /// In the order of an ObservationSource.
  /// \throws InputError when the file cannot be written
  void write(const Observation& observation) { sink_->write(observation); }
  /// Completes the file; nothing may be written after it. Without it the file lacks the last frame.
  /// \throws InputError when the file cannot be written
  void close() { sink_->close(); }

 private:
  std::unique_ptr<RawlogSink> sink_;
};

/// What the plug-in exports under the name `noctule_rawlog_plugin`.
struct RawlogPlugin {
  /// Appends to the recording what the bytes of an unpacked rawlog hold.
  void (*read)(const RawlogParameters&, const std::string& bytes, Recording&);
  RawlogSink* (*create)(const std::filesystem::path&);  ///< the caller owns it
};

}  // namespace noctule::datasets
