#pragma once

namespace noctule::filters {

/// What an observation says about a particle.
struct ObservationFit {
  double log_likelihood = 0.0;
  double nis = 0.0;            ///< sum of the squared normalised innovations ...
  int degrees_of_freedom = 0;  ///< ... and how many numbers they came from
};

}  // namespace noctule::filters
