#pragma once
/// Where on a known map the robot is, from anywhere: Monte Carlo localisation (Dellaert, Fox, Burgard, Thrun 1999)
/// whose particles are drawn from the first sighting (the dual form: Thrun, Fox, Burgard, Dellaert 2001), so that few
/// of them cover a large map.
#include <cstdint>
#include <optional>
#include <vector>

#include "core/angles.hpp"
#include "core/estimate.hpp"
#include "core/parameters.hpp"
#include "filters/slam/landmark_association.hpp"
#include "filters/slam/odometry_proposal.hpp"
#include "filters/slam/path_particles.hpp"

namespace noctule::filters {

struct GlobalLocalisationParameters {
  int particles = 20000;
  double view_range = 30.0;               ///< no landmark is seen from farther away [m]
  double settled_position = 0.5;          ///< the pose is known when its sd is below this [m] ...
  double settled_heading = radians(5.0);  ///< ... and this [rad] ...
  int settled_scans = 5;                  ///< ... in so many scans in a row

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = GlobalLocalisationParameters;
    v.field("particles", &P::particles, unit::one, "number of particles", Range{.min = 10, .max = 10'000'000});
    v.field("view_range_m", &P::view_range, unit::metre, "no landmark is seen from farther away", positive());
    v.field("settled_position_m", &P::settled_position, unit::metre, "the pose is known when its sd is below this",
            positive());
    v.field("settled_heading_deg", &P::settled_heading, unit::degree, "and that of its heading below this", positive());
    v.field("settled_scans", &P::settled_scans, unit::one, "in so many scans in a row", at_least(1));
  }
};

/// The map stays as it is; its uncertainty is part of the likelihood. A sighting with an identity is of that landmark,
/// one without of any: its density is the sum over them. Either may be of something that is not on the map.
class GlobalLocalisation {
 public:
  /// \throws InputError for parameters out of range, or a map without point landmarks
  GlobalLocalisation(const LandmarkMap& map, const GlobalLocalisationParameters& parameters,
                     const SightingParameters& sightings, std::uint64_t seed);

  /// \throws InputError as core/observation_checks.hpp says (both)
  void predict(const Odometry& odometry);
  void update(const LandmarkDetections& detections);

  /// Whether the pose is known well enough to go on with.
  [[nodiscard]] bool settled() const { return settled_for_ >= parameters_.settled_scans; }
  /// Meaningless before the first sighting of something on the map.
  [[nodiscard]] const SlamEstimate& estimate() const { return particles_.estimate(); }
  [[nodiscard]] ParticleCloud cloud(int at_most) const { return particles_.cloud(at_most); }

 private:
  [[nodiscard]] bool spread(const LandmarkDetections& detections);
  [[nodiscard]] ObservationFit fit(const Pose2& sensor, std::span<const Sighting> sightings, std::size_t skipped) const;
  void jitter();

  GlobalLocalisationParameters parameters_;
  MatchRule rule_;
  std::uint64_t seed_;
  std::vector<PointLandmark> map_;
  OdometryProposal proposal_;
  PathParticles particles_;
  std::vector<ObservationFit> fits_;
  bool spread_ = false;
  double gap_ = 0.0;    ///< between neighbouring particles [m]; halved by every resampling
  double reach_ = 1.0;  ///< from the landmark they are about [m]
  int settled_for_ = 0;
};

}  // namespace noctule::filters
