#pragma once
/// Point landmarks of all particles, and the way of a message of sightings into them: begin, associate, make_writable,
/// then each particle's map is updated through its view (particle_kernel.hpp), and live.
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "filters/slam/landmark_association.hpp"
#include "filters/slam/landmark_life.hpp"
#include "filters/slam/landmark_maps.hpp"
#include "filters/slam/landmark_tracks.hpp"
#include "filters/slam/observation_fit.hpp"

namespace noctule::filters {

/// What a particle sees: its map, and what each sighting is of.
struct ParticleView {
  const LandmarkScan& scan;
  std::span<const std::int32_t> slots;  ///< see associate()
  LandmarkMaps& maps;
  std::size_t particle;
  const MatchRule& rule;

  /// Whether the k-th sighting is of a landmark that was in the map before this scan.
  [[nodiscard]] bool is_known(std::size_t k, std::size_t size_before) const {
    return slots[k] >= 0 && static_cast<std::size_t>(slots[k]) < size_before;
  }
  /// Log density of the k-th sighting where it is of no landmark.
  [[nodiscard]] double log_new(std::size_t k) const { return rule.log_density_of_new(scan.sightings[k].kind); }
  [[nodiscard]] const PointLandmark& landmark(std::size_t k) const {
    return maps.at(particle, static_cast<std::size_t>(slots[k]));
  }
};

/// As long as all sightings carry an identity, all particles have the same landmarks in the same slots, and identities
/// are looked up once for all.
class PointMaps {
 public:
  PointMaps(std::size_t particles, const SightingParameters& sightings,
            const std::optional<LandmarkLifeParameters>& life = {}, MapStorage storage = MapStorage::automatic,
            int threads = 1);

  /// Takes a message, which is checked already. Named sightings come first and in the order of their names, so that no
  /// result depends on how they were sent. Landmarks that the filter names get ids from next_id on, counting down.
  void begin(const LandmarkDetections& detections, std::int64_t& next_id);
  /// \param poses before the motion
  void associate(std::span<const Pose2> poses, const PoseGaussian& motion);
  /// Makes what the views will write the particles' own.
  void make_writable();
  [[nodiscard]] ParticleView view(std::size_t i) { return {scan_, slots(i), maps_, i, rule_}; }
  /// After the updates: births, deaths and mergers of landmarks that the sensor does not name, and births of those that
  /// bearings or ranges alone have fixed.
  /// \param poses of the particles at the scan
  /// \param best a particle with a good weight
  /// \param fits what the particles say of the scan, to which births add
  /// \return whether they did
  bool live(std::span<const Pose2> poses, std::size_t best, std::span<ObservationFit> fits);

  void resample(std::span<const std::uint32_t> ancestors) {
    maps_.resample(ancestors);
    tracks_.resample(ancestors);
  }
  /// For filters that resample between association and update: offspring see what their ancestors did.
  void inherit(std::span<const std::uint32_t> ancestors);

  /// Gives every particle these landmarks, before any sighting. Names below -1 are the filter's own.
  /// \param next_id goes below them
  void begin_on(std::span<const PointLandmark> map, std::int64_t& next_id);
  /// All but what the present scan says.
  void transfer(StateArchive& archive);

  [[nodiscard]] const LandmarkScan& scan() const { return scan_; }
  /// To adapt their covariances, between begin and associate.
  [[nodiscard]] std::span<Sighting> sightings() { return scan_.sightings; }
  [[nodiscard]] const LandmarkMaps& maps() const { return maps_; }
  /// Whether a landmark has been seen often enough to be reported.
  [[nodiscard]] bool is_confirmed(const PointLandmark& m) const {
    return !life_ || m.id >= 0 || m.existence >= life_->confirm_above;
  }

 private:
  [[nodiscard]] std::span<const std::int32_t> slots(std::size_t i) const {
    return {slots_.data() + (shared_identity_ ? 0 : i * scan_.sightings.size()), scan_.sightings.size()};
  }
  void find_named();
  bool track(std::span<const Pose2> poses, std::size_t best, std::span<ObservationFit> fits);
  void begin_landmark(const LandmarkTrack& track, std::size_t best, std::span<ObservationFit> fits);

  MatchRule rule_;
  std::optional<LandmarkLifeParameters> life_;
  int threads_;
  LandmarkMaps maps_;
  LandmarkTracks tracks_;
  LandmarkScan scan_;
  bool shared_identity_;
  std::vector<std::int32_t> slots_;                         ///< one row a particle, or one for all
  std::unordered_map<std::int64_t, std::int32_t> slot_of_;  ///< of each identity, where it is shared
  std::vector<Pose2> sensors_;                              ///< scratch, of tracks
  std::vector<std::optional<TrackFix>> births_;             ///< scratch, of the particles
  std::vector<LifeEvents> events_;                          ///< one per particle where landmarks live and die
};

}  // namespace noctule::filters
