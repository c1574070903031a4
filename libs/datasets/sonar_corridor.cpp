#include "datasets/sonar_corridor.hpp"

#include <array>
#include <cmath>
#include <filesystem>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "datasets/echo.hpp"
#include "datasets/table.hpp"

namespace noctule::datasets {
namespace {

constexpr std::array kBearingsDeg{-90.0, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90.0};
constexpr double kBeyondRangeMm = 5110.0;
constexpr double kMillimetre = 1e-3;

// An increment with noise added, and the covariance of what was added.
Odometry noisy(const Pose2& increment, const AddedNoise& noise, Rng rng) {
  Odometry odometry;
  odometry.increment = increment;
  if (!noise.enabled) return odometry;
  const double length = increment.position().norm();
  const double scale = noise.growth == NoiseGrowth::increment ? length : std::sqrt(length);
  const Vector2 direction = length > 0.0 ? Vector2(increment.position() / length) : Vector2(Vector2::Zero());
  const double distance_sd = noise.distance * scale, heading_sd = noise.heading * scale;
  const Vector2 moved = increment.position() + rng.normal(0.0, distance_sd) * direction;
  odometry.increment = {moved.x(), moved.y(), wrap(increment.yaw + rng.normal(0.0, heading_sd))};
  odometry.covariance.topLeftCorner<2, 2>() = distance_sd * distance_sd * direction * direction.transpose();
  odometry.covariance(2, 2) = heading_sd * heading_sd;
  return odometry;
}

Recording read(const SonarCorridorParameters& p) {
  const std::filesystem::path& folder = p.path;
  const Table ranges(folder / "measurement.txt",
                     {.columns = {"t_ms", "r1_mm", "r2_mm", "r3_mm", "r4_mm", "r5_mm", "r6_mm", "r7_mm", "r8_mm"}});
  const Table poses(folder / "poses.txt", {.columns = {"t_ms", "x_mm", "y_mm", "heading_decideg"}});
  ranges.require_ascending(0, false);
  poses.require_ascending(0, false);

  Recording recording;
  recording.world.name = "sonar corridor (truth: the given poses)";
  recording.notes = ranges.notes();
  recording.notes.insert(recording.notes.end(), poses.notes().begin(), poses.notes().end());
  const int rows = std::min(ranges.rows(), poses.rows());
  if (ranges.rows() != poses.rows()) {
    recording.notes.push_back(p.path.string() + ": measurement.txt has " + std::to_string(ranges.rows()) +
                              " records and poses.txt " + std::to_string(poses.rows()) + "; the first " +
                              std::to_string(rows) + " are used");
  }

  Pose2 previous;
  std::array<bool, kBearingsDeg.size()> fresh{};
  for (int row = 0; row < rows; ++row) {
    if (ranges(row, 0) != poses(row, 0)) {
      poses.refuse(row, 0, std::to_string(ranges.integer(row, 0)) + " as in measurement.txt");
    }
    const Stamp stamp{ranges.utime(row, 0, 1e-3), 0};
    const Pose2 pose{poses(row, 1) * kMillimetre, poses(row, 2) * kMillimetre, wrap(radians(0.1 * poses(row, 3)))};
    if (row == 0) {
      recording.world.start_in_map = pose;
    } else {
      const Rng rng(p.noise.seed, stream_id("sonar_corridor.odometry"), static_cast<std::uint64_t>(row));
      Odometry odometry = noisy(between(previous, pose), p.noise, rng);
      odometry.stamp = stamp;
      recording.observations.emplace_back(odometry);
    }
    previous = pose;
    recording.observations.emplace_back(GroundTruth{stamp, pose});

    UltrasonicScan scan{stamp, p.half_angle, p.min_range, p.max_range, {}};
    for (std::size_t i = 0; i < kBearingsDeg.size(); ++i) {
      const int column = static_cast<int>(i) + 1;
      const double raw = ranges.at_least(0.0, row, column);
      scan.beams.push_back(ring_beam(radians(kBearingsDeg[i]), p.ring_radius,
                                     raw >= kBeyondRangeMm ? kNoEcho : raw * kMillimetre, scan));
      fresh[i] = !fresh[i] || raw != ranges(row - 1, column);
      if (!fresh[i]) scan.beams.back() = {scan.beams.back().sensor_in_base, 0.0, Echo::invalid};
    }
    recording.observations.emplace_back(std::move(scan));
  }
  return recording;
}

}  // namespace

SonarCorridor::SonarCorridor(const SonarCorridorParameters& parameters) : RecordedSource(read(parameters)) {}

}  // namespace noctule::datasets
