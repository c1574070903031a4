#pragma once
/// Joint compatibility branch and bound (Neira, Tardos: Data association in stochastic mapping using the joint
/// compatibility test, T-RA 2001).
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace noctule::filters {

/// A sighting and a landmark that may have made it.
struct Pairing {
  std::size_t sighting;
  std::size_t landmark;
  int numbers = 2;  ///< that the sighting measures, 1 or 2; the other one has innovation 0 and variance 1
};

/// The largest set of pairings that are compatible together: each sighting and each landmark at most once, the squared
/// Mahalanobis length of all innovations together below the chi-square quantile of their number. Of equally large sets,
/// the one of least length.
/// \param pairings in the order of their sightings
/// \param innovations two numbers a pairing
/// \param covariance of all of them, positive definite over any allowed set
/// \param most_steps of the search: beyond, the best set so far is returned
/// \return indices of pairings, increasing
[[nodiscard]] std::vector<std::size_t> jointly_compatible(std::span<const Pairing> pairings,
                                                          const Eigen::VectorXd& innovations,
                                                          const Eigen::MatrixXd& covariance, double probability,
                                                          std::size_t most_steps = 100000);

}  // namespace noctule::filters
