#pragma once
/// The ultrasonic front end: scans and odometry in, contour features out.
#include <cstdint>
#include <span>
#include <vector>

#include "core/features.hpp"
#include "sensors/ultrasonic/depth_regions.hpp"
#include "sensors/ultrasonic/three_position.hpp"

namespace noctule::sensors {

struct ExtractorParameters {
  DepthRegionParameters regions;
  DecisionParameters decision;
  int min_readings = 2;      ///< smaller regions join tracks but start none
  int window = 12;           ///< sightings that a track keeps, at most kMaxSightings
  int patience = 24;         ///< scans that a track survives unseen
  double same_place = 0.01;  ///< sensor positions closer than this count as one [m]
  double gate = 0.999;       ///< probability that a region falls into the gate of its own track

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("regions", &ExtractorParameters::regions, "regions of constant depth");
    v.group("decision", &ExtractorParameters::decision, "wall, cylinder or point");
    v.field("min_readings", &ExtractorParameters::min_readings, unit::one,
            "fewest pings of a region that starts a track; smaller ones only join", at_least(1));
    v.field("window", &ExtractorParameters::window, unit::one, "sightings that the track of an object keeps",
            between(3, kMaxSightings));
    v.field("patience", &ExtractorParameters::patience, unit::one, "scans that a track survives unseen", at_least(1));
    v.field("same_place_cm", &ExtractorParameters::same_place, unit::centimetre,
            "sensor positions closer than this count as one", at_least(0.0));
    v.field("gate", &ExtractorParameters::gate, unit::one, "probability that a region falls into its track's gate",
            between(0.5, 0.999999));
  }
};

/// What was left out, since construction.
struct ExtractorCounts {
  std::int64_t beams = 0;          ///< hits with a range or pose that cannot be
  std::int64_t scans = 0;          ///< duplicate or late scans: seq or utime not after the scan before
  std::int64_t odometry = 0;       ///< duplicate or late odometry
  std::int64_t odometry_gaps = 0;  ///< gaps in the odometry's seq: all tracks were dropped
  friend bool operator==(const ExtractorCounts&, const ExtractorCounts&) = default;
};

/// Streaming extractor. Objects are tracked over scans in odometry-relative coordinates: every new region of constant
/// depth is assigned to the track whose surfaces predict it (or starts one); the track's sightings, each from its own
/// place, are fitted as wall, point and cylinder with the full covariance of hearing and odometry; the type is decided
/// once the evidence suffices and is revised only when the evidence turns against it.
///
/// Features of a scan: one per track that was heard in it. Every region of the scan is in exactly one of them, but for
/// regions below min_readings that no track predicts: those are in none. The
/// flags has_wall and has_circle tell which surfaces are still possible (probability above 1 - certainty): type
/// ambiguous without has_wall is a curved surface whose radius is open. wall_log_likelihood and
/// circle_log_likelihood are log p(later sightings | first sighting, kind), 0 for a single sighting. The radius of a
/// circle that is not known to be a point includes the radius prior; its variance says how little is known.
class UltrasonicExtractor {
 public:
  /// \throws InputError when a parameter is out of its range
  explicit UltrasonicExtractor(const ExtractorParameters& parameters);

  /// Takes a motion of the base. Duplicates are ignored; after a gap in seq the motion is unknown and all tracks are
  /// dropped.
  /// \throws InputError when the increment or its covariance is not finite or a variance is negative; nothing changes
  void predict(const Odometry& odometry);

  /// Features in base_link at the scan. A scan whose seq or utime is not after the last one is ignored (no features).
  /// \throws InputError when the cone or the limits of the scan make no sense
  [[nodiscard]] ContourFeatures update(const UltrasonicScan& scan);

  /// Range noise in units of the nominal sd, as the front end itself estimates it.
  [[nodiscard]] double noise_scale() const { return finder_.noise_scale(); }
  [[nodiscard]] ExtractorCounts counts() const;
  /// Objects that are followed at present.
  [[nodiscard]] std::size_t tracks() const { return tracks_.size(); }

 private:
  /// What a sighting was made of.
  struct Source {
    std::vector<ReadingId> readings;
    double noise_scale = 1.0;  ///< that its variance was made with
    int age = 0;               ///< scans since
  };
  struct Track {
    std::int64_t number = 0;
    std::vector<Sighting> sightings;  ///< oldest first
    std::vector<Source> sources;      ///< of each sighting
    SurfaceFits fits;
    Decision decision;
    int unseen = 0;
  };

  void move(const FrameChange& change);
  void distrust_recent(Track& track) const;
  void associate(const UltrasonicScan& scan, const std::vector<DepthRegion>& regions);
  void start_track(const Sighting& sighting, Source source);
  void add(Track& track, const Sighting& sighting, Source source) const;
  void thin(Track& track) const;
  void refit(Track& track);
  [[nodiscard]] bool still_fits(Track& track) const;
  [[nodiscard]] double cost(const Track& track, const Sighting& sighting) const;
  [[nodiscard]] ContourFeature feature(const Track& track) const;

  ExtractorParameters parameters_;
  double gate_;  ///< squared Mahalanobis distance
  DepthRegionFinder finder_;
  std::vector<Track> tracks_;
  std::int64_t next_number_ = 0;
  PoseGaussian pending_;  ///< motion since the last scan
  bool has_odometry_ = false, has_scan_ = false;
  Stamp last_odometry_, last_scan_;
  ExtractorCounts counts_;
};

/// A scan and the motion of the base since the scan before it (ignored for the first).
struct MovedScan {
  PoseGaussian motion;
  UltrasonicScan scan;
};

/// Batch: the same as streaming the scans. One feature per object ever tracked, as known when it was last heard, in
/// base_link at the last scan. Ascending by track.
/// \throws InputError as UltrasonicExtractor
[[nodiscard]] std::vector<ContourFeature> extract(std::span<const MovedScan> scans,
                                                  const ExtractorParameters& parameters);

}  // namespace noctule::sensors
