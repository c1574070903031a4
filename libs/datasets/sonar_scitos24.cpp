#include "datasets/sonar_scitos24.hpp"

#include <cmath>

#include "datasets/echo.hpp"
#include "datasets/table.hpp"

namespace noctule::datasets {
namespace {

constexpr int kSonars = 24;
constexpr double kMaxRange = 5.0;  // [m]; the file says 5.0 or a little more when nothing was heard

Recording read(const SonarScitos24Parameters& p) {
  TableFormat format{.separator = ',', .text_columns = 1};
  for (int i = 1; i <= kSonars; ++i) {
    format.columns.push_back(std::string("S").append(std::to_string(i)));
    format.header.append(format.columns.back()).append(",");
  }
  format.header += "OUTPUT";
  const Table table(p.path, format);

  Recording recording;
  recording.world.name = "SCITOS G5, ring of 24";
  recording.notes = table.notes();
  for (int row = 0; row < table.rows(); ++row) {
    UltrasonicScan scan{{std::llround(row / p.rate * 1e6), 0}, p.half_angle, p.min_range, kMaxRange, {}};
    for (int i = 0; i < kSonars; ++i) {
      const double range = table.at_least(0.0, row, i);
      scan.beams.push_back(
          ring_beam(wrap(-i * kTwoPi / kSonars), p.ring_radius, range >= kMaxRange ? kNoEcho : range, scan));
    }
    recording.observations.emplace_back(std::move(scan));
  }
  return recording;
}

}  // namespace

SonarScitos24::SonarScitos24(const SonarScitos24Parameters& parameters) : RecordedSource(read(parameters)) {}

}  // namespace noctule::datasets
