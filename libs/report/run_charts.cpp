#include "report/run_charts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/chi2.hpp"
#include "core/limits.hpp"
#include "report/pose_series.hpp"
#include "report/text.hpp"

namespace noctule::report {
namespace {

/// Seconds since the first estimate.
std::vector<double> times(const RunData& data) {
  std::vector<double> t;
  t.reserve(data.estimates.size());
  for (const SlamEstimate& e : data.estimates) t.push_back(seconds(e.stamp.utime - data.estimates.front().stamp.utime));
  return t;
}

std::vector<double> series(const RunData& data, const std::function<double(const SlamEstimate&)>& value) {
  std::vector<double> v;
  v.reserve(data.estimates.size());
  for (const SlamEstimate& e : data.estimates) v.push_back(value(e));
  return v;
}

bool varies(const std::vector<double>& values) {
  return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) != values.end();
}

/// Estimate - truth, one component (0 x, 1 y, 2 yaw) an estimate.
std::vector<double> component_error(const RunData& data, int component, double scale) {
  return series(data, [&](const SlamEstimate& e) {
    const auto truth = eval::interpolate(data.truth, e.stamp.utime);
    return truth ? scale * difference(e.pose, *truth)[component] : kNan;
  });
}

std::vector<double> distance_to_truth(const RunData& data, const std::vector<eval::TimedPose>& trajectory,
                                      double scale) {
  return series(data, [&](const SlamEstimate& e) {
    const auto pose = eval::interpolate(trajectory, e.stamp.utime);
    const auto truth = eval::interpolate(data.truth, e.stamp.utime);
    return pose && truth ? scale * (pose->position() - truth->position()).norm() : kNan;
  });
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = std::isfinite(v) ? std::max(most, std::abs(v)) : most;
  return most;
}

Chart component_chart(const RunData& data, int component, const std::string& name) {
  const PrintUnit unit =
      component == 2 ? print_unit("rad") : print_unit("m", largest(component_error(data, component, 1.0)));
  Chart chart;
  chart.id = "error-" + std::to_string(component);
  chart.title = "Error in " + name;
  chart.unit = component == 2 ? "deg" : unit.symbol;
  chart.description = "Error of the estimated " + name + " over time within its three standard deviations.";
  chart.time = times(data);
  chart.series = {{"error", "estimate", component_error(data, component, unit.scale)}};
  chart.band = series(data, [&](const SlamEstimate& e) {
    return 3.0 * unit.scale * std::sqrt(std::max(0.0, e.covariance(component, component)));
  });
  chart.band_name =
      "\xC2\xB1"
      "3\xCF\x83";
  return chart;
}

Chart position_chart(const RunData& data) {
  std::vector<double> odometry = distance_to_truth(data, data.dead_reckoning, 1.0);
  std::vector<double> filter = distance_to_truth(data, filter_trajectory(data), 1.0);
  const PrintUnit unit = print_unit("m", std::max(largest(odometry), largest(filter)));
  for (auto* v : {&odometry, &filter}) {
    for (double& x : *v) x *= unit.scale;
  }
  Chart chart;
  chart.id = "error-position";
  chart.title = "Distance from the true position";
  chart.unit = unit.symbol;
  chart.description = "Position error over time of the filter and of dead reckoning.";
  chart.time = times(data);
  if (!data.dead_reckoning.empty()) chart.series.push_back({"dead reckoning", "odometry", std::move(odometry)});
  chart.series.push_back({"filter", "estimate", std::move(filter)});
  chart.from_zero = true;
  return chart;
}

Chart particle_chart(const RunData& data) {
  Chart chart;
  chart.id = "particles";
  chart.title = "Particles";
  chart.description = "Effective sample size, distinct particles and distinct ancestors over time.";
  chart.time = times(data);
  chart.series = {{"ancestors", "neutral", series(data, [](const auto& e) { return 1.0 * e.distinct_ancestors; })},
                  {"distinct", "limit", series(data, [](const auto& e) { return 1.0 * e.distinct_particles; })},
                  {"effective", "estimate", series(data, [](const auto& e) { return e.effective_sample_size; })}};
  chart.references = {{1.0 * data.estimates.back().particles, "all"}};
  chart.from_zero = true;
  chart.decimals = 0;
  return chart;
}

Chart nis_chart(const RunData& data) {
  Chart chart;
  chart.id = "nis";
  chart.title = "Innovations (NIS per degree of freedom)";
  chart.description = "Mean normalised innovation squared of each scan; a consistent filter stays around 1.";
  chart.time = times(data);
  chart.series = {{"NIS", "estimate", series(data, [](const auto& e) { return e.nis > 0.0 ? e.nis : kNan; })}};
  chart.references = {{1.0, "expected"}};
  chart.from_zero = true;
  return chart;
}

Chart nees_chart(const RunData& data) {
  const Interval bounds = eval::nees_summary({}).step_bounds;
  Chart chart;
  chart.id = "nees";
  chart.title = "Consistency (NEES of the pose)";
  chart.description = "Normalised estimation error squared over time with the 95 % bounds of one step.";
  chart.time = times(data);
  chart.series = {{"NEES", "estimate", nees_series(data)}};
  chart.references = {{bounds.low, "2.5 %"}, {bounds.high, "97.5 %"}};
  chart.logarithmic = true;
  return chart;
}

Chart noise_chart(const RunData& data) {
  Chart chart;
  chart.id = "noise";
  chart.title = "Noise believed, in units of the configured";
  chart.description = "The filter's estimate of the range noise over time.";
  chart.time = times(data);
  chart.series = {{"noise scale", "estimate", series(data, [](const auto& e) { return e.noise_scale; })}};
  chart.references = {{1.0, "configured"}};
  chart.from_zero = true;
  return chart;
}

}  // namespace

std::vector<Chart> error_charts(const RunData& data) {
  if (data.estimates.empty() || data.truth.empty()) return {};
  return {position_chart(data), component_chart(data, 2, "heading"), component_chart(data, 0, "x"),
          component_chart(data, 1, "y")};
}

std::vector<Chart> health_charts(const RunData& data) {
  if (data.estimates.empty()) return {};
  std::vector<Chart> charts{particle_chart(data), nis_chart(data)};
  if (!data.truth.empty()) charts.push_back(nees_chart(data));
  const Chart noise = noise_chart(data);
  if (varies(noise.series.front().values)) charts.push_back(noise);
  return charts;
}

}  // namespace noctule::report
