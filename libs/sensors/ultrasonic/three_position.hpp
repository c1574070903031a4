#pragma once
/// Wall, cylinder or point? The three-position method with any number of positions, decided late.
#include <optional>
#include <span>

#include "sensors/ultrasonic/surface_fit.hpp"

namespace noctule::sensors {

struct DecisionParameters {
  double certainty = 0.99;       ///< posterior probability that decides a type
  double rejection = 1e-4;       ///< a surface is out when its chi2 is less probable than this
  double point_radius = 0.04;    ///< cylinders below this radius are called points [m]
  double largest_radius = 0.60;  ///< of a cylinder [m]
  RadiusPrior radius;
  OutlierModel outliers;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("certainty", &DecisionParameters::certainty, unit::one, "posterior probability that decides a type",
            between(0.5, 1.0));
    v.field("rejection", &DecisionParameters::rejection, unit::one,
            "a surface is out when its chi2 is less probable than this", between(1e-9, 0.1));
    v.field("point_radius_cm", &DecisionParameters::point_radius, unit::centimetre,
            "cylinders below this radius are called points", positive());
    v.field("largest_radius_cm", &DecisionParameters::largest_radius, unit::centimetre, "largest radius of a cylinder",
            positive());
    v.group("radius", &DecisionParameters::radius, "radius of a cylinder before anything is heard");
    v.group("outliers", &DecisionParameters::outliers, "ranges off the noise model");
  }
};

/// Fits of every kind of surface to the same sightings; nothing where a fit does not exist.
struct SurfaceFits {
  std::optional<WallFit> wall;
  std::optional<PointFit> point;
  std::optional<CylinderFit> cylinder;  ///< with the radius prior
};

/// Posterior of the kind of surface, equal priors, and what follows from it.
struct Decision {
  ContourType type = ContourType::ambiguous;
  double wall = 1.0 / 3.0;      ///< probability of a wall
  double point = 1.0 / 3.0;     ///< of a point of radius 0
  double cylinder = 1.0 / 3.0;  ///< of a cylinder of any radius
  double small = 0.5;           ///< of radius below point_radius, given that it is no wall
  bool explained = true;        ///< false: no surface fits; the sightings do not belong together
};

/// First, last and the sighting nearest to the middle between them: the widest triple. Fewer when there are fewer.
struct Triple {
  std::array<Sighting, 3> sightings;
  std::size_t count = 0;
  [[nodiscard]] std::span<const Sighting> span() const { return {sightings.data(), count}; }
};
[[nodiscard]] Triple widest_triple(std::span<const Sighting> sightings);

/// Which surfaces to fit.
struct Kinds {
  bool wall = true;
  bool point = true;
  bool cylinder = true;
};

/// Fits surfaces to 1 to kMaxSightings sightings, oldest first. Each fit starts from `previous` where given, else from
/// the closed form on the widest triple or from the latest direction, whichever fits better.
[[nodiscard]] SurfaceFits fit_surfaces(std::span<const Sighting> sightings, const DecisionParameters& parameters,
                                       const SurfaceFits& previous = {}, const Kinds& kinds = {});

/// Whether residuals as long as those of the fit or longer have less than the given probability (at most 0.3).
template <int D>
[[nodiscard]] bool improbable(const SurfaceFit<D>& fit, double probability);

/// Posterior from the evidences of the fits.
/// A type is decided from three positions on and when its probability reaches `certainty`. A surface that is certainly
/// curved while its radius is open (point or arc) stays ambiguous, with a wall probability below 1 - certainty.
[[nodiscard]] Decision decide(const SurfaceFits& fits, int positions, const DecisionParameters& parameters);

}  // namespace noctule::sensors
