#pragma once
/// A recorded drive past point landmarks. The data are one stream: a seed is the filter's own.
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <variant>
#include <vector>

#include "datasets/mrclam.hpp"
#include "datasets/victoria_park.hpp"
#include "experiment/experiment.hpp"

namespace noctule::experiment {

struct RecordedLandmarksParameters {
  std::variant<datasets::MrclamParameters, datasets::VictoriaParkParameters> source;
  double sampling = 0.1;       ///< [s] least time between two poses that are judged
  double max_truth_gap = 0.5;  ///< [s] nothing is judged where truth is missing for longer
  double landmark_gate = 1.0;  ///< [m] farther landmarks are no pair, where identities are unknown
  double rpe_length = 10.0;    ///< [m] true way over which relative pose errors are taken

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = RecordedLandmarksParameters;
    v.one_of("source", &P::source, {"mrclam", "victoria_park"}, "the recording");
    v.field("sampling_s", &P::sampling, unit::second, "least time between two poses that are judged", positive());
    v.field("max_truth_gap_s", &P::max_truth_gap, unit::second,
            "nothing is judged where truth, or the estimate, is missing for longer", positive());
    v.field("landmark_gate_m", &P::landmark_gate, unit::metre,
            "farther landmarks are no pair, where identities are unknown", positive());
    v.field("rpe_length_m", &P::rpe_length, unit::metre, "true way over which relative pose errors are taken",
            positive());
  }
};

/// Filters: every SLAM filter, `dead_reckoning`, and, where the landmarks are known, the limits `known_map`
/// (localisation on the true landmarks) and `smoother`; where truth is fixes, the limit `fixes` (odometry and every
/// other fix, judged at the fixes between). These limits, and the map along dead reckoning, know the landmarks'
/// identities even where the filters are not told. None of them uses a seed. The trajectory that is judged is the
/// estimate at each message of sightings, carried on by odometry in between; the smoother's is its final path.
/// `position_rmse`, `position_max` and `heading_rmse` are taken after an SE(2) alignment of the positions over the span
/// of the truth, `position_rmse_unaligned` as the trajectory lies. Where truth is position fixes, poses are
/// interpolated at their times and there is neither heading nor relative pose error. Landmarks are moved along with the
/// trajectory, paired by id or, where sightings have none, by distance, and aligned once more among themselves.
class RecordedLandmarks : public Scenario {
 public:
  /// \throws InputError where the recording's folder is not there
  explicit RecordedLandmarks(const ScenarioSpec&);
  ~RecordedLandmarks() override;
  [[nodiscard]] std::vector<std::string> filters() const override;
  [[nodiscard]] std::vector<std::string> metrics() const override;
  void check(const FilterSpec&) const override;
  [[nodiscard]] std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec>) const override;

 private:
  struct Stream;
  [[nodiscard]] const Stream& stream() const;
  [[nodiscard]] FilterRun run_one(std::uint64_t seed, const FilterSpec&) const;

  RecordedLandmarksParameters parameters_;
  bool known_ids_ = false;
  mutable std::once_flag read_once_;
  mutable std::unique_ptr<const Stream> stream_;
  mutable std::mutex seedless_mutex_;
  mutable std::map<std::string, FilterRun> seedless_;  ///< by name and parameters: the same for every seed
};

}  // namespace noctule::experiment
