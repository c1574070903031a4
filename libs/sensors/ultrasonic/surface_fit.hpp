#pragma once
/// Maximum-likelihood fits of wall, point and cylinder to sightings from stops that odometry connects.
#include <optional>
#include <span>

#include "core/gaussian.hpp"
#include "core/parameters.hpp"
#include "sensors/ultrasonic/geometry.hpp"

namespace noctule::sensors {

/// What is believed of a radius before anything is heard: Gaussian.
struct RadiusPrior {
  double mean = 0.08;  ///< [m]
  double sd = 0.08;    ///< [m]

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("mean_cm", &RadiusPrior::mean, unit::centimetre, "mean radius of a cylinder", at_least(0.0));
    v.field("sd_cm", &RadiusPrior::sd, unit::centimetre, "its standard deviation", positive());
  }
};

/// Sightings whose range is wrong by more than the noise explains: with `probability` the sd is `factor` times larger.
/// The fit takes for each sighting the explanation that is the more likely one, at the price of its probability.
struct OutlierModel {
  double probability = 0.05;
  double factor = 5.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("probability", &OutlierModel::probability, unit::one, "share of regions with a range off the noise model",
            between(0.0, 0.5));
    v.field("factor", &OutlierModel::factor, unit::one, "their noise in units of the noise model", at_least(1.0));
  }
};

template <int D>
struct SurfaceFit {
  VectorD<D> parameters = VectorD<D>::Zero();
  MatrixD<D> covariance = MatrixD<D>::Zero();
  double chi2 = 0.0;            ///< of all residuals, the radius prior's included
  int dof = 0;                  ///< residuals less parameters
  int outliers = 0;             ///< sightings taken as outliers
  double log_likelihood = 0.0;  ///< log density of all ranges and directions (and the radius prior) at the maximum
  /// log p(later sightings | the first): Laplace's approximation of the marginal likelihood under flat priors for
  /// where the surface is, relative to a single sighting. 0 for one sighting, whatever the surface, so that surfaces
  /// of different kinds are compared fairly (Kass and Raftery 1995).
  double log_evidence = 0.0;
};
using WallFit = SurfaceFit<2>;      ///< parameters (rho, theta)
using PointFit = SurfaceFit<2>;     ///< parameters (x, y)
using CylinderFit = SurfaceFit<3>;  ///< parameters (x, y, radius)

/// Gauss-Newton on the ranges and directions with their full covariance: hearing noise on the diagonal, and what
/// odometry adds, correlated between the stops (see Sighting::drift).
/// \param sightings 1 to kMaxSightings, oldest first. A wall or point needs two numbers, that is one sighting with
///   direction or two without; a cylinder needs the prior or one more.
/// \param outliers nothing: all sightings are taken as they are
/// \return nothing when the numbers do not determine the surface, when the iteration does not converge, or when the
///   surface is hopeless (chi2 above 12 per number: more than outliers can explain)
[[nodiscard]] std::optional<WallFit> fit_wall(std::span<const Sighting> sightings, const Wall& start,
                                              const std::optional<OutlierModel>& outliers = {});
[[nodiscard]] std::optional<PointFit> fit_point(std::span<const Sighting> sightings, const Vector2& start,
                                                const std::optional<OutlierModel>& outliers = {});
[[nodiscard]] std::optional<CylinderFit> fit_cylinder(std::span<const Sighting> sightings, const Cylinder& start,
                                                      const std::optional<RadiusPrior>& prior = {},
                                                      const std::optional<OutlierModel>& outliers = {});

}  // namespace noctule::sensors
