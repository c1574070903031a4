#include "experiment/landmark_world.hpp"

#include <memory>

#include "config/config.hpp"
#include "core/error.hpp"
#include "experiment/landmark_track.hpp"
#include "experiment/path_mapper.hpp"
#include "experiment/slam_filters.hpp"
#include "smoothing/landmark_smoother.hpp"

namespace noctule::experiment {
namespace {

/// What makes an estimate of each scan as it comes.
class Follower {
 public:
  virtual ~Follower() = default;
  virtual SlamEstimate take(const LandmarkScan&) = 0;
  [[nodiscard]] virtual LandmarkMap map() const = 0;
};

class FilterFollower : public Follower {
 public:
  FilterFollower(const FilterSpec& spec, std::uint64_t seed, const Pose2& start)
      : filter_(filters::make_slam_filter(slam_filter_parameters(spec), seed, start)),
        informed_(spec.name == kOracle) {}

  SlamEstimate take(const LandmarkScan& scan) override {
    for (const Odometry& o : scan.odometry) filter_->predict(o);
    filter_->update(informed_ ? scan.informed : scan.sightings);
    return filter_->estimate();
  }
  [[nodiscard]] LandmarkMap map() const override { return filter_->map(); }

 private:
  std::unique_ptr<filters::SlamFilter> filter_;
  bool informed_;
};

class TruePath : public Follower {
 public:
  explicit TruePath(const Pose2& start) : mapper_(start) {}

  SlamEstimate take(const LandmarkScan& scan) override {
    mapper_.take(scan.informed, scan.truth);
    SlamEstimate e;
    e.pose = scan.truth;
    return e;
  }
  [[nodiscard]] LandmarkMap map() const override { return mapper_.map(); }

 private:
  PathMapper mapper_;
};

class DeadReckoning : public Follower {
 public:
  explicit DeadReckoning(const Pose2& start) : pose_{start, Matrix3::Zero()}, mapper_(start) {}

  SlamEstimate take(const LandmarkScan& scan) override {
    for (const Odometry& o : scan.odometry) pose_ = pose_ * PoseGaussian{o.increment, o.covariance};
    mapper_.take(scan.informed, pose_.mean);
    SlamEstimate e;
    e.pose = pose_.mean;
    e.covariance = pose_.covariance;
    return e;
  }
  [[nodiscard]] LandmarkMap map() const override { return mapper_.map(); }

 private:
  PoseGaussian pose_;
  PathMapper mapper_;
};

/// \param make makes the Follower; its time counts
template <class Make>
LandmarkTrack follow(const LandmarkStream& stream, const LandmarkJudgement& judgement, const Make& make) {
  LandmarkTrack track;
  track.estimates.reserve(stream.scans.size());
  double begin = cpu_seconds();
  const std::unique_ptr<Follower> follower = make();
  auto sample = stream.samples.begin();
  for (std::size_t i = 0; i < stream.scans.size(); ++i) {
    track.estimates.push_back(follower->take(stream.scans[i]));
    if (i != *sample) continue;
    ++sample;
    track.computing += cpu_seconds() - begin;  // to look at the clock at every scan would cost too much
    track.map = follower->map();
    track.landmark_errors.push_back(landmark_rmse(track.map, stream, judgement));
    begin = cpu_seconds();
  }
  return track;
}

LandmarkTrack smooth(const LandmarkStream& stream, const FilterSpec& spec) {
  const double begin = cpu_seconds();
  smoothing::LandmarkSmoother smoother(config::load<smoothing::LandmarkSmootherParameters>(effective_config(spec)),
                                       stream.start);
  for (const LandmarkScan& scan : stream.scans) {
    for (const Odometry& o : scan.odometry) smoother.predict(o);
    smoother.update(scan.informed);
  }
  const smoothing::SmoothedRun run = smoother.solve();
  LandmarkTrack track{{}, run.map, {}, cpu_seconds() - begin};
  for (std::size_t i = 0; i < stream.scans.size(); ++i) {
    SlamEstimate& e = track.estimates.emplace_back();
    e.pose = run.path.poses[i].pose;
    e.covariance = run.path_covariances[i];
  }
  return track;
}

}  // namespace

LandmarkWorld::LandmarkWorld(const ScenarioSpec& spec)
    : parameters_(config::load<LandmarkScenarioParameters>(spec.config)) {
  try {
    scene_ = std::make_shared<const sim::LandmarkScene>(
        sim::LandmarkWorldParameters{parameters_.world, parameters_.vehicle, parameters_.sensor});
  } catch (const InputError& e) {
    throw InputError("scenario '" + spec.name + "': " + e.what());
  }
}

std::vector<std::string> LandmarkWorld::filters() const {
  std::vector<std::string> names = filters::kSlamFilterNames;
  names.insert(names.end(), {kOracle, kDeadReckoning, kKnownPose, kSmoother});
  return names;
}

std::vector<std::string> LandmarkWorld::metrics() const {
  return landmark_metric_names(!parameters_.sensor.known_ids);
}

void LandmarkWorld::check(const FilterSpec& filter) const {
  if (is_slam_filter(filter.name) || filter.name == kOracle) {
    static_cast<void>(slam_filter_parameters(filter));
  } else if (filter.name == kSmoother) {
    static_cast<void>(config::load<smoothing::LandmarkSmootherParameters>(effective_config(filter)));
  } else if (const config::Tree tree = effective_config(filter); tree.kind != config::Tree::Kind::nothing) {
    throw InputError(to_string(tree.place) + ": filter '" + filter.name + "': expected no configuration, got " +
                     config::describe(tree));
  }
}

std::vector<FilterRun> LandmarkWorld::run(std::uint64_t seed, std::span<const FilterSpec> filters) const {
  const LandmarkStream stream = record(scene_, seed, parameters_.series_period);
  std::vector<FilterRun> runs;
  for (const FilterSpec& spec : filters) {
    reset_peak_memory();
    const bool oracle = spec.name == kOracle, slam = is_slam_filter(spec.name) || oracle;
    const bool known_ids = parameters_.sensor.known_ids;
    const LandmarkJudgement judgement{!slam || oracle || known_ids, !known_ids, parameters_.match_within,
                                      parameters_.rpe_length};
    const LandmarkTrack track =
        spec.name == kSmoother ? smooth(stream, spec) : follow(stream, judgement, [&]() -> std::unique_ptr<Follower> {
          if (slam) return std::make_unique<FilterFollower>(spec, seed, stream.start);
          if (spec.name == kKnownPose) return std::make_unique<TruePath>(stream.start);
          return std::make_unique<DeadReckoning>(stream.start);
        });
    runs.push_back(judge(track, stream, judgement));
  }
  return runs;
}

}  // namespace noctule::experiment
