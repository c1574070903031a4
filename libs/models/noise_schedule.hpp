#pragma once
/// Observation noise that changes in the course of a run.
#include <span>
#include <string>

#include "core/parameters.hpp"

namespace noctule::models {

/// From `start` on, a fraction of the run's duration, the standard deviation is `factor` times the nominal one.
struct NoiseStage {
  double start = 0.0;
  double factor = 1.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("start", &NoiseStage::start, unit::one, "fraction of the run's duration at which the stage begins",
            between(0.0, 1.0));
    v.field("factor", &NoiseStage::factor, unit::one, "standard deviation in units of the nominal one", positive());
  }
};

/// Factor in force after `fraction` of the run: that of the last stage begun; 1 before the first stage.
/// \param stages in order of their start
[[nodiscard]] inline double noise_factor(std::span<const NoiseStage> stages, double fraction) {
  double factor = 1.0;
  for (const NoiseStage& stage : stages) {
    if (stage.start > fraction) break;
    factor = stage.factor;
  }
  return factor;
}

/// Empty when the stages follow each other in time, else what is wrong.
[[nodiscard]] inline std::string check_order(std::span<const NoiseStage> stages) {
  for (std::size_t i = 1; i < stages.size(); ++i) {
    if (stages[i].start <= stages[i - 1].start) {
      return "stage " + std::to_string(i + 1) + " of the noise schedule: expected to start after stage " +
             std::to_string(i) + ", got " + std::to_string(stages[i].start) + " after " +
             std::to_string(stages[i - 1].start);
    }
  }
  return {};
}

}  // namespace noctule::models
