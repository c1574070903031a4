#pragma once
/// The most likely path and map behind a filter's own: Gauss-Newton over all poses, walls, cylinders and points at
/// once, starting from the best particle. A filter's path is one sample of the posterior, which more particles do not
/// mend; this is its peak.
#include <span>
#include <vector>

#include "core/estimate.hpp"
#include "core/gaussian.hpp"
#include "core/observations.hpp"
#include "filters/slam/parameters.hpp"
#include "models/noise_mixture.hpp"

namespace noctule::filters {

struct SmoothedPath {
  std::vector<Pose2> poses;
  std::vector<Matrix3> covariances;  ///< marginal, of each pose, order (x, y, yaw)
  LandmarkMap map;                   ///< those of the filter that are decided, with marginal covariances
  int iterations = 0;
  bool converged = false;
};

/// Remembers what a filter was fed, one node per observation. An echo belongs to the landmark that explains it best at
/// the present solution, or to clutter: associations are those of the filter's map at first, and may change on the way.
class PathSmoother {
 public:
  PathSmoother(const PathSmootherParameters& smoother, const EchoParameters& echo, double point_radius_sd,
               const Pose2& start);

  /// The next node, after this motion (from the start or the previous node).
  void add_node(const PoseGaussian& motion);
  /// Echoes heard at the latest node. \param noise of their ranges, in units of the nominal sd
  void add(const UltrasonicScan& scan, const models::NoiseMixture<1>& noise);

  /// \param path of the filter, a pose per node \param map of the filter; landmarks of undecided type are left out
  [[nodiscard]] SmoothedPath smooth(std::span<const Pose2> path, const LandmarkMap& map) const;

  void transfer(StateArchive& archive);

 private:
  friend class SmoothingProblem;
  struct SensedEcho {
    Vector2 sensor = Vector2::Zero();  ///< in base_link
    Vector2 axis = Vector2::UnitX();   ///< unit vector in base_link
    double range = 0.0, sd = 0.0;
  };
  struct Node {
    Pose2 increment;
    Matrix3 information = Matrix3::Zero();  ///< of the increment
    std::size_t echoes_end = 0;
    std::size_t noise = 0;  ///< index into noises_
    double bearing_sd = 0.0;
  };

  PathSmootherParameters parameters_;
  EchoParameters echo_;
  double point_radius_sd_;
  Pose2 start_;
  std::vector<Node> nodes_;
  std::vector<SensedEcho> echoes_;  ///< in the order of their nodes
  std::vector<models::NoiseMixture<1>> noises_;
};

}  // namespace noctule::filters
