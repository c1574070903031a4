#pragma once
/// Localisation on a known map: what SLAM, which must make its map, is measured against.
#include <optional>
#include <vector>

#include "core/estimate.hpp"
#include "core/observations.hpp"
#include "core/parameters.hpp"
#include "core/source.hpp"

namespace noctule::filters {

struct EkfLocalisationParameters {
  double gate = 13.82;  ///< sightings of larger squared Mahalanobis distance are dropped (99.9 % of 2 numbers)

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("gate", &EkfLocalisationParameters::gate, unit::one,
            "sightings of larger squared Mahalanobis distance are dropped", positive());
  }
};

/// Extended Kalman filter of the pose (Thrun, Burgard and Fox, Probabilistic Robotics, table 7.2; Joseph form). The
/// map is taken as exact. Sightings with an identity belong to that landmark; those without are assigned together, each
/// landmark at most once, at the least sum of negative log likelihoods.
class EkfLocalisation {
 public:
  /// \param start pose of the base at the first observation, taken as certain
  /// \throws InputError for parameters out of range, a start or a map that is not finite
  EkfLocalisation(std::vector<KnownLandmark> map, const Pose2& start, const EkfLocalisationParameters& = {});

  /// \throws InputError as core/observation_checks.hpp says (both)
  void predict(const Odometry&);
  void update(const LandmarkDetections&);

  [[nodiscard]] const PoseGaussian& pose() const { return pose_; }
  /// Normalised innovation squared of the latest update, per degree of freedom, dropped sightings left out; 0: none.
  [[nodiscard]] double nis() const { return nis_; }

 private:
  struct Match;
  [[nodiscard]] Match match(const LandmarkDetection&, const Pose2& sensor_in_base, const KnownLandmark&) const;
  [[nodiscard]] std::vector<const KnownLandmark*> associate(const LandmarkDetections&) const;

  std::vector<KnownLandmark> map_;
  EkfLocalisationParameters parameters_;
  PoseGaussian pose_;
  double nis_ = 0.0;
};

}  // namespace noctule::filters
