#pragma once
/// Birth, confirmation, death and merging of landmarks that the sensor does not name.
#include <cstdint>
#include <span>
#include <vector>

#include "core/angles.hpp"
#include "core/parameters.hpp"
#include "filters/slam/landmark_association.hpp"

namespace noctule::filters {

/// Each landmark has log odds of existence; what should be seen and is not loses some.
struct LandmarkLifeParameters {
  double view_range = 5.0;                 ///< field of view: landmarks nearer than this ... [m]
  double view_half_angle = radians(60.0);  ///< ... and within this of the sensor's axis should be seen [rad] ...
  double view_margin = 3.0;                ///< ... unless so many sd from the edge of it
  double born = 0.405;                     ///< log odds of a new landmark (60 %)
  double seen = 2.197;                     ///< gain of a sighting (90 %)
  double missed = 0.847;                   ///< loss of a landmark in view that is not seen (30 %)
  double remove_below = -2.0;              ///< a landmark is forgotten below this
  double confirm_above = 2.2;              ///< and reported above this
  double merge_gate = 0.0;                 ///< squared Mahalanobis distance below which two landmarks are one; 0: never

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LandmarkLifeParameters;
    v.field("view_range_m", &P::view_range, unit::metre, "landmarks nearer than this should be seen", positive());
    v.field("view_half_angle_deg", &P::view_half_angle, unit::degree, "and within this of the sensor's axis",
            Range{.min = 0.0, .max = 180.0, .min_allowed = false});
    v.field("view_margin_sd", &P::view_margin, unit::one, "but for those so many sd from the edge of the view",
            at_least(0.0));
    v.field("born", &P::born, unit::one, "log odds of existence of a new landmark", any_finite());
    v.field("seen", &P::seen, unit::one, "gain in log odds of a landmark that is seen", at_least(0.0));
    v.field("missed", &P::missed, unit::one, "loss of one in view that is not seen", at_least(0.0));
    v.field("remove_below", &P::remove_below, unit::one, "log odds at which a landmark is forgotten", any_finite());
    v.field("confirm_above", &P::confirm_above, unit::one, "log odds at which the map reports it", any_finite());
    v.field("merge_gate", &P::merge_gate, unit::one,
            "squared Mahalanobis distance below which two landmarks are made one; 0: never", at_least(0.0));
  }
};

/// Whether a landmark lies in the field of view, so far from its edge that its and the pose's errors do not matter.
[[nodiscard]] bool should_be_seen(const PointLandmark& m, const Pose2& sensor, const Matrix3& pose_covariance,
                                  const LandmarkLifeParameters& life);

/// What a scan does to the landmarks of a particle beside the sightings it took.
struct LifeEvents {
  std::size_t size_before = 0;       ///< landmarks before the scan
  std::vector<std::int32_t> missed;  ///< slots that should have been seen, increasing
  std::int32_t survivor = -1;        ///< slot of a landmark that was seen ...
  std::int32_t duplicate = -1;       ///< ... and of another one at the same place
};

/// \param slots what the sightings are of: see associate()
void find_events(const LandmarkScan& scan, const PredictedPose& pose, const LandmarkMaps& maps, std::size_t particle,
                 const LandmarkLifeParameters& life, std::span<const std::int32_t> slots, LifeEvents& events);

/// After the sightings have been taken in. \pre the slots, the missed and the duplicate are the particle's own
void apply_events(LandmarkMaps& maps, std::size_t particle, const LandmarkLifeParameters& life,
                  std::span<const std::int32_t> slots, LifeEvents& events);

}  // namespace noctule::filters
