#pragma once
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <variant>

#include "filters/localisation/global_localisation.hpp"
#include "filters/slam/make_slam_filter.hpp"
#include "modules/filter_state.hpp"
#include "modules/module.hpp"

namespace noctule::modules {

/// A map that an earlier run has made.
struct PriorMapParameters {
  std::filesystem::path map;
  bool relocalise = true;
  filters::GlobalLocalisationParameters localisation;
  filters::SightingParameters sightings;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = PriorMapParameters;
    v.field("map", &P::map, "a file that save_state of an earlier run has written, whatever its filter");
    v.field("relocalise", &P::relocalise, "the robot is somewhere on the map; else where the source says it starts");
    v.group("localisation", &P::localisation, "how it is found there");
    v.group("sightings", &P::sightings, "sightings meanwhile; of these, new_density and new_above count");
  }
  [[nodiscard]] std::string validate() const { return map.empty() ? "map: expected a file" : ""; }
};

struct SlamModuleParameters {
  filters::SlamFilterParameters filter;
  double map_period = 5.0;
  int particles_shown = 200;
  double lag = 0.0;
  std::filesystem::path save_state, load_state;
  std::optional<PriorMapParameters> prior;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SlamModuleParameters;
    v.one_of("filter", &P::filter, filters::kSlamFilterNames, "which filter, and its parameters");
    v.field("map_period_s", &P::map_period, unit::second, "time between two maps and paths on the bus", positive());
    v.field("particles_shown", &P::particles_shown, unit::one, "most particles on the bus, for the eye",
            between(0, 1000));
    v.field("lag_s", &P::lag, unit::second,
            "time that everything waits for sightings of its time from a camera in another process; 0: none",
            at_least(0.0));
    v.field("save_state", &P::save_state, "file that the filter's whole state is written to at the end; empty: none");
    v.field("load_state", &P::load_state,
            "file of such a state to go on from: what that run has seen is skipped; empty: none");
    v.group("prior", &P::prior, "a map of an earlier run to begin on; absent: none");
  }
  [[nodiscard]] std::string validate() const {
    return prior && !load_state.empty() ? "prior: expected no load_state beside it, which brings its own map" : "";
  }
};

/// What the filter is fed with beside odometry.
struct SlamInput {
  bool features = true;  ///< scans come with CONTOUR_FEATURES of an ultrasonic module: wait for them
  bool camera = false;   ///< sightings come from a camera module, which may still have some when the source has ended
};

/// ODOMETRY, ULTRASONIC_SCAN, CONTOUR_FEATURES, LANDMARK_DETECTIONS -> SLAM_ESTIMATE after each scan and sighting,
/// SLAM_PARTICLES with it, SLAM_MAP and SLAM_PATH now and then and at the end.
/// A scan waits for its features, and what comes meanwhile waits behind it, so that the filter sees everything in the
/// order of the source however the messages of two processes interleave. When the next scan comes first, the features
/// are lost or late: the scan goes in without, which is counted.
/// Sightings of a camera in another process come when the base has moved on. With a lag, everything waits for so long
/// (of message time) and goes in by time; sightings that are older than the odometry in the filter are dropped and
/// counted.
/// On a map of an earlier run the robot is looked for first: SLAM_ESTIMATE and SLAM_PARTICLES are of that search until
/// the pose is known, and the filter begins there. What the search has seen teaches the map nothing.
class SlamModule : public Module {
 public:
  SlamModule(bus::Bus& bus, const SlamModuleParameters& parameters, const SlamInput& input, std::uint64_t seed,
             const Pose2& start, int threads = 1);

 private:
  using Input = std::variant<Odometry, UltrasonicScan, LandmarkDetections>;

  void receive(Input input);
  void take(Input input);
  void take_features(const ContourFeatures& features);
  void process_waiting(const ContourFeatures* features);
  void process(const Input& input, const ContourFeatures& features);
  void begin_on(const PriorMapParameters& prior, const Pose2& start);
  bool localise(const Input& input);
  void publish_estimate(const SlamEstimate& estimate, const ParticleCloud& particles);
  void publish_map();
  void on_finish() override;

  SlamModuleParameters parameters_;
  SlamInput input_;
  FilterIdentity identity_;
  std::unique_ptr<filters::SlamFilter> filter_;
  std::optional<LandmarkMap> prior_;                         ///< that the robot is still looked for on ...
  std::optional<filters::GlobalLocalisation> localisation_;  ///< ... by this
  std::int64_t seen_until_;                                  ///< time of the latest observation
  std::optional<std::int64_t> resumed_at_;                   ///< what is not newer is in the state that was loaded
  std::deque<Input> lagging_;                                ///< by time
  std::int64_t moved_utime_ = 0;                             ///< of the latest odometry that the filter may have
  std::deque<Input> waiting_;  ///< empty, or a scan without features and what came after it
  std::map<std::int64_t, ContourFeatures> early_features_;  ///< by number of the scan that they overtook
  double mean_nis_ = 1.0;                                   ///< NIS under the nominal noise, faded
  std::int64_t features_due_ = 0;                           ///< number of the first scan whose features may still come
  std::optional<std::int64_t> map_utime_;
};

}  // namespace noctule::modules
