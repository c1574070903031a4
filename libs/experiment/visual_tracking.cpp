#include "experiment/visual_tracking.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "config/config.hpp"
#include "core/error.hpp"
#include "core/limits.hpp"
#include "eval/box_overlap.hpp"
#include "experiment/opencv_tracker.hpp"
#include "experiment/slam_filters.hpp"
#include "sensors/camera/target_tracker.hpp"

namespace noctule::experiment {

/// What every filter sees, and the truth.
struct VisualTracking::Film {
  std::vector<Image> rendered;
  const std::vector<Image>* images = nullptr;
  std::vector<ImageBox> truth;
  std::vector<bool> judged;
  std::vector<int> losses;  ///< ascending
};

namespace {

using sensors::TargetProposal;

constexpr std::pair<const char*, TargetProposal> kParticleTrackers[] = {
    {"pf_tracker", TargetProposal::dynamics},
    {"kalman_pf_tracker", TargetProposal::kalman},
    {"unscented_pf_tracker", TargetProposal::unscented},
    {"saliency_pf_tracker", TargetProposal::saliency}};
constexpr const char* kKnownBox = "known_box";
constexpr int kReacquired = 3;  // [frames]

bool is_particle_tracker(const std::string& name) {
  return std::ranges::any_of(kParticleTrackers, [&](const auto& tracker) { return name == tracker.first; });
}

/// \throws InputError for a proposal that is another filter's
sensors::TargetTrackerParameters parameters_of(const FilterSpec& spec) {
  const config::Tree tree = effective_config(spec);
  const auto own = std::ranges::find_if(kParticleTrackers, [&](const auto& t) { return spec.name == t.first; });
  auto p = config::load<sensors::TargetTrackerParameters>(tree);
  const bool said = std::ranges::any_of(tree.entries, [](const config::Entry& e) { return e.key == "proposal"; });
  if (said && p.proposal != own->second)
    throw InputError("filter '" + spec.name + "': proposal: is what the name says, expected none");
  p.proposal = own->second;
  return p;
}

/// To where the target is not.
Vector2 displacement(const ImageBox& estimate, const Image& image) {
  const Vector2 size(image.width, image.height), by(0.4 * size.x(), 0.3 * size.y());
  return {estimate.centre.x() < 0.5 * size.x() ? by.x() : -by.x(),
          estimate.centre.y() < 0.5 * size.y() ? by.y() : -by.y()};
}

bool displaced(int every, std::size_t k) {
  return every > 0 && k > 0 && k % static_cast<std::size_t>(every) == 0;
}

template <class Film>
std::vector<ImageBox> run_particles(const FilterSpec& spec, const Film& film, int displace_every, std::uint64_t seed) {
  const auto& images = *film.images;
  sensors::TargetTracker tracker(parameters_of(spec), seed);
  tracker.start(images.front(), film.truth.front());
  std::vector<ImageBox> boxes{film.truth.front()};
  for (std::size_t k = 1; k < images.size(); ++k) {
    if (displaced(displace_every, k)) tracker.displace(displacement(tracker.estimate().box, images[k]));
    boxes.push_back(tracker.track(images[k]).box);
  }
  return boxes;
}

template <class Film>
std::vector<ImageBox> run_opencv(const std::string& name, const Film& film) {
  OpencvTracker tracker(name);
  tracker.start(film.images->front(), film.truth.front());
  std::vector<ImageBox> boxes{film.truth.front()};
  for (std::size_t k = 1; k < film.images->size(); ++k) boxes.push_back(tracker.track((*film.images)[k]));
  return boxes;
}

/// The first frame, which was given, is not judged.
template <class Film>
FilterRun judge(const std::vector<ImageBox>& boxes, const Film& film) {
  std::vector<ImageBox> estimates, truth;
  std::vector<double> overlaps, judged;
  FilterRun run;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    overlaps.push_back(overlap(boxes[k], film.truth[k]));
    if (k == 0 || !film.judged[k]) continue;
    estimates.push_back(boxes[k]);
    truth.push_back(film.truth[k]);
    judged.push_back(overlaps.back());
  }
  const eval::BoxTrackScores s = eval::box_track_scores(estimates, truth);
  double within = 0.0, frames = 0.0;
  const auto back = eval::reacquisitions(overlaps, film.losses);
  for (const eval::Reacquisition& r : back) {
    if (r.found && r.frames <= kReacquired) within += 1.0;
    frames += r.frames;
  }
  const auto losses = static_cast<double>(back.size());
  run.figures = {{"centre_rmse", s.centre_rmse, "1"},
                 {"overlap", s.overlap, "1"},
                 {"success_auc", s.success_auc, "1"},
                 {"success30", eval::success(judged, 0.3), "1"},
                 {"success50", eval::success(judged, 0.5), "1"},
                 {"success70", eval::success(judged, 0.7), "1"},
                 {"precision20", s.precision20, "1"},
                 {"reacquisition_frames", losses > 0.0 ? frames / losses : kNan, "1"},
                 {"reacquired3", losses > 0.0 ? within / losses : kNan, "1"}};
  return run;
}

}  // namespace

VisualTracking::VisualTracking(const ScenarioSpec& spec)
    : parameters_(config::load<VisualTrackingParameters>(spec.config)) {
  const auto* recorded = std::get_if<datasets::BoxedImagesParameters>(&parameters_.source);
  if (recorded != nullptr && !std::filesystem::is_directory(recorded->path)) {
    throw InputError("scenario '" + spec.name + "': source.path: expected the folder of a recording, got '" +
                     recorded->path.string() + "' (recordings are not part of Noctule)");
  }
}

std::vector<std::string> VisualTracking::filters() const {
  std::vector<std::string> names;
  for (const auto& tracker : kParticleTrackers) names.emplace_back(tracker.first);
  if (parameters_.displace_every == 0) names.insert(names.end(), {"opencv_kcf", "opencv_csrt"});
  names.insert(names.end(), {kDeadReckoning, kKnownBox});
  return names;
}

std::vector<std::string> VisualTracking::metrics() const {
  return {"centre_rmse", "overlap",     "success_auc",          "success30",  "success50",
          "success70",   "precision20", "reacquisition_frames", "reacquired3"};
}

void VisualTracking::check(const FilterSpec& filter) const {
  if (is_particle_tracker(filter.name)) {
    static_cast<void>(parameters_of(filter));
  } else if (const config::Tree tree = effective_config(filter); !tree.entries.empty()) {
    throw InputError("filter '" + filter.name + "': runs with its defaults, expected no configuration");
  }
}

VisualTracking::Film VisualTracking::film(std::uint64_t seed) const {
  Film film;
  if (const auto* p = std::get_if<sim::TargetFilmParameters>(&parameters_.source)) {
    const sim::TargetScene scene(*p, seed);
    for (int k = 0; k < scene.frames(); ++k) {
      film.rendered.push_back(scene.frame(k));
      film.truth.push_back(scene.truth(k));
      film.judged.push_back(scene.visible(k) >= 0.5);
    }
    film.losses = scene.losses();
  } else {
    const std::scoped_lock lock(mutex_);
    if (!recording_)
      recording_ = datasets::read_boxed_images(std::get<datasets::BoxedImagesParameters>(parameters_.source));
    film.images = &recording_->images;
    film.truth = recording_->boxes;
    film.judged.assign(film.truth.size(), true);
  }
  for (std::size_t k = 0; k < film.truth.size(); ++k) {
    if (displaced(parameters_.displace_every, k)) film.losses.push_back(static_cast<int>(k));
  }
  std::ranges::sort(film.losses);
  film.losses.erase(std::ranges::unique(film.losses).begin(), film.losses.end());
  return film;
}

FilterRun VisualTracking::run_one(const FilterSpec& spec, const Film& film, std::uint64_t seed) const {
  const double begin = cpu_seconds();
  const auto follow = [&]() -> std::vector<ImageBox> {
    if (is_particle_tracker(spec.name)) return run_particles(spec, film, parameters_.displace_every, seed);
    if (spec.name == kKnownBox) return film.truth;
    if (spec.name == kDeadReckoning) return std::vector(film.truth.size(), film.truth.front());
    return run_opencv(spec.name, film);
  };
  const std::vector<ImageBox> boxes = follow();
  const double seconds = cpu_seconds() - begin;
  FilterRun run = judge(boxes, film);
  run.timings = {{"cpu_per_frame", seconds / static_cast<double>(boxes.size()), "s"}};
  return run;
}

FilterRun VisualTracking::run_unseeded(const FilterSpec& spec, const Film& film) const {
  const std::scoped_lock lock(mutex_);
  const auto [place, is_new] = unseeded_.try_emplace(spec.name);
  if (is_new) place->second = run_one(spec, film, 0);
  return place->second;
}

std::vector<FilterRun> VisualTracking::run(std::uint64_t seed, std::span<const FilterSpec> filters) const {
  Film film = this->film(seed);
  const bool recorded = film.images != nullptr;
  if (!recorded) film.images = &film.rendered;
  std::vector<FilterRun> runs;
  for (const FilterSpec& spec : filters) {
    const bool seeded = !recorded || is_particle_tracker(spec.name);
    runs.push_back(seeded ? run_one(spec, film, seed) : run_unseeded(spec, film));
  }
  return runs;
}

}  // namespace noctule::experiment
