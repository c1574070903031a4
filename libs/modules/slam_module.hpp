#pragma once
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <variant>

#include "filters/slam/make_slam_filter.hpp"
#include "modules/module.hpp"

namespace noctule::modules {

struct SlamModuleParameters {
  filters::SlamFilterParameters filter;
  double map_period = 5.0;
  int particles_shown = 200;
  double lag = 0.0;

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
  void publish_estimate();
  void publish_map();
  void on_finish() override;

  SlamModuleParameters parameters_;
  SlamInput input_;
  std::unique_ptr<filters::SlamFilter> filter_;
  std::deque<Input> lagging_;     ///< by time
  std::int64_t moved_utime_ = 0;  ///< of the latest odometry that the filter may have
  std::deque<Input> waiting_;     ///< empty, or a scan without features and what came after it
  std::map<std::int64_t, ContourFeatures> early_features_;  ///< by number of the scan that they overtook
  double mean_nis_ = 1.0;                                   ///< NIS under the nominal noise, faded
  std::int64_t features_due_ = 0;                           ///< number of the first scan whose features may still come
  std::optional<std::int64_t> map_utime_;
};

}  // namespace noctule::modules
