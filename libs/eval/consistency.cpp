#include "eval/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/limits.hpp"

namespace noctule::eval {
namespace {

/// Sum of chi-square values.
struct Sum {
  double value = 0.0;
  double dof = 0.0;
  [[nodiscard]] double mean() const { return dof > 0.0 ? value / dof : kNan; }
};

}  // namespace

std::vector<NormalisedSquare> landmark_nees(const LandmarkMap& map, std::span<const KnownLandmark> known) {
  std::vector<NormalisedSquare> values;
  for (const KnownLandmark& k : known) {
    const auto l = std::ranges::find_if(
        map.landmarks, [&](const LandmarkEstimate& e) { return e.id == k.id && e.kind == LandmarkKind::point; });
    if (l == map.landmarks.end()) continue;
    values.push_back(normalised_square<2>(l->parameters.head<2>() - k.position, l->covariance.topLeftCorner<2, 2>()));
  }
  return values;
}

Consistency consistency(std::span<const std::vector<NormalisedSquare>> runs, double probability) {
  if (!(probability > 0.0 && probability < 1.0)) {
    throw std::invalid_argument("consistency: probability must be in (0, 1)");
  }
  std::size_t length = 0;
  for (const auto& run : runs) length = std::max(length, run.size());

  Consistency result;
  Sum all;
  int judged = 0, above = 0, below = 0;
  for (std::size_t k = 0; k < length; ++k) {
    ConsistencyStep step;
    Sum sum;
    for (const auto& run : runs) {
      if (k >= run.size() || run[k].dof == 0) continue;
      if (!std::isfinite(run[k].value)) {
        ++step.failed;
        continue;
      }
      ++step.runs;
      sum.value += run[k].value;
      sum.dof += run[k].dof;
    }
    step.mean = sum.mean();
    if (step.runs > 0) {
      const double tail = 0.5 * (1.0 - probability);
      step.bounds = {chi2_quantile(tail, sum.dof) / sum.dof, chi2_quantile(1.0 - tail, sum.dof) / sum.dof};
      step.inside = step.failed == 0 && step.mean >= step.bounds.low && step.mean <= step.bounds.high;
      above += step.mean > step.bounds.high ? 1 : 0;
      below += step.mean < step.bounds.low ? 1 : 0;
    }
    judged += step.runs + step.failed > 0 ? 1 : 0;
    result.failed += step.failed;
    all.value += sum.value;
    all.dof += sum.dof;
    result.steps.push_back(step);
  }
  const auto inside = std::ranges::count(result.steps, true, &ConsistencyStep::inside);
  const auto share = [&](auto count) { return judged > 0 ? static_cast<double>(count) / judged : kNan; };
  result.mean = all.mean();
  result.share_inside = share(inside);
  result.share_above = share(above);
  result.share_below = share(below);
  return result;
}

}  // namespace noctule::eval
