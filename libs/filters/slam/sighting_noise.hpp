#pragma once
/// The noise of sightings as the landmark filters believe it: as the sensor states it, or learned on the way from the
/// residuals of all particles, one posterior for all.
#include <cmath>
#include <span>
#include <vector>

#include "filters/noise/noise_model.hpp"
#include "filters/slam/landmark_parameters.hpp"
#include "filters/slam/point_maps.hpp"

namespace noctule::filters {

/// Covariance (range, bearing) of what a filter expects of a sighting.
struct SightingCovariance {
  double rr, rb, bb;
};

/// Once per message: begin(), then judge() and note() for each particle, then learn(). Residuals are in units of the
/// noise that each sighting states, whitened by the lower triangular root of its covariance. Of a bearing or a range
/// alone nothing is learned, and its noise is what it states.
class SightingNoise {
 public:
  SightingNoise(const SightingNoiseParameters& parameters, std::size_t particles)
      : model_(parameters), particles_(particles) {}

  [[nodiscard]] bool learns() const { return model_.adapts(); }

  /// What is known of the noise fades. Sightings get the covariance that is believed of an innovation of 0, for
  /// associations and new landmarks.
  void begin(std::span<Sighting> sightings);

  /// What an innovation is made of.
  struct Judgement {
    double log_density;        ///< of the innovation
    double range, bearing;     ///< expected noise: what a Kalman update takes off the innovation
    SightingCovariance noise;  ///< and the covariance that it shall believe
    double nis;                ///< squared innovation normalised with the stated noise
  };
  /// \param expected covariance of the prediction, without noise
  [[nodiscard]] Judgement judge(const Sighting& z, const Innovation& v, const SightingCovariance& expected) const;

  /// Residuals of a particle whose map has been updated. Different particles may be noted by different threads.
  /// \param known number of its landmarks before
  void note(const ParticleView& view, const Pose2& pose, std::size_t known);

  /// Takes in the residuals, averaged over particles of these weights (linear, normalised).
  void learn(std::span<const double> weights);

  /// Root mean square of the believed noise over the latest sightings, in units of the stated one.
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] const models::NoiseMixture<2>& mixture() const { return model_.mixture(); }

  void transfer(StateArchive& archive) { archive(model_, scale_); }

 private:
  struct Residual {
    bool used = false;
    double range, bearing;
    double rr, rb, bb;  ///< second moments about 0
  };

  NoiseModel<2> model_;
  std::size_t particles_, width_ = 0;
  double scale_ = 1.0;
  std::vector<Residual> residuals_;        ///< all sightings of the first particle, then of the next
  std::vector<NoiseResidual<2>> learned_;  ///< scratch
};

/// Noise as the sensor states it, for the kernels.
struct StatedNoise {
  void note(const ParticleView&, const Pose2&, std::size_t) const {}
};

/// Learned noise, for the kernels.
struct LearnedNoise {
  SightingNoise& noise;

  void note(const ParticleView& view, const Pose2& pose, std::size_t known) const { noise.note(view, pose, known); }
};

}  // namespace noctule::filters
