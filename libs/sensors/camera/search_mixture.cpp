#include "sensors/camera/search_mixture.hpp"

#include <cmath>

#include "core/limits.hpp"
#include "core/log_weights.hpp"

namespace noctule::sensors {

TargetDraw SearchMixture::draw(const TargetMotion& motion, const MotionSaliency& saliency, const TargetState& before,
                               bool is_local, Rng& rng) const {
  TargetState s;
  if (is_local) {
    s = motion.draw(before, rng);
  } else {
    s.head<2>() = saliency.draw(rng);
    s[2] = rng.normal(0.0, speed_sd);
    s[3] = rng.normal(0.0, speed_sd);
    s[4] = rng.normal(log_scale, log_scale_sd);
  }
  const double jump = std::log1p(-local) + log_gaussian(s[2], speed_sd * speed_sd) +
                      log_gaussian(s[3], speed_sd * speed_sd) +
                      log_gaussian(s[4] - log_scale, log_scale_sd * log_scale_sd);
  const double salient = saliency.log_density(s.head<2>());
  const double uniform = std::isfinite(salient) ? saliency.log_uniform_density() : -kInf;
  const double dynamics = std::log(local) + motion.log_density(s, before);
  return {s, log_add_exp(dynamics, jump + uniform) - log_add_exp(dynamics, jump + salient)};
}

}  // namespace noctule::sensors
