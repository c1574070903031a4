#pragma once
/// One ranger turned by hand about a fixed point of a room (G. Mamindlapalli, V. K. R. Sirigiri, W. Gao, J. Film,
/// "Ultrasonic Mapping", Northeastern University 2023; github.com/sirigiri-vasu/Ultrasonic-mapping): a MaxBotix MB1433
/// and a VectorNav VN-100 on one board.
#include <filesystem>

#include "core/parameters.hpp"
#include "datasets/recorded_source.hpp"

namespace noctule::datasets {

struct UltrasonicRoomsParameters {
  std::filesystem::path path{};            ///< one CSV of a run
  std::filesystem::path outline{};         ///< CSV of the room's measured corners; empty: none
  Pose2 start{1.5, 2.98, radians(-80.0)};  ///< roughly where the board stood, in the frame of the outline
  double half_angle = radians(15.0);       ///< half opening of the cone [rad]
  double lag = 0.1;                        ///< a range shows this long after its ping [s]
  double window = 0.0;                     ///< pings of so long make one scan [s]; 0: one scan of the whole run

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = UltrasonicRoomsParameters;
    v.field("path", &P::path, unit::one, "CSV of one run");
    v.field("outline", &P::outline, unit::one, "CSV of the room's corners; empty: no known room");
    v.field("start", &P::start, unit::metre_degree, "roughly where the board stood, in the frame of the outline");
    v.field("half_angle_deg", &P::half_angle, unit::degree, "half the opening of the cone", positive());
    v.field("lag_s", &P::lag, unit::second, "time from a ping to the row that shows its range", at_least(0.0));
    v.field("window_s", &P::window, unit::second, "pings of so long make one scan; 0: one scan of the run",
            at_least(0.0));
  }
};

/// Rows of time [s], yaw [rad] (NED: grows clockwise from above), pitch, roll, range [mm] and six inertial numbers at
/// 40 Hz. The ranger is slower and its last range is repeated (zero-order hold), so only rows where the range changes
/// are pings; a ping that repeats the very same millimetre is lost with them, and so is the first row, whose age is
/// not known. Ranges: 5000 or more no echo, 300 or less saturated, 0 ranger not connected (Echo::invalid).
/// Yields one scan, or one per window, stamped with its last row: the base stands still at `start` and each beam looks
/// along minus the yaw at its ping. Neither odometry nor ground truth; the start is rough.
class UltrasonicRooms : public RecordedSource {
 public:
  /// \throws InputError for a missing or damaged file, another header, negative ranges, times that step back, a run
  ///         without any ping
  explicit UltrasonicRooms(const UltrasonicRoomsParameters& parameters);
};

}  // namespace noctule::datasets
