#include "datasets/ultrasonic_rooms.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "datasets/outline.hpp"
#include "datasets/table.hpp"

namespace noctule::datasets {
namespace {

enum SweepColumn { kSweepTime = 0, kSweepYaw = 1, kSweepRange = 4 };

constexpr double kSaturatedMm = 300.0, kNoEchoMm = 5000.0;

// NED yaw at a time, linear between rows, held before the first.
double yaw_at(const Table& table, int last_row, double time) {
  int row = last_row;
  while (row > 0 && table(row, kSweepTime) > time) --row;
  const double t0 = table(row, kSweepTime), y0 = table(row, kSweepYaw);
  if (row == last_row || time <= t0) return y0;
  const double t1 = table(row + 1, kSweepTime), y1 = table(row + 1, kSweepYaw);
  return wrap(y0 + (time - t0) / (t1 - t0) * wrap(y1 - y0));
}

UltrasonicBeam ping(double yaw_ned, double range_mm) {
  const Pose2 sensor{0.0, 0.0, wrap(-yaw_ned)};
  if (range_mm == 0.0) return {sensor, 0.0, Echo::invalid};
  if (range_mm <= kSaturatedMm) return {sensor, 0.0, Echo::saturated};
  if (range_mm >= kNoEchoMm) return {sensor, 0.0, Echo::none};
  return {sensor, 1e-3 * range_mm, Echo::hit};
}

Recording read(const UltrasonicRoomsParameters& p) {
  const std::vector<std::string> columns{"t_unix_s", "yaw_rad", "pitch_rad", "roll_rad", "range_mm", "acc_x",
                                         "acc_y",    "acc_z",   "gyro_x",    "gyro_y",   "gyro_z"};
  std::string header = columns.front();
  for (std::size_t i = 1; i < columns.size(); ++i) header += "," + columns[i];
  const Table table(p.path, {.columns = columns, .separator = ',', .header = header});
  table.require_ascending(kSweepTime, true);

  Recording recording;
  recording.notes = table.notes();
  recording.world.name = "hand-turned sweep";
  recording.world.start_in_map = p.start;
  recording.world.start_is_rough = true;
  if (!p.outline.empty()) recording.world.room = read_outline(p.outline);

  UltrasonicScan scan{{}, p.half_angle, 1e-3 * kSaturatedMm, 1e-3 * kNoEchoMm, {}};
  std::int64_t window = 0;
  const auto finish = [&] {
    if (!scan.beams.empty()) recording.observations.emplace_back(scan);
    scan.beams.clear();
  };
  for (int row = 1; row < table.rows(); ++row) {
    const double range = table.at_least(0.0, row, kSweepRange);
    if (range == table(row - 1, kSweepRange)) continue;
    const std::int64_t utime = table.utime(row, kSweepTime, 1.0);
    if (p.window > 0.0) {
      const std::int64_t of_row = std::llround(std::floor((table(row, kSweepTime) - table(0, kSweepTime)) / p.window));
      if (of_row != window) finish();
      window = of_row;
    }
    scan.stamp.utime = utime;
    scan.beams.push_back(ping(yaw_at(table, row, table(row, kSweepTime) - p.lag), range));
  }
  finish();
  if (recording.observations.empty()) throw InputError(p.path.string() + ": expected ranges that change, got none");
  return recording;
}

}  // namespace

UltrasonicRooms::UltrasonicRooms(const UltrasonicRoomsParameters& parameters) : RecordedSource(read(parameters)) {}

}  // namespace noctule::datasets
