#pragma once
/// A pick-up truck among the trees of Victoria Park, Sydney: laser scanner, wheel encoder, steering and an intermittent
/// GPS (J. Guivant and E. Nebot, "Optimization of the simultaneous localization and map-building algorithm for
/// real-time implementation", IEEE Transactions on Robotics and Automation 17(3), 2001).
#include <filesystem>

#include "core/parameters.hpp"
#include "datasets/fix_filter.hpp"
#include "datasets/recorded_source.hpp"
#include "models/odometry.hpp"
#include "models/trunks.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::datasets {

/// Who found the trees.
enum class Trees {
  laser,     ///< models::find_trunks in the raw scans
  extracted  ///< the authors of the recording (detectTrees)
};

struct VictoriaParkParameters {
  std::filesystem::path path{};  ///< folder of the recording
  Trees trees = Trees::laser;
  double wheelbase = 2.83;              ///< L [m]
  double encoder_left = 0.76;           ///< H [m] the left rear wheel is so far beside the centre of the axle
  Pose2 laser_in_base{3.78, 0.5, 0.0};  ///< base_link is the centre of the rear axle
  /// Sum of what white noise and slow errors of the steering do within some ten seconds.
  models::OdometryRandomWalk odometry_noise{.along = 0.07, .drift = radians(0.5), .turn = radians(3.0)};
  /// Standard deviations twice as large as innovations bear out: what a filter gets wrong in one scan, it meets again
  /// in the next.
  models::TrunkParameters trunks;
  models::RangeNoise extracted_range_noise{.base = 0.6, .relative = 0.0};
  double extracted_bearing_sd = radians(1.2);  ///< [rad]
  FixFilterParameters fixes;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = VictoriaParkParameters;
    v.field("path", &P::path, "folder of aa3_dr.mat, aa3_gpsx.mat and so on");
    v.choice("trees", &P::trees, {{"laser", Trees::laser}, {"extracted", Trees::extracted}},
             "found in the raw scans, or by the authors of the recording");
    v.field("wheelbase_m", &P::wheelbase, unit::metre, "distance of the axles", positive());
    v.field("encoder_left_m", &P::encoder_left, unit::metre, "left rear wheel, from the centre of the axle");
    v.field("laser_in_base", &P::laser_in_base, unit::metre_degree, "scanner, from the centre of the rear axle");
    v.group("odometry_noise", &P::odometry_noise, "stated covariance of encoder and steering");
    v.group("trunks", &P::trunks, "how trees are found in the raw scans; max_range_m also holds for extracted ones");
    v.group("extracted_range_noise", &P::extracted_range_noise, "stated sd of the range of an extracted tree");
    v.field("extracted_bearing_sd_deg", &P::extracted_bearing_sd, unit::degree, "stated sd of its bearing", positive());
    v.group("fixes", &P::fixes, "which GPS fixes are believed");
  }
};

/// aa3_dr.mat (time [ms], speed [m/s] of the left rear wheel, steering [rad]), aa3_gpsx.mat (timeGps [ms], Lo_m, La_m),
/// and of the trees either the raw scans, LASER.txt or its member in victoria_park_ascii.zip (time [s] since the first
/// fix, 361 ranges [m] from right to left), or ObservationDistance.txt and ObservationAngle.txt (18 slots a scan, 0:
/// empty) with lasersampling.txt (time [ms]); each text also as .gz. Encoder and steering hold until the next. Yields
/// Odometry at every encoder row and every scan and LandmarkDetections, without identities, at every scan in which
/// trees were found. The receiver knows no heading: its believed fixes (believed_fixes) are in world().fixes and there
/// is no GroundTruth. The map frame is that of the receiver, x east, y north; start_in_map is fitted, by the fixes of
/// the first minute of motion to dead reckoning.
class VictoriaPark : public RecordedSource {
 public:
  /// \throws InputError for missing or damaged files
  explicit VictoriaPark(const VictoriaParkParameters& parameters);
};

}  // namespace noctule::datasets
