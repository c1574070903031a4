#pragma once
/// Particle filters that follow one target through a sequence of images.
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/image.hpp"
#include "core/image_box.hpp"
#include "core/parameters.hpp"
#include "particle/resampling.hpp"
#include "particle/weights.hpp"
#include "sensors/camera/appearance.hpp"
#include "sensors/camera/motion_saliency.hpp"
#include "sensors/camera/search_mixture.hpp"
#include "sensors/camera/target_motion.hpp"

namespace noctule::sensors {

/// Where particles are drawn.
enum class TargetProposal : std::int8_t {
  dynamics,  ///< plain particle filter
  saliency,  ///< dynamics where the target is found, motion saliency where it is lost, in between a mixture
  kalman,    ///< an extended Kalman filter's update of each particle by where it matches best nearby
  unscented  ///< the same by an unscented one
};

struct TargetTrackerParameters {
  int particles = 200;
  TargetProposal proposal = TargetProposal::saliency;
  particle::Resampling resampling = particle::Resampling::ssp;
  TargetMotion motion;
  AppearanceParameters appearance;
  MotionSaliencyParameters saliency;
  double found = 0.75;
  double lost = 0.6;
  int patience = 2;
  double least_search = 0.05;
  double lost_local = 0.3;
  double lost_uniform = 0.5;
  double jump_speed = 10.0;
  double jump_scale_sd = 0.1;
  double measured_sd = 3.0;
  double measured_scale_sd = 0.05;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = TargetTrackerParameters;
    v.field("particles", &P::particles, unit::one, "number of particles", between(1, 100000));
    v.choice("proposal", &P::proposal,
             {{"saliency", TargetProposal::saliency},
              {"dynamics", TargetProposal::dynamics},
              {"kalman", TargetProposal::kalman},
              {"unscented", TargetProposal::unscented}},
             "where particles are drawn");
    v.choice("resampling", &P::resampling, particle::resampling_choices(), "how particles are redrawn");
    v.group("motion", &P::motion, "how a target moves from frame to frame");
    v.group("appearance", &P::appearance, "how a target looks");
    v.group("saliency", &P::saliency, "motion saliency, of that proposal");
    v.field("found", &P::found, unit::one, "a target that matches better is followed", between(0.0, 1.0));
    v.field("lost", &P::lost, unit::one, "one that matches worse is lost, after some patience", between(0.0, 1.0));
    v.field("patience", &P::patience, unit::one, "number of frames of worse match until a target counts as lost",
            between(1, 1000));
    v.field("least_search", &P::least_search, unit::one,
            "share of the particles that search the whole image even while the target is found", between(0.0, 1.0));
    v.field("lost_local", &P::lost_local, unit::one,
            "share of the particles that go on from the best candidates while the target is lost", between(0.0, 1.0));
    v.field("lost_uniform", &P::lost_uniform, unit::one,
            "share of the searching particles that look anywhere while the target is lost: it may stand still",
            between(0.0, 1.0));
    v.field("jump_speed", &P::jump_speed, unit::one, "sd of a velocity after a jump, in pixels a frame", positive());
    v.field("jump_scale_sd", &P::jump_scale_sd, unit::one, "sd of log scale after a jump", positive());
    v.field("measured_sd", &P::measured_sd, unit::one,
            "sd in pixels of the best match as a measurement, of the proposals kalman and unscented", positive());
    v.field("measured_scale_sd", &P::measured_scale_sd, unit::one, "the same of its width, relative", positive());
  }
  [[nodiscard]] std::string validate() const { return lost <= found ? "" : "lost must not be above found"; }
};

struct TargetEstimate {
  ImageBox box;
  Vector2 velocity = Vector2::Zero();  ///< [pixels a frame]
  double confidence = 0.0;             ///< similarity to the target, in [0, 1]
  bool lost = false;
};

/// With the proposal `saliency`, local_share() of the particles is drawn by the dynamics and the rest from the motion
/// saliency, weighted as by SearchMixture; with the others all go by the dynamics.
class TargetTracker {
 public:
  /// \throws InputError for parameters outside their ranges
  TargetTracker(const TargetTrackerParameters& parameters, std::uint64_t seed);
  ~TargetTracker();
  TargetTracker(TargetTracker&&) noexcept;
  TargetTracker& operator=(TargetTracker&&) noexcept;

  /// Takes the first frame and where the target is in it. May be called again.
  /// \throws InputError for an inconsistent image, or a box that is not finite, smaller than 4 pixels, or outside of
  /// the image
  void start(const Image& image, const ImageBox& target);
  /// Takes the next frame. \throws InputError for an inconsistent image or one of another size than the first, and the
  /// tracker stays as it was; std::logic_error before start()
  const TargetEstimate& track(const Image& image);

  [[nodiscard]] const TargetEstimate& estimate() const { return estimate_; }
  /// Share of the particles that the next frame draws by the dynamics.
  [[nodiscard]] double local_share() const { return local_; }
  [[nodiscard]] const std::vector<TargetState>& particles() const { return states_; }
  /// Moves every particle, so that the target is where they are not: for tests of finding it again.
  void displace(const Vector2& offset);

 private:
  void look(const char* stream);
  void propose(std::uint64_t stream);
  [[nodiscard]] bool is_local(std::size_t i, double offset) const;
  [[nodiscard]] TargetDraw draw_mixed(const TargetState& before, bool local, Rng& rng) const;
  [[nodiscard]] TargetDraw draw_updated(const TargetState& before, Rng& rng) const;
  [[nodiscard]] TargetMeasurement best_match(const TargetState& predicted) const;
  [[nodiscard]] ImageBox box_of(const TargetState& state) const;
  void weigh();
  void set_estimate();
  void decide();
  void resample();

  TargetTrackerParameters parameters_;
  std::uint64_t seed_;
  std::unique_ptr<const particle::Resampler> resampler_;
  std::uint64_t frame_ = 0;
  int width_ = 0, height_ = 0;      ///< of the images
  Vector2 size_ = Vector2::Zero();  ///< of the target at scale 1
  std::optional<FrameFeatures> features_;
  std::optional<Appearance> appearance_;
  std::optional<MotionSaliency> saliency_;
  double local_ = 1.0;
  int doubtful_frames_ = 0;
  double confident_log_scale_ = 0.0;
  std::vector<TargetState> states_, before_, scratch_;
  std::vector<double> log_ratios_, log_likelihoods_, linear_;
  particle::Weights weights_;
  std::vector<std::uint32_t> counts_, ancestors_;
  TargetEstimate estimate_;
};

}  // namespace noctule::sensors
