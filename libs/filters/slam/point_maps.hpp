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

namespace noctule::filters {

/// What a particle sees: its map, and what each sighting is of.
struct ParticleView {
  const LandmarkScan& scan;
  std::span<const std::int32_t> slots;  ///< see associate()
  LandmarkMaps& maps;
  std::size_t particle;
  double log_new_density;

  /// Whether the k-th sighting is of a landmark that was in the map before this scan.
  [[nodiscard]] bool is_known(std::size_t k, std::size_t size_before) const {
    return slots[k] >= 0 && static_cast<std::size_t>(slots[k]) < size_before;
  }
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
  [[nodiscard]] ParticleView view(std::size_t i) { return {scan_, slots(i), maps_, i, log_new_density_}; }
  /// After the updates: births, deaths and mergers of landmarks that the sensor does not name.
  void live();

  void resample(std::span<const std::uint32_t> ancestors) { maps_.resample(ancestors); }
  /// For filters that resample between association and update: offspring see what their ancestors did.
  void inherit(std::span<const std::uint32_t> ancestors);

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

  SightingParameters parameters_;
  std::optional<LandmarkLifeParameters> life_;
  int threads_;
  double log_new_density_;
  LandmarkMaps maps_;
  LandmarkScan scan_;
  bool shared_identity_ = true;
  std::vector<std::int32_t> slots_;                         ///< one row a particle, or one for all
  std::unordered_map<std::int64_t, std::int32_t> slot_of_;  ///< of each identity, where it is shared
  std::vector<LifeEvents> events_;                          ///< one per particle where landmarks live and die
};

}  // namespace noctule::filters
