#pragma once
/// Where particles of a target go that may have jumped.
#include "sensors/camera/motion_saliency.hpp"
#include "sensors/camera/target_motion.hpp"

namespace noctule::sensors {

/// A state and log(prior / proposal) of it.
struct TargetDraw {
  TargetState state;
  double log_ratio = 0.0;
};

/// The prior of a state after a known one is `local` p + (1 - local) u j: dynamics p, or a jump to a place that is
/// uniform in the image (u), with a velocity and a scale that have nothing to do with the ones before (j). Drawn is
/// from `local` p + (1 - local) g j with the motion saliency g, so that prior over proposal is never more than u / g.
struct SearchMixture {
  double local = 1.0;      ///< in [0, 1]
  double speed_sd = 10.0;  ///< of a component after a jump [pixels a frame]
  double log_scale = 0.0;  ///< after a jump, mean and sd
  double log_scale_sd = 0.1;

  /// \param is_local whether this draw is one of the dynamics: true with probability `local`
  [[nodiscard]] TargetDraw draw(const TargetMotion& motion, const MotionSaliency& saliency, const TargetState& before,
                                bool is_local, Rng& rng) const;
};

}  // namespace noctule::sensors
