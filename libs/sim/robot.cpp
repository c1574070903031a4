#include "sim/robot.hpp"

#include <cmath>
#include <sstream>

namespace noctule::sim {

std::string SonarParameters::validate() const {
  std::ostringstream problem;
  if (mounting == Mounting::fixed && mounts.empty()) {
    problem << "mounts: expected at least 1 for fixed rangers, got none";
  } else if (mounting == Mounting::stepper && firing == Firing::parallel) {
    problem << "firing: expected one_by_one for a single turning ranger, got parallel";
  } else if (min_range >= max_range) {
    problem << "min_range_cm: expected less than max_range_cm = " << 100.0 * max_range << ", got " << 100.0 * min_range;
  } else if (const std::string order = models::check_order(schedule); !order.empty()) {
    problem << "schedule: " << order;
  } else if (!mixture.empty()) {
    double sum = 0.0;
    for (const NoiseComponent& c : mixture) sum += c.weight;
    if (std::abs(sum - 1.0) > 1e-9) problem << "mixture: expected weights that sum to 1, got " << sum;
  }
  return problem.str();
}

std::vector<Pose2> SonarParameters::beams() const {
  std::vector<Pose2> beams;
  if (mounting == Mounting::stepper) {
    for (int i = 0; i < stepper.pings; ++i) beams.push_back(stepper.mount * Pose2{0.0, 0.0, i * stepper.step});
  } else {
    for (const MountParameters& m : mounts) beams.push_back(m.pose);
  }
  return beams;
}

double SonarParameters::scan_duration() const {
  if (mounting == Mounting::stepper) return stepper.pings * ping_period;
  return firing == Firing::parallel ? ping_period : static_cast<double>(mounts.size()) * ping_period;
}

}  // namespace noctule::sim
