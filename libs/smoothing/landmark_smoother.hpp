#pragma once
/// The limit that no filter can beat: batch maximum likelihood over all poses and all point landmarks at once, with
/// known association.
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/estimate.hpp"
#include "core/observations.hpp"
#include "core/parameters.hpp"

namespace noctule::smoothing {

/// What a sighting costs by its Mahalanobis length s.
enum class Loss {
  quadratic,  ///< s^2: maximum likelihood under Gaussian noise
  huber,      ///< linear beyond `loss_scale`
  cauchy      ///< logarithmic beyond `loss_scale`
};

struct LandmarkSmootherParameters {
  /// Odometry made from two controls has a covariance of rank 2, and a robot at rest none at all: such motions have no
  /// density. Every motion between two scans is therefore taken to err by these standard deviations as well,
  /// independently (their squares are added to the diagonal of its covariance).
  double position_floor = 1e-4;  ///< [m]
  double heading_floor = 1e-5;   ///< [rad]
  Loss loss = Loss::quadratic;
  double loss_scale = 3.0;  ///< Mahalanobis length, for huber and cauchy
  /// So many scans are added before all up to there are solved again: dead reckoning is followed no further than this
  /// without a look at the landmarks.
  int batch = 50;
  int max_iterations = 200;
  double tolerance = 1e-12;  ///< converged when a step lowers the cost by less than this part of it

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LandmarkSmootherParameters;
    v.field("position_floor_m", &P::position_floor, unit::metre,
            "sd added to each motion between scans, so that a singular covariance has a density", positive());
    v.field("heading_floor_deg", &P::heading_floor, unit::degree, "the same of the heading", positive());
    v.choice("loss", &P::loss, {{"quadratic", Loss::quadratic}, {"huber", Loss::huber}, {"cauchy", Loss::cauchy}},
             "what a sighting costs by its Mahalanobis length");
    v.field("loss_scale", &P::loss_scale, unit::one, "length from which huber and cauchy forgive", positive());
    v.field("batch", &P::batch, unit::one, "scans added between two solutions on the way to the whole", at_least(1));
    v.field("max_iterations", &P::max_iterations, unit::one, "of the last solution", at_least(1));
    v.field("tolerance", &P::tolerance, unit::one, "least relative decrease of the cost in an iteration", positive());
  }
};

/// The most likely path and map, and how sure they are.
struct SmoothedRun {
  PathEstimate path = {};                      ///< one pose per update(), in their order
  std::vector<Matrix3> path_covariances = {};  ///< marginal, of each pose of `path`, order (x, y, yaw)
  LandmarkMap map = {};                        ///< points by ascending id, with marginal covariances
  double chi2 = 0.0;       ///< sum of all squared whitened residuals; chi-square with `dof` when the noise is as stated
  int dof = 0;             ///< equations - unknowns
  int iterations = 0;      ///< of all solutions on the way
  bool converged = false;  ///< nothing to solve counts as converged
};

/// Eats the stream that a filter eats, then solves for everything at once. The pose before the first observation is
/// known. Increments between two updates are composed to one motion with first-order covariance; their likelihood is
/// Gaussian in (x, y, yaw) of the motion, that of a sighting in (range, bearing). Deterministic, single-threaded.
/// Covariances are those of the linearised problem at the solution (inverse of J'J; with a robust loss, of the
/// reweighted one), NaN where that problem is singular. A chi2 far above dof says that the noise is not as stated, or
/// that the solution is a false minimum.
class LandmarkSmoother {
 public:
  /// \throws InputError for parameters out of range or a start that is not finite
  explicit LandmarkSmoother(const LandmarkSmootherParameters& = {}, const Pose2& start = {});

  /// \throws InputError as core/observation_checks.hpp says (both)
  void predict(const Odometry&);
  /// Every call yields a pose of the path, with or without detections. A landmark is what carries its id.
  /// \throws InputError also for a detection without an id
  void update(const LandmarkDetections&);

  /// Solves for all that came so far; may be called again after more.
  [[nodiscard]] SmoothedRun solve() const;

 private:
  friend class LandmarkProblem;
  /// From node i to node i + 1.
  struct Motion {
    Pose2 increment;
    Matrix3 root_information;  ///< W, lower triangular, W'W = inverse covariance
  };
  struct Sighting {
    std::size_t node;
    std::size_t landmark;
    Pose2 sensor_in_base;
    Vector2 z;  ///< (range, bearing)
    Matrix2 root_information;
  };
  struct Scan {
    Stamp stamp;
    std::size_t node;
  };

  LandmarkSmootherParameters parameters_;
  Pose2 start_;                          ///< node 0
  std::optional<PoseGaussian> pending_;  ///< motion since the last node
  std::vector<Motion> motions_;
  std::vector<Sighting> sightings_;  ///< by ascending node
  std::vector<Scan> scans_;
  std::map<std::int64_t, std::size_t> landmark_of_id_;
};

}  // namespace noctule::smoothing
