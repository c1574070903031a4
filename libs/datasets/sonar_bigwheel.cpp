#include "datasets/sonar_bigwheel.hpp"

#include <cmath>

#include "datasets/arc.hpp"
#include "datasets/echo.hpp"
#include "datasets/table.hpp"

namespace noctule::datasets {
namespace {

enum Column { kLeft, kRight, kYaw, kFront, kRear, kLeftInfrared, kRightInfrared, kColumns };

constexpr double kCentimetre = 0.01;
constexpr double kSonarMaxRange = 5.0;     // [m]; the file says 500 or more when nothing was heard
constexpr double kInfraredMaxRange = 0.6;  // [m]; the file says 60 when nothing was seen
constexpr double kInfraredHalfAngle = radians(1.5);

double distance(const Table& table, int row, int column, double max_range) {
  const double d = table.at_least(0.0, row, column) * kCentimetre;
  return d >= max_range ? kNoEcho : d;
}

Recording read(const SonarBigwheelParameters& p) {
  const Table table(
      p.path, {.columns = {"left_ticks", "right_ticks", "yaw_deg", "front_cm", "rear_cm", "left_ir_cm", "right_ir_cm"},
               .separator = ',',
               .text_columns = 2});
  Recording recording;
  recording.world.name = "big wheel bot";
  recording.notes = table.notes();
  const double sign = p.clockwise_yaw ? -1.0 : 1.0;
  for (int row = 0; row < table.rows(); ++row) {
    for (int column = 0; column < kColumns; ++column) static_cast<void>(table.integer(row, column));
    const Stamp stamp{std::llround(row * p.period * 1e6), 0};
    if (row > 0) {
      const double length = 0.5 * (table(row, kLeft) + table(row, kRight)) * p.tick;
      const Pose2 step = arc(length, wrap(sign * radians(table(row, kYaw) - table(row - 1, kYaw))));
      recording.observations.emplace_back(Odometry{stamp, step, p.odometry_noise.covariance(step)});
    }
    UltrasonicScan sonar{stamp, p.half_angle, p.min_range, kSonarMaxRange, {}};
    sonar.beams = {ring_beam(0.0, p.front_offset, distance(table, row, kFront, kSonarMaxRange), sonar),
                   ring_beam(kPi, p.rear_offset, distance(table, row, kRear, kSonarMaxRange), sonar)};
    recording.observations.emplace_back(std::move(sonar));
    const double left = distance(table, row, kLeftInfrared, kInfraredMaxRange);
    const double right = distance(table, row, kRightInfrared, kInfraredMaxRange);
    if (!p.infrared) continue;
    UltrasonicScan sides{stamp, kInfraredHalfAngle, p.min_range, kInfraredMaxRange, {}};
    sides.beams = {ring_beam(0.5 * kPi, 0.0, left, sides), ring_beam(-0.5 * kPi, 0.0, right, sides)};
    recording.observations.emplace_back(std::move(sides));
  }
  return recording;
}

}  // namespace

SonarBigwheel::SonarBigwheel(const SonarBigwheelParameters& parameters) : RecordedSource(read(parameters)) {}

}  // namespace noctule::datasets
