#include "modules/slam_module.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "modules/names.hpp"
#include "noctule/contour_features.hpp"
#include "noctule/landmark_detections.hpp"
#include "noctule/odometry.hpp"
#include "noctule/ultrasonic_scan.hpp"
#include "report/text.hpp"

namespace noctule::modules {
namespace {

/// Learned noise explains any innovation away. Those under the configured noise are watched, therefore, and reported
/// when their mean over so many observations is so large (it should be 1).
constexpr double kSurprisingNis = 4.0, kNisMemory = 5.0;

}  // namespace

SlamModule::SlamModule(bus::Bus& bus, const SlamModuleParameters& parameters, const SlamInput& input,
                       std::uint64_t seed, const Pose2& start, int threads)
    : Module(bus, name::kSlam),
      parameters_(parameters),
      input_(input),
      identity_{parameters.filter, seed},
      filter_(filters::make_slam_filter(parameters.filter, seed, start, threads)),
      seen_until_(std::numeric_limits<std::int64_t>::min()) {
  if (!parameters.load_state.empty()) {
    seen_until_ = load_filter_state(parameters.load_state, *filter_, identity_);
    resumed_at_ = seen_until_;
  }
  if (parameters.prior) begin_on(*parameters.prior, start);
  listen<odometry>(bus::channel::kOdometry, [this](const Odometry& o) { receive(o); });
  listen<landmark_detections>(bus::channel::kLandmarkDetections, [this](const LandmarkDetections& d) { receive(d); });
  listen<ultrasonic_scan>(bus::channel::kUltrasonicScan, [this](const UltrasonicScan& scan) { receive(scan); });
  std::set<std::string> awaited{name::kSource};
  if (input.features) {
    listen<contour_features>(bus::channel::kContourFeatures, [this](const ContourFeatures& f) { take_features(f); });
    awaited.insert(name::kUltrasonic);
  }
  if (input.camera) awaited.insert(name::kCamera);
  finish_after(std::move(awaited));
}

void SlamModule::receive(Input input) {
  const auto utime = [](const Input& i) { return std::visit([](const auto& value) { return value.stamp.utime; }, i); };
  if (parameters_.lag == 0.0) return take(std::move(input));
  const auto later = std::ranges::upper_bound(lagging_, utime(input), {}, utime);
  lagging_.insert(later, std::move(input));
  const std::int64_t due = utime(lagging_.back()) - std::llround(1e6 * parameters_.lag);
  while (utime(lagging_.front()) <= due) {
    Input next = std::move(lagging_.front());
    lagging_.pop_front();
    take(std::move(next));
  }
}

void SlamModule::begin_on(const PriorMapParameters& prior, const Pose2& start) {
  LandmarkMap map = load_state_map(prior.map);
  try {
    if (!prior.relocalise) return filter_->begin_on(map, {{}, {{start, 1.0}}});
    localisation_.emplace(map, prior.localisation, prior.sightings, identity_.seed);
  } catch (const InputError& e) {
    throw InputError(prior.map.string() + ": " + e.what());
  }
  prior_ = std::move(map);
}

void SlamModule::take(Input input) {
  if (const auto* motion = std::get_if<Odometry>(&input)) moved_utime_ = motion->stamp.utime;
  if (const auto* sightings = std::get_if<LandmarkDetections>(&input)) {
    if (input_.camera && sightings->stamp.utime < moved_utime_) {
      return count_dropped("sightings " + std::to_string(sightings->stamp.seq) +
                           " came when the base had moved on: see slam.lag_s");
    }
  }
  const auto* scan = std::get_if<UltrasonicScan>(&input);
  if (scan == nullptr || !input_.features) {
    if (waiting_.empty()) return process(input, {});
    waiting_.push_back(std::move(input));
    return;
  }
  if (!waiting_.empty()) {
    count_dropped("scan " + std::to_string(std::get<UltrasonicScan>(waiting_.front()).stamp.seq) +
                  " went into the filter without its contour features");
    process_waiting(nullptr);
  }
  const std::int64_t seq = scan->stamp.seq;
  waiting_.push_back(std::move(input));
  const auto early = early_features_.extract(seq);
  if (!early.empty()) process_waiting(&early.mapped());
  early_features_.erase(early_features_.begin(), early_features_.upper_bound(seq));
}

void SlamModule::take_features(const ContourFeatures& features) {
  const bool awaited = !waiting_.empty() && std::get<UltrasonicScan>(waiting_.front()).stamp.seq == features.stamp.seq;
  if (awaited) return process_waiting(&features);
  if (features.stamp.seq < features_due_) {
    return count_dropped("contour features of scan " + std::to_string(features.stamp.seq) + " came too late");
  }
  early_features_.emplace(features.stamp.seq, features);
}

void SlamModule::process_waiting(const ContourFeatures* features) {
  const std::deque<Input> inputs = std::exchange(waiting_, {});
  features_due_ = std::get<UltrasonicScan>(inputs.front()).stamp.seq + 1;
  process(inputs.front(), features != nullptr ? *features : ContourFeatures{});
  for (std::size_t i = 1; i < inputs.size(); ++i) process(inputs[i], {});
}

/// \return whether the robot has not been found before this
bool SlamModule::localise(const Input& input) {
  if (!localisation_) return false;
  if (const auto* motion = std::get_if<Odometry>(&input)) {
    localisation_->predict(*motion);
  } else if (const auto* detections = std::get_if<LandmarkDetections>(&input)) {
    localisation_->update(*detections);
    publish_estimate(localisation_->estimate(), localisation_->cloud(parameters_.particles_shown));
    if (localisation_->settled()) {
      filter_->begin_on(*prior_, localisation_->cloud(std::numeric_limits<int>::max()));
      localisation_.reset();
    }
  }
  return true;
}

void SlamModule::process(const Input& input, const ContourFeatures& features) {
  const std::int64_t utime = std::visit([](const auto& o) { return o.stamp.utime; }, input);
  if (resumed_at_ && utime <= *resumed_at_) return;
  seen_until_ = std::max(seen_until_, utime);
  if (localise(input)) return;
  if (const auto* motion = std::get_if<Odometry>(&input)) return filter_->predict(*motion);
  if (const auto* scan = std::get_if<UltrasonicScan>(&input)) filter_->update(*scan, features);
  if (const auto* detections = std::get_if<LandmarkDetections>(&input)) filter_->update(*detections);
  publish_estimate(filter_->estimate(), filter_->particles(parameters_.particles_shown));
}

void SlamModule::publish_estimate(const SlamEstimate& estimate, const ParticleCloud& particles) {
  publish(bus::channel::kSlamEstimate, estimate);
  mean_nis_ += (estimate.nis - mean_nis_) / kNisMemory;
  if (mean_nis_ > kSurprisingNis) {
    warn("innovations are far above the configured noise (normalised squares of " + report::fixed(mean_nis_, 1) +
         ", expected 1): " +
         (estimate.noise_scale != 1.0
              ? "the filter takes the noise to be " + report::fixed(estimate.noise_scale, 1) + " times as large; "
              : std::string("this filter goes on with the configured noise; ")) +
         "either it is larger, or the pose or the map is wrong");
  }
  if (parameters_.particles_shown > 0) {
    publish(bus::channel::kSlamParticles, particles);
  }
  const std::int64_t utime = estimate.stamp.utime;
  if (!map_utime_) map_utime_ = utime;
  if (seconds(utime - *map_utime_) < parameters_.map_period) return;
  map_utime_ = utime;
  publish_map();
}

void SlamModule::publish_map() {
  if (filter_->collapses() > 0) {
    warn("the likelihood of all particles vanished " + std::to_string(filter_->collapses()) + " times");
  }
  publish(bus::channel::kSlamMap, filter_->map());
  publish(bus::channel::kSlamPath, filter_->path());
}

void SlamModule::on_finish() {
  for (Input& input : std::exchange(lagging_, {})) take(std::move(input));
  if (!waiting_.empty()) {
    count_dropped("the last scan went into the filter without its contour features");
    process_waiting(nullptr);
  }
  publish_map();
  if (localisation_) warn("the robot was not found on the map of the earlier run");
  if (!parameters_.save_state.empty()) save_filter_state(parameters_.save_state, *filter_, identity_, seen_until_);
}

}  // namespace noctule::modules
