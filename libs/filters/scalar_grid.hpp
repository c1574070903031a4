#pragma once
/// A point-mass filter: the exact posterior of a scalar state, as fine as its grid. What no filter can beat in the
/// mean.
#include <span>
#include <vector>

namespace noctule::filters {

/// A probability distribution on evenly spaced points.
class ScalarGrid {
 public:
  /// \throws std::invalid_argument unless low < high and there are at least two points
  ScalarGrid(double low, double high, std::size_t points);

  [[nodiscard]] std::span<const double> points() const { return points_; }
  [[nodiscard]] std::span<const double> masses() const { return masses_; }
  [[nodiscard]] double mean() const;

  void set_normal(double mean, double sd);
  /// What lies at point i goes to images[i] (at the ends: what is outside), spread by normal noise.
  /// \param sd at least one spacing
  void predict(std::span<const double> images, double sd);
  /// Bayes' rule. Nothing happens when no point has a positive likelihood.
  void update(std::span<const double> log_likelihoods);

 private:
  void normalise();
  double spacing_;
  std::vector<double> points_, masses_, moved_, kernel_;
};

}  // namespace noctule::filters
