#pragma once
/// A simulated vehicle among point landmarks: SLAM filters that see them by range and bearing.
#include <memory>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "sim/landmark_world.hpp"

namespace noctule::experiment {

struct LandmarkScenarioParameters {
  sim::LandmarkMapParameters world;
  sim::SteeredVehicleParameters vehicle;
  sim::LandmarkSensorParameters sensor;
  double match_within = 5.0;
  double series_period = 5.0;
  double rpe_length = 10.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LandmarkScenarioParameters;
    v.group("world", &P::world, "landmarks and way");
    v.group("vehicle", &P::vehicle, "a vehicle with steered front wheels");
    v.group("sensor", &P::sensor, "sightings of landmarks ahead");
    v.field("match_within_m", &P::match_within, unit::metre,
            "where sightings carry no number: farther pairs of landmarks are no pairs; also cutoff of OSPA and GOSPA",
            positive());
    v.field("series_period_s", &P::series_period, unit::second, "time between two points of curves", positive());
    v.field("rpe_length_m", &P::rpe_length, unit::metre, "true way over which relative pose errors are taken",
            positive());
  }
};

/// Filters: all SLAM filters by their names; `dead_reckoning`, the landmarks put on the map along it; `known_pose`, the
/// same along the true path: the limit of maps; `smoother`, the most likely path and map given all sightings at once:
/// the limit of both. These three know which landmark each sighting is of and how large its noise was, so that their
/// lines are limits whatever the filters are told. Only landmarks that were sighted count as missed.
class LandmarkWorld : public Scenario {
 public:
  explicit LandmarkWorld(const ScenarioSpec&);
  [[nodiscard]] std::vector<std::string> filters() const override;
  [[nodiscard]] std::vector<std::string> metrics() const override;
  void check(const FilterSpec&) const override;
  [[nodiscard]] std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec>) const override;

 private:
  LandmarkScenarioParameters parameters_;
  std::shared_ptr<const sim::LandmarkScene> scene_;
};

}  // namespace noctule::experiment
