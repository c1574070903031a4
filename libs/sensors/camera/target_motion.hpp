#pragma once
/// How a target moves in the image, and Kalman updates of one particle of it.
#include "core/gaussian.hpp"
#include "core/parameters.hpp"

namespace noctule::sensors {

/// Centre (u, v) [pixels], velocity [pixels a frame], log of the scale relative to the first frame.
using TargetState = VectorD<5>;

/// Nearly constant velocity from frame to frame: each component with normal noise of its own.
struct TargetMotion {
  double place_sd = 4.0;
  double speed_sd = 2.0;
  double scale_sd = 0.02;
  double damping = 1.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = TargetMotion;
    v.field("place_sd", &P::place_sd, unit::one, "sd of a step beyond the velocity, in pixels", positive());
    v.field("speed_sd", &P::speed_sd, unit::one, "sd of a change of velocity, in pixels a frame", positive());
    v.field("scale_sd", &P::scale_sd, unit::one, "sd of a change of log scale", positive());
    v.field("damping", &P::damping, unit::one, "share of the velocity that lasts to the next frame", between(0.0, 1.0));
  }

  [[nodiscard]] TargetState predict(const TargetState& state) const;
  [[nodiscard]] TargetState draw(const TargetState& before, Rng& rng) const;
  /// Of a state after one that was known.
  [[nodiscard]] double log_density(const TargetState& state, const TargetState& before) const;
  [[nodiscard]] TargetState noise_sd() const;
};

/// A target found in the image: its centre and width [pixels].
using TargetMeasurement = VectorD<3>;

struct TargetGaussian {
  TargetState mean;
  MatrixD<5> covariance;
};

/// The state after a known one, given a measurement (the optimal proposal of a linearised model: Doucet, Godsill,
/// Andrieu 2000). The width is width_at_1 exp(log scale): linearised, or by the unscented transform.
/// \param sd of the measurement [pixels]
[[nodiscard]] TargetGaussian extended_update(const TargetMotion& motion, const TargetState& before, double width_at_1,
                                             const TargetMeasurement& measurement, const TargetMeasurement& sd);
[[nodiscard]] TargetGaussian unscented_update(const TargetMotion& motion, const TargetState& before, double width_at_1,
                                              const TargetMeasurement& measurement, const TargetMeasurement& sd);

}  // namespace noctule::sensors
