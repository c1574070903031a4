#pragma once
/// Parameters of the filters over point landmarks.
#include <optional>

#include "core/angles.hpp"
#include "core/parameters.hpp"
#include "core/unscented.hpp"
#include "filters/slam/landmark_life.hpp"
#include "filters/slam/landmark_maps.hpp"
#include "filters/slam/parameters.hpp"

namespace noctule::filters {

/// What does best among landmarks: one component without bias, and a memory of 27 sightings.
struct SightingVbNoiseParameters : VbNoiseParameters {
  SightingVbNoiseParameters() {
    learning.components = 1;
    learning.memory = 27.0;
    beta = 1e5;
  }
};
using SightingNoiseParameters = std::variant<FixedNoiseParameters, EmNoiseParameters, SightingVbNoiseParameters>;

/// What happens to particles that a resampling drops.
enum class Optimisation : std::int8_t {
  none,  ///< they are gone
  apf    ///< some move toward a good neighbour and take the place of a copy of it (particle::Apf)
};

enum class ReportedMap : std::int8_t { best, mean };

/// What all particle filters over point landmarks share.
struct LandmarkSlamParameters {
  int particles = 100;
  particle::Resampling resampling = particle::Resampling::systematic;
  double resample_below = 0.75;
  Optimisation optimise = Optimisation::none;
  double weight_power = 1.0;
  SightingNoiseParameters noise;  ///< of sightings, in units of the covariance that each states
  SightingParameters sightings;
  std::optional<LandmarkLifeParameters> life;
  MapStorage storage = MapStorage::automatic;
  ReportedMap map = ReportedMap::best;
  /// Most threads to use; no result depends on it. Not listed below: it belongs to the machine, not to the filter.
  int threads = 1;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LandmarkSlamParameters;
    describe_particles<P>(v);
    v.choice("optimise", &P::optimise, Choices<Optimisation>{{"none", Optimisation::none}, {"apf", Optimisation::apf}},
             "whether dropped particles move toward good neighbours (apf)");
    v.field("weight_power", &P::weight_power, unit::one,
            "power of the likelihood that multiplies the weights; below 1: particles live longer than Bayes says",
            Range{.min = 0.0, .max = 1.0, .min_allowed = false});
    v.one_of("noise", &P::noise, {"fixed", "em", "vb"}, "noise of sightings: as each states it, or learned on the way");
    v.group("sightings", &P::sightings, "sightings of landmarks of unknown identity");
    v.group("life", &P::life, "birth and death of such landmarks by what should be seen; absent: they live for ever");
    v.choice("map_storage", &P::storage,
             Choices<MapStorage>{
                 {"automatic", MapStorage::automatic}, {"flat", MapStorage::flat}, {"shared", MapStorage::shared}},
             "how maps lie in memory; no result depends on it");
    v.choice("map", &P::map, Choices<ReportedMap>{{"best", ReportedMap::best}, {"mean", ReportedMap::mean}},
             "the map reported: that of the heaviest particle, or the weighted mean");
  }
};

enum class Sampling : std::int8_t { scan, odometry };

/// FastSLAM 1 (Montemerlo, Thrun, Koller, Wegbreit, AAAI 2002): the motion prior is the proposal.
struct FastSlam1Parameters : LandmarkSlamParameters {
  Sampling sample = Sampling::scan;

  template <class Visitor>
  static void describe(Visitor& v) {
    LandmarkSlamParameters::describe(v);
    v.choice("sample", &FastSlam1Parameters::sample,
             Choices<Sampling>{{"scan", Sampling::scan}, {"odometry", Sampling::odometry}},
             "particles are moved once a scan, or with every odometry message");
  }
};

/// FastSLAM 2 (Montemerlo, Thrun, Koller, Wegbreit, IJCAI 2003): the proposal is the motion prior updated by the scan,
/// linearised.
struct FastSlam2Parameters : LandmarkSlamParameters {
  /// Motion without sightings is drawn at the latest when the sd of its heading exceeds this [rad].
  double linear_within = radians(6.0);

  template <class Visitor>
  static void describe(Visitor& v) {
    LandmarkSlamParameters::describe(v);
    v.field("linear_within_deg", &FastSlam2Parameters::linear_within, unit::degree,
            "motion without sightings is drawn when the sd of its heading exceeds this", positive());
  }
};

enum class UnscentedVariant : std::int8_t { erb, y2008 };

/// UFastSLAM (Kim, Sakthivel, Chung, T-RO 2008): the proposal and the landmarks by unscented transforms.
struct UFastSlamParameters : FastSlam2Parameters {
  UnscentedVariant variant = UnscentedVariant::erb;
  UnscentedScaling scaling;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = UFastSlamParameters;
    FastSlam2Parameters::describe(v);
    v.choice("variant", &P::variant,
             Choices<UnscentedVariant>{{"erb", UnscentedVariant::erb}, {"2008", UnscentedVariant::y2008}},
             "whether the proposal knows that landmarks are uncertain (erb) or not (2008)");
    v.group("scaling", &P::scaling, "of the unscented transforms");
  }
};

/// How particles look for better poses after the resampling.
struct SwarmParameters {
  int iterations = 5;
  double own = 1.5;     ///< pull of a particle's own best pose
  double common = 0.5;  ///< pull of the best pose of all
  double inertia_first = 0.7, inertia_last = 0.4;
  double target_gate = 0.95;  ///< the best pose pulls only when the scan's NIS there is below this chi-square quantile

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SwarmParameters;
    v.field("iterations", &P::iterations, unit::one, "moves a scan", Range{.min = 1, .max = 100});
    v.field("own", &P::own, unit::one, "pull of a particle's own best pose", at_least(0.0));
    v.field("common", &P::common, unit::one, "pull of the best pose of all", at_least(0.0));
    v.field("inertia_first", &P::inertia_first, unit::one, "share of the velocity kept at the first move",
            between(0.0, 1.0));
    v.field("inertia_last", &P::inertia_last, unit::one, "and at the last", between(0.0, 1.0));
    v.field("target_gate", &P::target_gate, unit::one,
            "the best pose pulls when the NIS of the scan there is below this quantile of chi-square",
            Range{.min = 0.0, .max = 1.0, .min_allowed = false, .max_allowed = false});
  }
};

enum class SwarmMoves : std::int8_t { resampled, always };
enum class SwarmWeighting : std::int8_t {
  equal,      ///< weights stay as the resampling left them
  density,    ///< by the posterior density found, which counts the scan's likelihood twice after a resampling
  importance  ///< drawn about the pose found, with the weight of importance sampling: unbiased
};

/// UFastSLAM whose particles are moved by a swarm after the resampling (PSO-UFastSLAM).
struct PsoUFastSlamParameters : UFastSlamParameters {
  SwarmMoves when = SwarmMoves::resampled;
  SwarmWeighting weighting = SwarmWeighting::equal;
  SwarmParameters swarm;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = PsoUFastSlamParameters;
    UFastSlamParameters::describe(v);
    v.choice("when", &P::when,
             Choices<SwarmMoves>{{"resampled", SwarmMoves::resampled}, {"always", SwarmMoves::always}},
             "particles move after a resampling, or at every scan");
    v.choice("weighting", &P::weighting,
             Choices<SwarmWeighting>{{"equal", SwarmWeighting::equal},
                                     {"density", SwarmWeighting::density},
                                     {"importance", SwarmWeighting::importance}},
             "how they are weighed then");
    v.group("swarm", &P::swarm, "how they move");
  }
};

enum class WocpfBase : std::int8_t { fastslam1, fastslam2, ufastslam };

/// Weight-optimised combined particle filter (Wang, Wang 2022, eq. 7): a FastSLAM whose offspring are drawn with
/// the weights psi_i = (1 - 1/K) w_i + 1/(K N). The weights themselves are w_i.
struct WocpfParameters : UFastSlamParameters {
  WocpfBase base = WocpfBase::fastslam2;
  OffspringTempering offspring{.k = 10.0};

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = WocpfParameters;
    UFastSlamParameters::describe(v);
    v.choice("base", &P::base,
             Choices<WocpfBase>{{"fastslam1", WocpfBase::fastslam1},
                                {"fastslam2", WocpfBase::fastslam2},
                                {"ufastslam", WocpfBase::ufastslam}},
             "the filter whose offspring are drawn so");
    v.group("offspring", &P::offspring, "how they are drawn");
  }
};

struct EkfSlamParameters {
  SightingParameters sightings;
  std::optional<LandmarkLifeParameters> life;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("sightings", &EkfSlamParameters::sightings, "sightings of landmarks of unknown identity");
    v.group("life", &EkfSlamParameters::life,
            "birth and death of such landmarks by what should be seen; absent: they live for ever");
  }
};

}  // namespace noctule::filters
