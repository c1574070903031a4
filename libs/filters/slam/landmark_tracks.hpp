#pragma once
/// Landmarks that are not yet on the map, because sightings of bearing or range alone have not fixed them: delayed
/// initialisation (Bailey 2003; for its criterion Sola 2005). A track keeps the sightings and, of each particle, the
/// poses that they were made from; no particle learns anything from them until they fix a place. Then each particle
/// finds the place from its own poses, and is weighed by how well they agree there: each sighting is used once.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "filters/slam/landmark_association.hpp"

namespace noctule::filters {

/// Where the sightings of a track agree best, from one particle's poses.
struct TrackFix {
  Vector2 place;
  Matrix2 covariance;  ///< by Gauss-Newton at that place
  double misfit;       ///< sum of the squared normalised residuals there
  int numbers;         ///< how many sightings it came from
  bool ranged;         ///< whether some of them were ranges
  double
      log_likelihood;  ///< of the sightings, the place integrated out by Laplace's method under a density of 1 per m^2
};

/// Sightings of one landmark by bearing or range alone.
struct LandmarkTrack {
  std::int64_t id = -1;                        ///< its name, or -1
  std::int64_t new_id = 0;                     ///< the name that it gets then
  std::int64_t first_seen = 0, last_seen = 0;  ///< messages
  int times_seen = 0;
  int misfits = 0;             ///< latest sightings, in a row, that did not agree with the others
  double spacing = 0.0;        ///< way between sightings that are kept [m]
  std::vector<Sighting> kept;  ///< oldest first
  std::vector<Pose2> sensors;  ///< row of each particle: the sensor at each sighting; NaN where the particle has used
                               ///< the sighting otherwise

  void transfer(StateArchive& archive) {
    archive(id, new_id, first_seen, last_seen, times_seen, misfits, spacing, kept, sensors, row, place, covariance);
  }
  [[nodiscard]] std::span<const Pose2> poses_of(std::size_t particle) const {
    return {sensors.data() + particle * row, kept.size()};
  }
  std::size_t row = 0;  ///< room for sightings
  /// Where the best particle of the time saw it, in the frame of the last sensor; the covariance too.
  std::optional<Vector2> place;
  Matrix2 covariance = Matrix2::Zero();
};

class LandmarkTracks {
 public:
  LandmarkTracks(std::size_t particles, const LandmarkTrackParameters& parameters)
      : parameters_(parameters), particles_(particles) {}

  [[nodiscard]] bool empty() const { return tracks_.empty(); }
  /// Begins a message: tracks that have waited too long end, and those of landmarks that the message fixes itself.
  void begin(const LandmarkScan& scan);
  /// Adds a sighting to the track of its name, or, of a bearing without name, to the one that it continues as
  /// particle `best` sees it; else it begins one.
  /// \param sensors pose of the sensor of each particle, NaN where the particle has used the sighting
  /// \return the track when its sightings now fix a place, as `best` sees it; valid until the next call
  const LandmarkTrack* add(const Sighting& z, std::span<const Pose2> sensors, std::size_t best);
  /// The place, as a particle sees it; nothing when its sightings do not fix one.
  /// \param guess where to begin the search; absent: anywhere
  [[nodiscard]] std::optional<TrackFix> fix(const LandmarkTrack& track, std::size_t particle,
                                            const std::optional<Vector2>& guess = {}) const;
  /// How well the sightings agree at a place, as a particle sees it, which knows it as well as the covariance says.
  [[nodiscard]] TrackFix judge(const LandmarkTrack& track, std::size_t particle, const Vector2& place,
                               const Matrix2& covariance) const;
  void remove(const LandmarkTrack& track);

  void resample(std::span<const std::uint32_t> ancestors);
  void transfer(StateArchive& archive) { archive(message_, tracks_); }

 private:
  [[nodiscard]] LandmarkTrack* find(const Sighting& z, const Pose2& sensor, std::size_t best);
  [[nodiscard]] bool continues(const LandmarkTrack& track, const Sighting& z, const Pose2& sensor, std::size_t best,
                               double& distance) const;
  void keep(LandmarkTrack& track, const Sighting& z, std::span<const Pose2> sensors);
  void thin(LandmarkTrack& track) const;
  [[nodiscard]] bool is_certain(const TrackFix& fix, const Pose2& sensor) const;

  LandmarkTrackParameters parameters_;
  std::size_t particles_;
  std::int64_t message_ = 0;
  std::vector<LandmarkTrack> tracks_;
};

}  // namespace noctule::filters
