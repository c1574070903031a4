#pragma once
/// Maps of a room's contour from sonar scans with known or estimated poses: all at once, or scan by scan.
#include <optional>
#include <span>

#include "mapping/arc_store.hpp"
#include "mapping/competition.hpp"

namespace noctule::mapping {

/// The map that all scans together give; the stamp is the last scan's. No scans, no walls. With
/// `single_stop.enabled` what each stop alone suggests (mapping/single_stop.hpp).
/// \throws InputError as check() of mapping/sonar_arc.hpp
[[nodiscard]] ContourMap map_contours(std::span<const PosedScan> scans, const MapperParameters& parameters);

/// The same, as scans arrive.
///
/// Echoes that an object explains move that object by one Gauss-Newton step on its own echoes; the others vote, and
/// when enough of them have come together new objects are sought among them alone. Everything is explained anew from
/// the beginning only when the number of echoes has doubled, so that the cost per echo does not grow with the run.
///
/// Memory is bounded by MapperParameters: `max_arcs` echoes (ArcStore decides which) of about 100 bytes, and
/// accumulators that cover what was seen, up to `max_extent`.
class ContourMapper {
 public:
  explicit ContourMapper(const MapperParameters& parameters);

  /// \throws InputError as check() of mapping/sonar_arc.hpp; the scan is then left out
  void add(const UltrasonicScan& scan, const Pose2& base_in_map);
  [[nodiscard]] ContourMap map() const;

 private:
  MapperParameters parameters_;
  ArcReader reader_;
  ArcStore store_;
  std::optional<Competition> competition_;  // from the first echo on
  std::vector<SonarArc> fresh_;
  Stamp stamp_;
  std::int64_t heard_ = 0;         // echoes
  std::int64_t restarted_at_ = 0;  // value of heard_ then
  std::int64_t settled_at_ = 0;
  int searched_at_ = 0;  // value of unexplained() then
};

}  // namespace noctule::mapping
