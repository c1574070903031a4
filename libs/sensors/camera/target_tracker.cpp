#include "sensors/camera/target_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/check.hpp"
#include "core/limits.hpp"
#include "core/log_weights.hpp"
#include "sensors/camera/grey_image.hpp"

namespace noctule::sensors {
namespace {

constexpr double kLeastSide = 4.0;        // of a target [pixels]
constexpr double kLeastLocalShare = 0.5;  // until a target counts as lost
constexpr double kSearchStep = 0.1;       // of a best match nearby, in sides of the target
constexpr double kSearchScale = 0.05;     // the same of log scale
constexpr double kModeRadius = 0.3;       // of the estimate, in sides of the target
constexpr int kModeSteps = 5;

Vector2 place_of(const TargetState& state) {
  return state.head<2>();
}

}  // namespace

TargetTracker::TargetTracker(const TargetTrackerParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), seed_(seed), weights_(1) {
  require_sound(parameters_, "target tracker");
  resampler_ = particle::make_resampler(parameters_.resampling);
  const auto n = static_cast<std::size_t>(parameters_.particles);
  weights_ = particle::Weights(n);
  states_.resize(n);
  scratch_.resize(n);
  log_ratios_.resize(n);
  log_likelihoods_.resize(n);
  linear_.resize(n);
  counts_.resize(n);
  ancestors_.resize(n);
}
TargetTracker::~TargetTracker() = default;
TargetTracker::TargetTracker(TargetTracker&&) noexcept = default;
TargetTracker& TargetTracker::operator=(TargetTracker&&) noexcept = default;

void TargetTracker::start(const Image& image, const ImageBox& target) {
  check_image(image, "target tracker");
  const Vector2 least = target.centre - 0.5 * target.size, most = target.centre + 0.5 * target.size;
  if (!target.is_sound() || target.size.minCoeff() < kLeastSide || least.minCoeff() < -1.0 || most.x() > image.width ||
      most.y() > image.height) {
    throw InputError("target tracker: expected a target inside of the first image of " + std::to_string(image.width) +
                     " x " + std::to_string(image.height) + " pixels, at least 4 pixels wide and high, got centre (" +
                     std::to_string(target.centre.x()) + ", " + std::to_string(target.centre.y()) + "), size (" +
                     std::to_string(target.size.x()) + ", " + std::to_string(target.size.y()) + ")");
  }
  width_ = image.width;
  height_ = image.height;
  size_ = target.size;
  frame_ = 0;
  features_.emplace(size_);
  features_->update(image);
  appearance_.emplace(parameters_.appearance, *features_, target);
  if (parameters_.proposal == TargetProposal::saliency) {
    saliency_.emplace(parameters_.saliency);
    saliency_->update(image);
  }
  TargetState state = TargetState::Zero();
  state.head<2>() = target.centre;
  std::ranges::fill(states_, state);
  weights_.make_uniform();
  confident_log_scale_ = 0.0;
  doubtful_frames_ = 0;
  local_ = 1.0;
  estimate_ = {target, Vector2::Zero(), appearance_->compare(*features_, target).joint(), false};
}

const TargetEstimate& TargetTracker::track(const Image& image) {
  if (!appearance_) throw std::logic_error("target tracker: start() comes first");
  check_image(image, "target tracker", width_, height_);
  ++frame_;
  features_->update(image);
  if (saliency_) {
    saliency_->update(image);
    before_ = states_;
  }
  look("target_tracker.proposal");
  if (saliency_ && estimate_.confidence < parameters_.lost && local_ > kLeastLocalShare) {
    // A jump shows in the saliency of this very frame: look once more, wider.
    states_ = before_;
    weights_.make_uniform();
    local_ = kLeastLocalShare;
    look("target_tracker.second_look");
  }
  if (estimate_.confidence >= parameters_.found) {
    confident_log_scale_ = std::log(estimate_.box.size.x() / size_.x());
    appearance_->adapt(*features_, estimate_.box);
  }
  decide();
  resample();
  return estimate_;
}

void TargetTracker::displace(const Vector2& offset) {
  for (TargetState& state : states_) state.head<2>() += offset;
  estimate_.box.centre += offset;
}

/// Of any particle with probability local_, of all together within one of N local_ (a comb with a random offset).
bool TargetTracker::is_local(std::size_t i, double offset) const {
  const double at = static_cast<double>(i) * local_ + offset;
  return std::floor(at + local_) > std::floor(at);
}

void TargetTracker::look(const char* stream) {
  if (saliency_ && local_ < 1.0)
    saliency_->prepare(std::exp(confident_log_scale_) * size_, estimate_.lost ? parameters_.lost_uniform : 0.0);
  propose(stream_id(stream));
  weigh();
  set_estimate();
}

void TargetTracker::propose(std::uint64_t stream) {
  const double offset = Rng(seed_, stream_id("target_tracker.mixture"), frame_).uniform();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    Rng rng(seed_, stream, frame_, static_cast<std::uint32_t>(i));
    const bool updated =
        parameters_.proposal == TargetProposal::kalman || parameters_.proposal == TargetProposal::unscented;
    const TargetDraw draw = updated ? draw_updated(states_[i], rng) : draw_mixed(states_[i], is_local(i, offset), rng);
    states_[i] = draw.state;
    log_ratios_[i] = draw.log_ratio;
  }
}

TargetDraw TargetTracker::draw_mixed(const TargetState& before, bool local, Rng& rng) const {
  if (local_ >= 1.0) return {parameters_.motion.draw(before, rng), 0.0};
  const SearchMixture mixture{local_, parameters_.jump_speed, confident_log_scale_, parameters_.jump_scale_sd};
  return mixture.draw(parameters_.motion, *saliency_, before, local, rng);
}

/// One step of mean shift on the likelihood about a predicted state, then over scales.
TargetMeasurement TargetTracker::best_match(const TargetState& predicted) const {
  const auto log_likelihood = [&](const TargetState& s) {
    return appearance_->log_likelihood(appearance_->compare(*features_, box_of(s)));
  };
  const Vector2 step = kSearchStep * box_of(predicted).size;
  std::array<double, 9> logs{};
  std::array<Vector2, 9> places;
  for (std::size_t k = 0; k < 9; ++k) {
    TargetState s = predicted;
    s[0] += (static_cast<double>(k % 3) - 1.0) * step.x();
    s[1] += (static_cast<double>(k / 3) - 1.0) * step.y();
    places[k] = place_of(s);
    logs[k] = log_likelihood(s);
  }
  normalise_log_weights(logs);
  TargetState best = predicted;
  best.head<2>().setZero();
  for (std::size_t k = 0; k < 9; ++k) best.head<2>() += std::exp(logs[k]) * places[k];
  std::array<double, 3> scales{};
  for (std::size_t k = 0; k < 3; ++k) {
    TargetState s = best;
    s[4] += (static_cast<double>(k) - 1.0) * kSearchScale;
    scales[k] = log_likelihood(s);
  }
  normalise_log_weights(scales);
  best[4] += kSearchScale * (std::exp(scales[2]) - std::exp(scales[0]));
  return {best[0], best[1], box_of(best).size.x()};
}

TargetDraw TargetTracker::draw_updated(const TargetState& before, Rng& rng) const {
  const TargetMotion& motion = parameters_.motion;
  const TargetMeasurement z = best_match(motion.predict(before));
  const TargetMeasurement sd(parameters_.measured_sd, parameters_.measured_sd, parameters_.measured_scale_sd * z[2]);
  const TargetGaussian g = parameters_.proposal == TargetProposal::kalman
                               ? extended_update(motion, before, size_.x(), z, sd)
                               : unscented_update(motion, before, size_.x(), z, sd);
  const auto llt = cholesky<5>(g.covariance);
  TargetState noise;
  for (int k = 0; k < 5; ++k) noise[k] = rng.normal();
  const TargetState offset = llt.matrixL() * noise;
  const TargetState s = g.mean + offset;
  return {s, motion.log_density(s, before) - log_gaussian<5>(offset, llt)};
}

ImageBox TargetTracker::box_of(const TargetState& state) const {
  return {place_of(state), std::exp(std::clamp(state[4], -10.0, 10.0)) * size_};
}

void TargetTracker::weigh() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const ImageBox box = box_of(states_[i]);
    const bool sensible = box.centre.x() >= -0.5 && box.centre.y() >= -0.5 && box.centre.x() <= width_ - 0.5 &&
                          box.centre.y() <= height_ - 0.5 && box.size.minCoeff() >= kLeastSide &&
                          box.size.x() <= width_ && box.size.y() <= height_;
    const Similarity s = sensible ? appearance_->compare(*features_, box) : Similarity{};
    log_likelihoods_[i] = appearance_->log_likelihood(s) + log_ratios_[i];
  }
  weights_.multiply(log_likelihoods_);
}

/// Mean of the heaviest particle's mode.
void TargetTracker::set_estimate() {
  weights_.linear(linear_);
  const auto heaviest = static_cast<std::size_t>(std::ranges::max_element(linear_) - linear_.begin());
  TargetState mean = states_[heaviest];
  const double radius = kModeRadius * box_of(mean).size.minCoeff();
  for (int step = 0; step < kModeSteps; ++step) {
    TargetState sum = TargetState::Zero();
    double total = 0.0;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if ((place_of(states_[i]) - place_of(mean)).squaredNorm() > radius * radius) continue;
      sum += linear_[i] * states_[i];
      total += linear_[i];
    }
    if (!(total > 0.0)) break;
    mean = sum / total;
  }
  estimate_.box = box_of(mean);
  estimate_.velocity = mean.segment<2>(2);
  estimate_.confidence = appearance_->compare(*features_, estimate_.box).joint();
}

void TargetTracker::decide() {
  const double c = estimate_.confidence;
  doubtful_frames_ = c < parameters_.lost ? doubtful_frames_ + 1 : 0;
  if (c >= parameters_.found) estimate_.lost = false;
  if (doubtful_frames_ >= parameters_.patience) estimate_.lost = true;
  if (!saliency_) return;
  const double most = 1.0 - parameters_.least_search;
  if (estimate_.lost) {
    local_ = parameters_.lost_local;
  } else if (c >= parameters_.found) {
    local_ = most;
  } else {
    local_ = std::clamp((c - parameters_.lost) / (parameters_.found - parameters_.lost),
                        std::min(kLeastLocalShare, most), most);
  }
}

void TargetTracker::resample() {
  Rng rng(seed_, stream_id("target_tracker.resampling"), frame_);
  resampler_->offspring(linear_, static_cast<std::uint32_t>(states_.size()), rng, counts_);
  particle::place_in_slots(counts_, ancestors_);
  for (std::size_t i = 0; i < states_.size(); ++i) scratch_[i] = states_[ancestors_[i]];
  std::swap(states_, scratch_);
  weights_.make_uniform();
}

}  // namespace noctule::sensors
