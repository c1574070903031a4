#pragma once
/// Accumulators of the Hough transforms. Votes can be taken back, so an object that has been found leaves no trace.
#include <optional>
#include <vector>

#include "core/parameters.hpp"
#include "mapping/line_fit.hpp"
#include "mapping/sonar_arc.hpp"
#include "mapping/vote_grid.hpp"

namespace noctule::mapping {

/// Resolution of the accumulators. Peaks are refined: bins need only be fine enough to keep objects apart.
struct HoughParameters {
  double theta_bin = radians(1.0);
  double rho_bin = 0.02;
  double centre_bin = 0.04;
  double radius_bin = 0.08;
  double max_radius = 0.48;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("theta_bin_deg", &HoughParameters::theta_bin, unit::degree, "bin of a wall's normal direction",
            between(0.1, 10.0));
    v.field("rho_bin_cm", &HoughParameters::rho_bin, unit::centimetre, "bin of a wall's distance", positive());
    v.field("centre_bin_cm", &HoughParameters::centre_bin, unit::centimetre, "bin of a cylinder's centre", positive());
    v.field("radius_bin_cm", &HoughParameters::radius_bin, unit::centimetre, "bin of a cylinder's radius", positive());
    v.field("max_radius_cm", &HoughParameters::max_radius, unit::centimetre, "largest radius of a cylinder",
            positive());
  }
};

/// The disc that an accumulator covers [m]. Votes outside are lost.
struct Extent {
  Vector2 centre = Vector2::Zero();
  double radius = 0.0;

  /// About the middle of the data; holds all but the farthest 2 % (multiple echoes), with a margin.
  [[nodiscard]] static Extent of(std::span<const SonarArc> arcs);
  [[nodiscard]] static Extent of(std::span<const PointWithCovariance> points);
};

/// Accumulator over (theta, rho), rho signed and measured from the centre of the extent. Arcs vote in [0, 2 pi) with
/// normals that point away from the sensor; points, which have no side, in [0, pi).
class LineVotes {
 public:
  enum class Normals { directed, undirected };
  LineVotes(const HoughParameters& parameters, const Extent& extent, Normals normals);

  /// A return on a wall touches it at p + r n(theta) for some theta in its cone: rho(theta) = n.p + r. It gives each of
  /// the k theta bins of the cone 1/k, spread over rho by its sigma (Tardos, Neira, Newman, Leonard, IJRR 2002).
  void vote(const SonarArc& arc, double weight);
  /// Weight 1 in each theta bin, spread over rho by the variance n' C n.
  void vote(const PointWithCovariance& point, double weight);

  struct Peak {
    Wall wall;  ///< at the middle of the bin, map frame
    double votes = 0.0;
    VoteGrid::Peak cell;
  };
  /// The line with the most votes, more than `threshold`.
  [[nodiscard]] std::optional<Peak> best(double threshold);
  /// Passes over a peak and its neighbourhood from now on, until `allow_all`.
  void refuse(const Peak& peak);
  void allow_all() { grid_.allow_all(); }

 private:
  HoughParameters parameters_;
  Extent extent_;
  bool undirected_;
  std::vector<Vector2> normals_;
  VoteGrid grid_;
};

/// Accumulator over centre and radius; the radii are 0, radius_bin, ... max_radius. The layer of radius 0 holds points.
class CircleVotes {
 public:
  CircleVotes(const HoughParameters& parameters, const Extent& extent);

  /// A return on a convex cylinder of radius R has its centre at p + (r + R) u for some u in the cone: weight 1 in
  /// each layer.
  void vote(const SonarArc& arc, double weight);
  /// A point of the surface has the centre at distance R in any direction.
  void vote(const PointWithCovariance& point, double weight);

  struct Peak {
    Cylinder cylinder;  ///< at the middle of the bin, map frame
    double votes = 0.0;
    VoteGrid::Peak cell;
  };
  [[nodiscard]] std::optional<Peak> best(double threshold);
  void refuse(const Peak& peak);
  void allow_all() { grid_.allow_all(); }

 private:
  /// Votes for the cells at a distance from a point, in `directions_`.
  void vote(int layer, const Vector2& position, double distance, double weight);

  HoughParameters parameters_;
  Vector2 corner_;  // of cell (0, 0)
  int cells_;       // per side
  int layers_;
  std::vector<Eigen::Vector2f> directions_;  // of what is being voted, scratch
  VoteGrid grid_;
};

}  // namespace noctule::mapping
