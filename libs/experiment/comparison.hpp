#pragma once
/// Paired differences of two filters that shared their random numbers, with the statistics of claiming them.
#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "eval/statistics.hpp"
#include "experiment/table.hpp"

namespace noctule::experiment {

/// One metric of one filter against another, seed by seed. A seed at which either has no number is no pair and is
/// counted; diverged runs that have a number are among the pairs.
struct Comparison {
  Subject subject;
  Subject against;
  std::string metric;
  std::string unit;
  int pairs = 0;
  int dropped = 0;  ///< seeds of both without a pair
  int diverged = 0;
  int against_diverged = 0;
  double mean = 0.0;  ///< of the pairs, as all that follows; NaN without pairs
  double against_mean = 0.0;
  double difference = 0.0;         ///< mean of subject - against
  Interval ci95{0.0, 0.0};         ///< of the difference, Student's t
  Interval bootstrap95{0.0, 0.0};  ///< the same, percentile bootstrap
  double percent = 0.0;            ///< difference in per cent of the mean of `against`
  double p_value = 1.0;            ///< of "no difference", paired t test, two-sided
  double p_permutation = 1.0;      ///< the same without assuming a normal distribution (sign_flip_p_value)
  double p_holm = 1.0;             ///< p_value corrected for all comparisons shown at once (set by correct())
};

/// \param a,b the rows of one metric each
[[nodiscard]] Comparison compare(std::span<const Row> a, std::span<const Row> b);

/// Sets p_holm, the whole list being what is shown at once; comparisons without a p-value do not count.
void correct(std::span<Comparison>);

/// "< 0.001", else three decimals; `none` where there is none.
[[nodiscard]] std::string p_value_text(double p, const std::string& none);

/// P-values corrected for their number by Holm's step-down method (1979), which bounds the chance of any false claim
/// whatever the dependence. NaN stays NaN and does not count.
[[nodiscard]] std::vector<double> holm(std::span<const double> p_values);

/// Two-sided p-value of "the differences are symmetric about zero" by flipping signs: exact up to 12 differences, with
/// 9999 random flips beyond (Phipson and Smyth 2010: the observed one counts as a flip). NaN for no differences.
/// \throws std::invalid_argument for a difference that is not finite
[[nodiscard]] double sign_flip_p_value(std::span<const double> differences, std::uint64_t seed = 1);

/// `scenario,metric,unit,filter,parameters,against,against_parameters,pairs,dropped,diverged,against_diverged,mean,`
/// `against_mean,difference,ci95_low,ci95_high,bootstrap95_low,bootstrap95_high,percent,p,p_permutation,p_holm`
void write_comparisons(std::ostream&, std::span<const Comparison>);
/// \throws InputError naming file and line
[[nodiscard]] std::vector<Comparison> read_comparisons(const std::filesystem::path&);

}  // namespace noctule::experiment
