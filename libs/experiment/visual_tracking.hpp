#pragma once
/// One target followed through a film: rendered, with a seed of its own, or recorded with a box drawn in every frame.
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "datasets/boxed_images.hpp"
#include "experiment/experiment.hpp"
#include "sim/target_scene.hpp"

namespace noctule::experiment {

struct VisualTrackingParameters {
  std::variant<sim::TargetFilmParameters, datasets::BoxedImagesParameters> source;
  int displace_every = 0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = VisualTrackingParameters;
    v.one_of("source", &P::source, {"film", "boxed_images"}, "the images");
    v.field("displace_every", &P::displace_every, unit::one,
            "every so many frames all particles are moved by 0.4 widths and 0.3 heights of the image, toward its far "
            "side; 0: never",
            at_least(0));
  }
};

/// Filters: `pf_tracker`, `kalman_pf_tracker`, `unscented_pf_tracker` and `saliency_pf_tracker` (TargetTracker, told
/// apart by their proposal), OpenCV's `opencv_kcf` and `opencv_csrt`, which cannot be displaced, `dead_reckoning`,
/// which leaves the box where it was first, and the limit `known_box`. Every one is given the box of the first frame.
/// Judged are the frames in which at least half of the target is visible. A target is lost where it jumps, comes out
/// from behind something, or the particles are displaced; `reacquired3` is the share of losses after which the overlap
/// exceeds 0.5 within 3 frames, `reacquisition_frames` the mean number of frames until then (until the next loss or the
/// end where that never happens).
class VisualTracking : public Scenario {
 public:
  explicit VisualTracking(const ScenarioSpec&);
  [[nodiscard]] std::vector<std::string> filters() const override;
  [[nodiscard]] std::vector<std::string> metrics() const override;
  void check(const FilterSpec&) const override;
  [[nodiscard]] std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec>) const override;

 private:
  struct Film;
  [[nodiscard]] Film film(std::uint64_t seed) const;
  [[nodiscard]] FilterRun run_one(const FilterSpec&, const Film&, std::uint64_t seed) const;
  [[nodiscard]] FilterRun run_unseeded(const FilterSpec&, const Film&) const;

  VisualTrackingParameters parameters_;
  mutable std::mutex mutex_;
  mutable std::optional<datasets::BoxedImages> recording_;  ///< read once
  mutable std::map<std::string, FilterRun> unseeded_;       ///< what does not draw makes of the recording
};

}  // namespace noctule::experiment
