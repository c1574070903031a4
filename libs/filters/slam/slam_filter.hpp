#pragma once
/// The one door of all SLAM filters: modules and experiments know them by this alone.
#include <cstdint>

#include "core/estimate.hpp"
#include "core/features.hpp"
#include "core/observations.hpp"
#include "core/state_archive.hpp"

namespace noctule::filters {

/// Every reading enters once. Observations that are not finite or otherwise unusable are refused with InputError and
/// leave the filter as it was. Results depend on parameters, seed and input alone, not on the number of threads.
class SlamFilter {
 public:
  virtual ~SlamFilter() = default;

  /// Motion since the previous call.
  virtual void predict(const Odometry& odometry) = 0;

  /// Sightings of point landmarks with known (id >= 0) or unknown identity. Ids that the filter gives to landmarks of
  /// its own are below -1. \throws InputError also when the seq is not above that of the previous message
  virtual void update(const LandmarkDetections& detections) = 0;

  /// \param features what the extractor made of the readings up to this scan, in base_link at the scan. May be empty,
  ///        or stale (no readings of this scan)
  /// \throws InputError also when the scan's seq is not above that of the previous one, and always where the filter
  ///         hears nothing
  virtual void update(const UltrasonicScan& scan, const ContourFeatures& features) = 0;

  /// As of the latest observation, before resampling; the start before any.
  [[nodiscard]] virtual SlamEstimate estimate() const = 0;
  /// One pose per observation (scan or message of sightings), each with the seq of its own channel.
  [[nodiscard]] virtual PathEstimate path() const = 0;
  [[nodiscard]] virtual LandmarkMap map() const = 0;
  /// All particles, or `at_most` drawn systematically, equally weighted; empty where the filter has none.
  [[nodiscard]] virtual ParticleCloud particles(int at_most) const = 0;
  /// How often the likelihood of all particles was 0 and the weights were made equal.
  [[nodiscard]] virtual std::int64_t collapses() const = 0;

  /// Begins on a map that is known beforehand, and somewhere among these poses: before any observation.
  /// \throws InputError when the map has landmarks that are not points, or there is no pose
  virtual void begin_on(const LandmarkMap& map, const ParticleCloud& poses) = 0;

  /// The whole state, between two observations: a filter of the same parameters and seed that reads it goes on as this
  /// one would, bit by bit. \throws InputError when the bytes are no state of such a filter: then it is of no use any
  /// more
  virtual void transfer(StateArchive& archive) = 0;
};

}  // namespace noctule::filters
