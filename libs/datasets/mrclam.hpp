#pragma once
/// One robot of a UTIAS MR.CLAM data set: sightings of bar-coded landmarks by a monocular camera, with motion-capture
/// truth (K. Leung, Y. Halpern, T. Barfoot, H. Liu, "The UTIAS multi-robot cooperative localization and mapping
/// dataset", International Journal of Robotics Research 30(8), 2011).
#include <filesystem>

#include "core/parameters.hpp"
#include "datasets/recorded_source.hpp"
#include "models/odometry.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::datasets {

struct MrclamParameters {
  std::filesystem::path path{};  ///< folder of a data set
  int robot = 1;                 ///< which of its robots
  bool known_ids = true;         ///< landmarks carry their subject number; else id -1
  bool swap_11_17 = false;       ///< exchange the true places of landmarks 11 and 17: a known fault of data set 1
  bool spread_seconds = false;  ///< truth times are rounded to whole seconds: spread their rows over [s - 0.5, s + 0.5)
  double speed_scale = 1.0;     ///< true over commanded speed
  double turn_scale = 1.0;      ///< true over commanded turn rate
  double range_scale = 1.0;     ///< a range r is measured as range_scale * r + range_bias
  double range_bias = 0.0;      ///< [m]
  /// Consistent with the truth of data set 6 over windows of 2 to 5 s; over longer ones the commands' scale errors,
  /// which no random walk describes, make it a little optimistic.
  models::OdometryRandomWalk odometry_noise{.along = 0.07, .drift = radians(3.0), .turn = radians(7.0)};
  models::RangeNoise range_noise{.base = 0.05, .relative = 0.03};
  double bearing_sd = radians(1.2);  ///< [rad]

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = MrclamParameters;
    v.field("path", &P::path, unit::one, "folder of Robot*_Odometry.dat, Barcodes.dat and so on");
    v.field("robot", &P::robot, unit::one, "number of the robot", between(1, 5));
    v.field("known_ids", &P::known_ids, unit::one, "whether sightings carry the landmark's number");
    v.field("swap_11_17", &P::swap_11_17, unit::one, "exchange the true places of landmarks 11 and 17 (data set 1)");
    v.field("spread_seconds", &P::spread_seconds, unit::one, "spread truth whose times are whole seconds");
    v.field("speed_scale", &P::speed_scale, unit::one, "true over commanded speed", positive());
    v.field("turn_scale", &P::turn_scale, unit::one, "true over commanded turn rate", positive());
    v.field("range_scale", &P::range_scale, unit::one, "measured over true range, beyond the bias", positive());
    v.field("range_bias_m", &P::range_bias, unit::metre, "what is measured at a true range of 0");
    v.group("odometry_noise", &P::odometry_noise, "stated covariance of the integrated commands");
    v.group("range_noise", &P::range_noise, "stated standard deviation of a sighting's range");
    v.field("bearing_sd_deg", &P::bearing_sd, unit::degree, "stated standard deviation of a sighting's bearing",
            positive());
  }
};

/// Robot<n>_Odometry.dat (time, v, w: commands), Robot<n>_Measurement.dat (time, bar code, range, bearing),
/// Robot<n>_Groundtruth.dat (or .csv; may be absent), Barcodes.dat, Landmark_Groundtruth.dat; each also as .gz.
/// A command holds until the next. Yields Odometry at every odometry row and at every sighting (so that its pose is
/// the one at the sighting), LandmarkDetections with all sightings of one time stamp, and GroundTruth between the first
/// and the last odometry row. Other robots, bar codes of nobody and sightings outside that time are left out with a
/// note. The map frame is that of the motion capture; the start is the truth at the first odometry row.
class Mrclam : public RecordedSource {
 public:
  /// \throws InputError for missing or damaged files, negative ranges, times that step back
  explicit Mrclam(const MrclamParameters& parameters);
};

}  // namespace noctule::datasets
