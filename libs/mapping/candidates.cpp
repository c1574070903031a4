/// How Competition finds its candidates.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/competition.hpp"

namespace noctule::mapping {
namespace {

constexpr double kPeakWindow = 0.08;  // residuals allowed at a peak of the accumulators [m]
constexpr int kRefinements = 3;       // of the set of echoes and the fit to it
constexpr int kMaxRefusals = 12;      // peaks of a kind tried in vain before a search gives up
constexpr double kRoughFit = 1e-3;    // precision of candidates' fits [m, rad]
constexpr double kFineFit = 1e-5;
constexpr double kWorth = 0.9;      // share of its gain a candidate must keep when another was taken
constexpr double kPeakShare = 0.3;  // of the votes of min_readings echoes that a line's peak must hold

}  // namespace

std::vector<int> Competition::supporters(const EchoFit& fit, double window) const {
  std::vector<int> members;
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    const Reflector::Sight sight = fit.reflector.sight(arcs_[i].sensor);
    if (std::abs(arcs_[i].range - sight.range) < std::max(window, model_.cut(fit, arcs_[i])) &&
        model_.log_likelihood(fit, sight, arcs_[i]) > explained_[i]) {
      members.push_back(static_cast<int>(i));
    }
  }
  return members;
}

std::optional<Object> Competition::refined(const Reflector& start) const {
  EchoFit fit{start, 1.0};
  for (int i = 0; i < kRefinements; ++i) {
    const std::vector<int> members = supporters(fit, i == 0 ? kPeakWindow : 0.0);
    if (static_cast<int>(members.size()) < parameters_.support.enough(start.is_wall())) return {};
    const auto next = fit_echoes(fit, arcs_, members, parameters_.robust, kRoughFit);
    if (!next) return {};
    fit = *next;
    if (fit.reflector.type() == ContourType::arc &&
        fit.reflector.cylinder().radius > parameters_.hough.max_radius + parameters_.hough.radius_bin) {
      return {};
    }
  }
  Object object{.fit = fit, .members = supporters(fit, 0.0), .evidence = {}};
  measure(object);
  return object;
}

std::optional<Object> Competition::refined_round(const Cylinder& start) const {
  auto object = refined(Reflector(Cylinder{start.centre, std::max(start.radius, parameters_.hough.radius_bin)}));
  if (!object && start.radius > 0.0) return {};
  if (!object) return refined(Reflector(Cylinder{start.centre, 0.0}));
  const EchoFit simple = simplest(object->fit, object->members);
  if (simple.reflector.type() == object->fit.reflector.type()) return object;
  return refined(simple.reflector);
}

double Competition::log_likelihood(const EchoFit& fit, std::span<const int> members) const {
  double sum = 0.0;
  for (const int i : members) {
    sum += std::max(model_.log_clutter(), model_.log_likelihood(fit, arcs_[static_cast<std::size_t>(i)]));
  }
  return sum;
}

EchoFit Competition::refitted(const EchoFit& fit, std::span<const int> members) const {
  return fit_echoes(fit, arcs_, members, parameters_.robust, kFineFit).value_or(fit);
}

EchoFit Competition::simplest(const EchoFit& fit, std::span<const int> members) const {
  if (fit.reflector.is_wall()) return refitted(fit, members);

  const SupportParameters& need = parameters_.support;
  const Cylinder c = fit.reflector.cylinder();
  Vector2 direction = Vector2::Zero();
  for (const int i : members) direction += fit.reflector.sight(arcs_[static_cast<std::size_t>(i)].sensor).direction;
  const Wall tangent{direction.normalized().dot(c.centre) - c.radius, std::atan2(direction.y(), direction.x())};
  EchoFit best = fit;
  double most = -std::numeric_limits<double>::infinity();
  for (const Reflector& start : {Reflector(Cylinder{c.centre, 0.0}), Reflector(tangent),
                                 Reflector(Cylinder{c.centre, std::max(c.radius, need.min_radius)})}) {
    const auto candidate = fit_echoes({start, 1.0}, arcs_, members, parameters_.robust, kRoughFit);
    if (!candidate) continue;
    double likelihood = log_likelihood(*candidate, members);
    if (start.type() == ContourType::arc) {
      const double radius = candidate->reflector.cylinder().radius;
      if (radius < need.min_radius || radius > parameters_.hough.max_radius + parameters_.hough.radius_bin) continue;
      likelihood -= need.radius_evidence;
    }
    if (likelihood <= most) continue;
    best = *candidate;
    most = likelihood;
  }
  return refitted({best.reflector, 1.0}, members);
}

std::optional<Object> Competition::best_wall() {
  const double share_of_one = parameters_.hough.theta_bin / (2.0 * arcs_.front().half_angle);
  const double threshold = kPeakShare * parameters_.support.min_readings * share_of_one;
  for (int refusals = 0; refusals < kMaxRefusals; ++refusals) {
    const auto peak = lines_.best(threshold);
    if (!peak) return {};
    if (auto object = refined(Reflector(peak->wall)); object && supported(*object)) return object;
    lines_.refuse(*peak);
  }
  return {};
}

std::optional<Object> Competition::best_round() {
  for (int refusals = 0; refusals < kMaxRefusals; ++refusals) {
    const auto peak = circles_.best(0.0);
    if (!peak) return {};
    if (auto object = refined_round(peak->cylinder); object && supported(*object)) return object;
    circles_.refuse(*peak);
  }
  return {};
}

bool Competition::still_worth(Object& object) const {
  const double before = object.gain;
  measure(object);
  return object.gain > kWorth * before;
}

void Competition::accept(Object object) {
  const int id = static_cast<int>(objects_.size());
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    explained_[i] = std::max(explained_[i], model_.log_likelihood(object.fit, arcs_[i]));
  }
  for (const int i : object.members) set_owner(i, id);
  objects_.push_back(std::move(object));
}

bool Competition::grow() {
  if (arcs_.empty()) return false;
  const std::size_t before = objects_.size();
  std::optional<Object> wall, round;
  while (true) {
    update_votes();
    if (!wall || !still_worth(*wall)) wall = best_wall();
    if (!round || !still_worth(*round)) round = best_round();
    if (!wall && !round) return objects_.size() > before;
    auto& winner = wall && (!round || wall->gain >= round->gain) ? wall : round;
    accept(std::move(*winner));
    winner.reset();
  }
}

}  // namespace noctule::mapping
