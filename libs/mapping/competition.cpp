#include "mapping/competition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/rho_theta.hpp"

namespace noctule::mapping {
namespace {

constexpr double kTail = 3.0;                  // degrees of freedom of the Student-t
constexpr double kStudentTop = 0.36755259694;  // its density at 0
constexpr double kConeMargin = radians(5.0);   // an echo may come from this far outside the cone
constexpr double kPeakWindow = 0.08;           // residuals allowed at a peak of the accumulators [m]
constexpr double kRough = 1e-4, kFine = 1e-8;    // precision of fits [m, rad]
constexpr int kMaxRefusals = 12;               // peaks tried in vain before giving up
constexpr int kSettleRounds = 12;              // at most

double span_of(std::span<const SonarArc> arcs, std::span<const int> members) {
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int i : members) {
    low = low.cwiseMin(arcs[static_cast<std::size_t>(i)].sensor);
    high = high.cwiseMax(arcs[static_cast<std::size_t>(i)].sensor);
  }
  return members.empty() ? 0.0 : (high - low).norm();
}

}  // namespace

Competition::Competition(const MapperParameters& parameters, const Extent& extent)
    : parameters_(parameters),
      log_clutter_(std::log(parameters.clutter / parameters.clutter_range) - std::log(kTwoPi)),
      lines_(parameters.hough, extent, LineVotes::Normals::directed),
      circles_(parameters.hough, extent) {}

void Competition::add(const SonarArc& arc) {
  arcs_.push_back(arc);
  explained_.push_back(log_clutter_);
  owner_.push_back(-1);
  voted_.push_back(1);
  lines_.vote(arc, 1.0);
  circles_.vote(arc, 1.0);
}

double Competition::log_likelihood(const EchoFit& fit, const SonarArc& arc) const {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  const Reflector::Sight s = fit.reflector.sight(arc.sensor);
  const double off_axis2 = 2.0 - 2.0 * s.direction.dot(arc.axis);  // squared chord, nearly the squared angle
  const double limit = arc.half_angle + kConeMargin;
  if (off_axis2 > limit * limit || s.range <= 0.0) return kNever;
  const double sigma =
      std::max(arc.sigma * std::max(1.0, fit.scale), parameters_.robust.floor / parameters_.robust.tukey);
  const double e = (arc.range - s.range) / sigma;
  if (e * e > 400.0) return kNever;
  const double beam = 0.5 * arc.half_angle;
  return std::log(kStudentTop / sigma / (beam * std::sqrt(kTwoPi))) - 0.5 * (kTail + 1.0) * std::log1p(e * e / kTail) -
         0.5 * off_axis2 / (beam * beam);
}

std::vector<int> Competition::supporters(const EchoFit& fit, double window) const {
  std::vector<int> members;
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    const double e = std::abs(arcs_[i].range - fit.reflector.sight(arcs_[i].sensor).range);
    const double cut =
        std::max({window, parameters_.robust.floor, parameters_.robust.tukey * arcs_[i].sigma * fit.scale});
    if (e < cut && log_likelihood(fit, arcs_[i]) > explained_[i]) members.push_back(static_cast<int>(i));
  }
  return members;
}

std::optional<Object> Competition::refined(const Reflector& start) const {
  EchoFit fit{start, 1.0};
  for (int round = 0; round < 3; ++round) {
    const std::vector<int> members = supporters(fit, round == 0 ? kPeakWindow : 0.0);
    if (static_cast<int>(members.size()) < parameters_.support.min_readings) return {};
    const auto next = fit_echoes(fit, arcs_, members, parameters_.robust, kRough);
    if (!next) return {};
    fit = *next;
    if (fit.reflector.type() == ContourType::arc &&
        !(fit.reflector.cylinder().radius < parameters_.hough.max_radius + parameters_.hough.radius_bin)) {
      return {};
    }
  }
  Object object{.fit = fit, .members = supporters(fit, 0.0)};
  measure(object);
  return object;
}

void Competition::measure(Object& object) const {
  const Reflector& reflector = object.fit.reflector;
  std::vector<int> stops;
  std::vector<double> where;  // feet along the wall, or directions from the centre
  for (const int i : object.members) {
    const SonarArc& arc = arcs_[static_cast<std::size_t>(i)];
    stops.push_back(arc.stop);
    const Vector2 d = reflector.sight(arc.sensor).direction;
    where.push_back(reflector.is_wall() ? reflector.wall().tangent().dot(arc.sensor) : std::atan2(d.y(), d.x()));
  }
  std::sort(stops.begin(), stops.end());
  object.stops = static_cast<int>(std::unique(stops.begin(), stops.end()) - stops.begin());
  if (where.empty()) return;
  std::sort(where.begin(), where.end());
  if (reflector.is_wall()) {
    object.begin = where.front();
    object.end = where.back();
    object.span = object.end - object.begin;
  } else {
    double gap = kTwoPi - (where.back() - where.front());
    for (std::size_t i = 1; i < where.size(); ++i) gap = std::max(gap, where[i] - where[i - 1]);
    object.viewing_angle = kTwoPi - gap;
    object.span = span_of(arcs_, object.members);
  }
  object.gain = 0.0;
  for (const int i : object.members) {
    const auto k = static_cast<std::size_t>(i);
    object.gain += std::max(0.0, log_likelihood(object.fit, arcs_[k]) - explained_[k]);
  }
}

bool Competition::supported(const Object& object) const {
  const SupportParameters& need = parameters_.support;
  if (static_cast<int>(object.members.size()) < need.min_readings || object.stops < need.min_stops ||
      object.span < need.min_span || object.gain < need.min_gain) {
    return false;
  }
  int contradictions = 0;
  const Reflector& reflector = object.fit.reflector;
  for (const SonarArc& arc : arcs_) {
    const Reflector::Sight s = reflector.sight(arc.sensor);
    const double beam = 0.5 * arc.half_angle;
    const double margin = std::max(parameters_.robust.floor, 3.0 * parameters_.robust.tukey * arc.sigma);
    if (s.range <= 0.0 || arc.range < s.range + margin || 2.0 - 2.0 * s.direction.dot(arc.axis) > beam * beam) continue;
    if (reflector.is_wall()) {
      const double at = reflector.wall().tangent().dot(arc.sensor);
      if (at < object.begin || at > object.end) continue;
    }
    ++contradictions;
  }
  return contradictions <= need.max_contradiction * static_cast<double>(object.members.size());
}

std::optional<Object> Competition::best_wall(Blocked& blocked) {
  const float threshold =
      static_cast<float>(0.3 * parameters_.support.min_readings * parameters_.hough.theta_bin / radians(30.0));
  for (int refusals = 0; refusals < kMaxRefusals; ++refusals) {
    const VoteGrid::Peak peak = lines_.grid().best(threshold, [&](int row, int column) {
      const Wall w = lines_.wall({row, column, 0.0F});
      return std::none_of(blocked.walls.begin(), blocked.walls.end(), [&](const Wall& b) {
        return std::abs(wrap(w.theta - b.theta)) < radians(3.0) && std::abs(w.rho - b.rho) < 0.06;
      });
    });
    if (peak.row < 0) return {};
    if (auto object = refined(Reflector(lines_.wall(peak))); object && supported(*object)) return object;
    blocked.walls.push_back(lines_.wall(peak));
  }
  return {};
}

std::optional<Object> Competition::refined_round(const Cylinder& start) const {
  auto object = refined(Reflector(Cylinder{start.centre, std::max(start.radius, parameters_.hough.radius_bin)}));
  if (!object) return refined(Reflector(Cylinder{start.centre, 0.0}));
  const EchoFit simple = simplest(object->fit, object->members);
  if (simple.reflector.type() == object->fit.reflector.type()) return object;
  return refined(simple.reflector);
}

std::optional<Object> Competition::best_cylinder(Blocked& blocked) {
  const float threshold = static_cast<float>(0.02 * parameters_.support.min_readings);
  for (int refusals = 0; refusals < kMaxRefusals; ++refusals) {
    const VoteGrid::Peak peak = circles_.grid().best(threshold, [&](int row, int column) {
      const Cylinder c = circles_.cylinder({row, column, 0.0F});
      return std::none_of(blocked.cylinders.begin(), blocked.cylinders.end(), [&](const Cylinder& b) {
        return (c.centre - b.centre).norm() < 0.10 && std::abs(c.radius - b.radius) < 0.11;
      });
    });
    if (peak.row < 0) return {};
    const Cylinder start = circles_.cylinder(peak);
    if (auto object = refined_round(start); object && supported(*object)) return object;
    blocked.cylinders.push_back(start);
  }
  return {};
}

void Competition::accept(Object object) {
  const int id = static_cast<int>(objects_.size());
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    const double l = log_likelihood(object.fit, arcs_[i]);
    if (l <= explained_[i]) continue;
    explained_[i] = l;
    owner_[i] = id;
  }
  for (const int i : object.members) {
    const auto k = static_cast<std::size_t>(i);
    if (voted_[k] == 0) continue;
    lines_.vote(arcs_[k], -1.0);
    circles_.vote(arcs_[k], -1.0);
    voted_[k] = 0;
  }
  objects_.push_back(std::move(object));
}

bool Competition::still_worth(Object& object) const {
  const double before = object.gain;
  measure(object);
  return object.gain > 0.9 * before;
}

void Competition::grow() {
  Blocked blocked;
  std::optional<Object> wall, cylinder;
  while (true) {
    if (!wall || !still_worth(*wall)) wall = best_wall(blocked);
    if (!cylinder || !still_worth(*cylinder)) cylinder = best_cylinder(blocked);
    if (!wall && !cylinder) return;
    auto& winner = wall && (!cylinder || wall->gain >= cylinder->gain) ? wall : cylinder;
    accept(std::move(*winner));
    winner.reset();
  }
}

void Competition::share_out() {
  std::fill(explained_.begin(), explained_.end(), log_clutter_);
  std::fill(owner_.begin(), owner_.end(), -1);
  std::vector<double> second(arcs_.size(), log_clutter_);
  for (std::size_t id = 0; id < objects_.size(); ++id) {
    for (std::size_t i = 0; i < arcs_.size(); ++i) {
      const double l = log_likelihood(objects_[id].fit, arcs_[i]);
      if (l > explained_[i]) {
        second[i] = explained_[i];
        explained_[i] = l;
        owner_[i] = static_cast<int>(id);
      } else if (l > second[i]) {
        second[i] = l;
      }
    }
  }
  for (Object& object : objects_) object.members.clear();
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    if (owner_[i] < 0) continue;
    Object& object = objects_[static_cast<std::size_t>(owner_[i])];
    const double e = std::abs(arcs_[i].range - object.fit.reflector.sight(arcs_[i].sensor).range);
    if (e < std::max(parameters_.robust.floor, parameters_.robust.tukey * arcs_[i].sigma * object.fit.scale)) {
      object.members.push_back(static_cast<int>(i));
    }
  }
  for (Object& object : objects_) {
    measure(object);
    object.gain = 0.0;
    for (const int i : object.members) {
      object.gain += explained_[static_cast<std::size_t>(i)] - second[static_cast<std::size_t>(i)];
    }
  }
}

bool Competition::overlap(const Object& a, const Object& b) const {
  const Reflector &ra = a.fit.reflector, &rb = b.fit.reflector;
  const double limit = parameters_.support.merge_distance;
  if (ra.is_wall() != rb.is_wall()) return false;
  if (!ra.is_wall()) {
    const Cylinder ca = ra.cylinder(), cb = rb.cylinder();
    return (ca.centre - cb.centre).norm() < ca.radius + cb.radius + 0.5 * limit;
  }
  const Wall wa = ra.wall(), wb = rb.wall();
  if (std::abs(wrap(wa.theta - wb.theta)) > parameters_.support.merge_angle) return false;
  const Vector2 t = wa.tangent();
  const auto along = [&](double s) { return t.dot(foot(wb) + s * wb.tangent()); };
  const double low = std::max(a.begin, std::min(along(b.begin), along(b.end)));
  const double high = std::min(a.end, std::max(along(b.begin), along(b.end)));
  if (low > high) return false;
  return std::abs(wb.distance(foot(wa) + 0.5 * (low + high) * t)) < limit;
}

bool Competition::merge_overlapping() {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    for (std::size_t j = i + 1; j < objects_.size(); ++j) {
      if (!overlap(objects_[i], objects_[j])) continue;
      if (objects_[i].gain < objects_[j].gain) std::swap(objects_[i], objects_[j]);
      Object& kept = objects_[i];
      kept.members.insert(kept.members.end(), objects_[j].members.begin(), objects_[j].members.end());
      const double scale = 2.0 * std::max(kept.fit.scale, objects_[j].fit.scale);
      objects_.erase(objects_.begin() + static_cast<std::ptrdiff_t>(j));
      if (const auto fit = fit_echoes({kept.fit.reflector, scale}, arcs_, kept.members, parameters_.robust, kFine)) {
        kept.fit = *fit;
      }
      return true;
    }
  }
  return false;
}

bool Competition::drop_weakest() {
  auto weakest = objects_.end();
  for (auto it = objects_.begin(); it != objects_.end(); ++it) {
    if (!supported(*it) && (weakest == objects_.end() || it->gain < weakest->gain)) weakest = it;
  }
  if (weakest == objects_.end()) return false;
  objects_.erase(weakest);
  return true;
}

double Competition::log_likelihood(const EchoFit& fit, std::span<const int> members) const {
  double sum = 0.0;
  for (const int i : members) {
    const auto k = static_cast<std::size_t>(i);
    sum += std::max(log_clutter_, log_likelihood(fit, arcs_[k]));
  }
  return sum;
}

EchoFit Competition::simplest(const EchoFit& fit, std::span<const int> members) const {
  const auto fitted = [&](const Reflector& start) {
    return fit_echoes({start, 1.0}, arcs_, members, parameters_.robust, kFine);
  };
  if (fit.reflector.is_wall()) return fitted(fit.reflector).value_or(fit);

  const Cylinder c = fit.reflector.cylinder();
  Vector2 direction = Vector2::Zero();
  for (const int i : members) direction += fit.reflector.sight(arcs_[static_cast<std::size_t>(i)].sensor).direction;
  const Wall tangent{direction.normalized().dot(c.centre) - c.radius, std::atan2(direction.y(), direction.x())};
  EchoFit best = fit;
  double best_likelihood = -std::numeric_limits<double>::infinity();
  for (const Reflector& start : {Reflector(Cylinder{c.centre, 0.0}), Reflector(tangent),
                                 Reflector(Cylinder{c.centre, std::max(c.radius, parameters_.support.min_radius)})}) {
    const auto candidate = fitted(start);
    if (!candidate) continue;
    double likelihood = log_likelihood(*candidate, members);
    if (start.type() == ContourType::arc) {
      const double radius = candidate->reflector.cylinder().radius;
      if (radius < parameters_.support.min_radius || radius > parameters_.hough.max_radius + parameters_.hough.radius_bin) continue;
      likelihood -= parameters_.support.radius_evidence;
    }
    if (likelihood <= best_likelihood) continue;
    best = *candidate;
    best_likelihood = likelihood;
  }
  return best;
}

void Competition::settle() {
  for (int round = 0; round < kSettleRounds; ++round) {
    share_out();
    for (Object& object : objects_) object.fit = simplest(object.fit, object.members);
    if (merge_overlapping()) continue;
    share_out();
    if (!drop_weakest() && round > 0) return;
  }
  share_out();
}

ContourMap Competition::map() const {
  ContourMap map;
  for (const Object& object : objects_) {
    const Matrix3 covariance = echo_covariance(object.fit, arcs_, object.members, parameters_.robust);
    const int readings = static_cast<int>(object.members.size());
    const Reflector& reflector = object.fit.reflector;
    if (reflector.is_wall()) {
      WallEstimate w{.wall = normalised(reflector.wall()),
                     .covariance = covariance.topLeftCorner<2, 2>(),
                     .begin = object.begin,
                     .end = object.end,
                     .readings = readings,
                     .stops = object.stops};
      if (reflector.wall().rho < 0.0) {
        w.covariance(0, 1) = w.covariance(1, 0) = -w.covariance(0, 1);
        w.begin = -object.end;
        w.end = -object.begin;
      }
      map.walls.push_back(w);
    } else if (reflector.type() == ContourType::arc) {
      map.cylinders.push_back({reflector.cylinder(), covariance, object.viewing_angle, readings, object.stops});
    } else {
      map.points.push_back({reflector.cylinder().centre, covariance.topLeftCorner<2, 2>(), readings, object.stops});
    }
  }
  return map;
}

}  // namespace noctule::mapping
