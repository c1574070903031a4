#pragma once
/// Distances between finite sets of points: how far an estimated set of objects is from the true one, in places and in
/// number. Rows of a distance matrix are estimates, columns are true objects.
#include <Eigen/Core>
#include <span>

#include "core/pose2.hpp"

namespace noctule::eval {

struct SetDistanceParameters {
  double order = 1.0;     ///< p >= 1: larger punishes single large errors more
  double cutoff = 100.0;  ///< c > 0: what a missing or false object costs at most, in the unit of the distances
};

/// Euclidean distances of all pairs.
[[nodiscard]] Eigen::MatrixXd distances(std::span<const Vector2> estimates, std::span<const Vector2> truth);

/// Optimal sub-pattern assignment (Schuhmacher, Vo and Vo 2008): [(sum min(c, d)^p + c^p |m - n|) / max(m, n)]^(1/p)
/// over the best assignment of the smaller set; total^p = localisation^p + cardinality^p. Two empty sets are 0 apart,
/// an empty and another one c.
struct Ospa {
  double total = 0.0;
  double localisation = 0.0;
  double cardinality = 0.0;
};
/// \throws std::invalid_argument for p < 1, c <= 0, or a distance that is NaN or negative (all functions here)
[[nodiscard]] Ospa ospa(const Eigen::MatrixXd& distances, const SetDistanceParameters& = {});
[[nodiscard]] Ospa ospa(std::span<const Vector2> estimates, std::span<const Vector2> truth,
                        const SetDistanceParameters& = {});

/// Generalised OSPA with alpha = 2 (Rahmathullah, Garcia-Fernandez and Svensson 2017): not divided by the number of
/// objects, pairs farther apart than c are a missed and a false object; total^p = localisation^p + missed^p + false^p
/// with localisation = (sum of d^p over pairs)^(1/p), missed = (c^p / 2 * number missed)^(1/p), likewise false.
struct Gospa {
  double total = 0.0;
  double localisation = 0.0;
  double missed = 0.0;
  double false_alarms = 0.0;
  int assigned_count = 0;
  int missed_count = 0;
  int false_count = 0;
};
[[nodiscard]] Gospa gospa(const Eigen::MatrixXd& distances, const SetDistanceParameters& = {});
[[nodiscard]] Gospa gospa(std::span<const Vector2> estimates, std::span<const Vector2> truth,
                          const SetDistanceParameters& = {});

/// Cardinalised optimal linear assignment (Barrios, Naqvi, Adams, Leung and Inostroza 2015):
/// [sum min(1, d / c)^p + |m - n|]^(1/p), in objects: grows with the size of the map where OSPA averages.
[[nodiscard]] double cola(const Eigen::MatrixXd& distances, const SetDistanceParameters& = {});
[[nodiscard]] double cola(std::span<const Vector2> estimates, std::span<const Vector2> truth,
                          const SetDistanceParameters& = {});

}  // namespace noctule::eval
