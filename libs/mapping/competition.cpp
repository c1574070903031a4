#include "mapping/competition.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/rho_theta.hpp"

namespace noctule::mapping {
namespace {

constexpr int kSettleRounds = 12;        // at most
constexpr int kOutside = 10;             // echoes outside the accumulators that make them grow
constexpr double kSharedStretch = 0.25;  // of the readings of two walls that must lie before both
constexpr double kGrowth = 1.5;          // of the extent, beyond what holds the echoes

Extent limited(Extent extent, double most) {
  extent.radius = std::min(extent.radius, most);
  return extent;
}

}  // namespace

Competition::Competition(const MapperParameters& parameters, const Extent& extent)
    : parameters_(parameters),
      model_(parameters.echo, parameters.robust),
      extent_(limited(extent, parameters.max_extent)),
      lines_(parameters.hough, extent_, LineVotes::Normals::directed),
      circles_(parameters.hough, extent_) {}

void Competition::cast(int slot, bool votes) {
  const auto i = static_cast<std::size_t>(slot);
  if ((votes_[i] != 0) == votes) return;
  votes_[i] = votes ? 1 : 0;
  lines_.vote(arcs_[i], votes ? 1.0 : -1.0);
  circles_.vote(arcs_[i], votes ? 1.0 : -1.0);
}

/// The echoes that belong to no object vote, and no others.
void Competition::update_votes() {
  for (std::size_t i = 0; i < arcs_.size(); ++i) cast(static_cast<int>(i), owner_[i] == kNobody);
}

void Competition::set_owner(int slot, int owner) {
  int& now = owner_[static_cast<std::size_t>(slot)];
  unexplained_ += (owner == kNobody ? 1 : 0) - (now == kNobody ? 1 : 0);
  now = owner;
}

void Competition::cover() {
  if (outside_ < kOutside || extent_.radius >= parameters_.max_extent) return;
  outside_ = 0;
  extent_ = Extent::of(arcs_);
  extent_.radius *= kGrowth;
  extent_ = limited(extent_, parameters_.max_extent);
  lines_ = LineVotes(parameters_.hough, extent_, LineVotes::Normals::directed);
  circles_ = CircleVotes(parameters_.hough, extent_);
  std::fill(votes_.begin(), votes_.end(), char{0});
}

void Competition::allow_all() {
  lines_.allow_all();
  circles_.allow_all();
}

void Competition::remove(int slot) {
  const auto i = static_cast<std::size_t>(slot);
  cast(slot, false);
  if (owner_[i] == kNobody) return;
  std::erase(objects_[static_cast<std::size_t>(owner_[i])].members, slot);
  set_owner(slot, kNobody);
}

void Competition::put(int slot, const SonarArc& arc) {
  if (slot == static_cast<int>(arcs_.size())) {
    arcs_.push_back(arc);
    explained_.push_back(0.0);
    owner_.push_back(kNobody);
    votes_.push_back(0);
    ++unexplained_;
  } else {
    remove(slot);
    arcs_[static_cast<std::size_t>(slot)] = arc;
  }
  if ((arc.sensor + arc.range * arc.axis - extent_.centre).norm() > extent_.radius) ++outside_;
  claim(slot);
}

void Competition::claim(int slot) {
  const auto i = static_cast<std::size_t>(slot);
  const SonarArc& arc = arcs_[i];
  explained_[i] = model_.log_clutter();
  int owner = kNobody;
  for (std::size_t id = 0; id < objects_.size(); ++id) {
    const double l = model_.log_likelihood(objects_[id].fit, arc);
    if (l <= explained_[i]) continue;
    explained_[i] = l;
    owner = static_cast<int>(id);
  }
  if (owner != kNobody) {
    Object& object = objects_[static_cast<std::size_t>(owner)];
    const double residual = std::abs(arc.range - object.fit.reflector.sight(arc.sensor).range);
    if (residual < model_.cut(object.fit, arc)) {
      object.members.push_back(slot);
      object.has_news = true;
      set_owner(slot, owner);
    }
  }
}

void Competition::share_out() {
  std::vector<double> second(arcs_.size(), model_.log_clutter());
  std::vector<int> best(arcs_.size(), kNobody);
  std::fill(explained_.begin(), explained_.end(), model_.log_clutter());
  for (std::size_t id = 0; id < objects_.size(); ++id) {
    objects_[id].members.clear();
    for (std::size_t i = 0; i < arcs_.size(); ++i) {
      const double l = model_.log_likelihood(objects_[id].fit, arcs_[i]);
      if (l > explained_[i]) {
        second[i] = explained_[i];
        explained_[i] = l;
        best[i] = static_cast<int>(id);
      } else if (l > second[i]) {
        second[i] = l;
      }
    }
  }
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    int owner = kNobody;
    if (best[i] != kNobody) {
      Object& object = objects_[static_cast<std::size_t>(best[i])];
      const double residual = std::abs(arcs_[i].range - object.fit.reflector.sight(arcs_[i].sensor).range);
      if (residual < model_.cut(object.fit, arcs_[i])) {
        owner = best[i];
        object.members.push_back(static_cast<int>(i));
      }
    }
    set_owner(static_cast<int>(i), owner);
  }
  for (Object& object : objects_) {
    object.evidence = evidence_of(object.fit.reflector, arcs_, object.members);
    object.gain = 0.0;
    for (const int i : object.members) {
      object.gain += explained_[static_cast<std::size_t>(i)] - second[static_cast<std::size_t>(i)];
    }
  }
}

void Competition::measure(Object& object) const {
  object.evidence = evidence_of(object.fit.reflector, arcs_, object.members);
  object.gain = 0.0;
  for (const int i : object.members) {
    const auto k = static_cast<std::size_t>(i);
    object.gain += std::max(0.0, model_.log_likelihood(object.fit, arcs_[k]) - explained_[k]);
  }
}

int Competition::contradictions(const Object& object) const {
  const Reflector& reflector = object.fit.reflector;
  const Vector2 tangent = reflector.tangent();
  int count = 0;
  for (const SonarArc& arc : arcs_) {
    const Reflector::Sight sight = reflector.sight(arc.sensor);
    const double beam = 0.5 * arc.half_angle;  // within which a surface is hardly missed
    const double margin = std::max(parameters_.robust.floor, 3.0 * parameters_.robust.tukey * arc.sigma);
    if (sight.range <= 0.0 || arc.range < sight.range + margin || off_axis2(sight, arc) > beam * beam) continue;
    if (reflector.is_wall()) {
      const double at = tangent.dot(arc.sensor);
      if (at < object.evidence.begin || at > object.evidence.end) continue;
    }
    ++count;
  }
  return count;
}

bool Competition::supported(const Object& object) const {
  const SupportParameters& need = parameters_.support;
  const Evidence& has = object.evidence;
  return has.readings >= need.enough(object.fit.reflector.is_wall()) && has.stops >= need.min_stops &&
         has.span >= need.min_span && object.gain >= need.min_gain &&
         contradictions(object) <= need.max_contradiction * has.readings;
}

int Competition::readings_before(const Object& wall, const Object& other) const {
  const Vector2 tangent = wall.fit.reflector.tangent();
  return static_cast<int>(std::count_if(other.members.begin(), other.members.end(), [&](int i) {
    const double at = tangent.dot(arcs_[static_cast<std::size_t>(i)].sensor);
    return at > wall.evidence.begin && at < wall.evidence.end;
  }));
}

bool Competition::claim_same_place(const Object& a, const Object& b) const {
  const Reflector &ra = a.fit.reflector, &rb = b.fit.reflector;
  const double limit = parameters_.support.merge_distance;
  if (ra.is_wall() != rb.is_wall()) return false;
  if (!ra.is_wall()) {
    const Cylinder ca = ra.cylinder(), cb = rb.cylinder();
    return (ca.centre - cb.centre).norm() < ca.radius + cb.radius + 0.5 * limit;
  }
  const Wall wa = ra.wall(), wb = rb.wall();
  if (std::abs(wrap(wa.theta - wb.theta)) > parameters_.support.merge_angle) return false;
  // A cupboard and the wall on both sides of it are heard at different places; one wall with two poses is not.
  const double enough = kSharedStretch * std::min(a.evidence.readings, b.evidence.readings);
  if (readings_before(a, b) < enough || readings_before(b, a) < enough) return false;
  const auto along = [&](double s) { return wa.tangent().dot(foot(wb) + s * wb.tangent()); };
  const double low = std::max(a.evidence.begin, along(b.evidence.begin));
  const double high = std::min(a.evidence.end, along(b.evidence.end));
  return std::abs(wb.distance(foot(wa) + 0.5 * (low + high) * wa.tangent())) < limit;
}

bool Competition::merge_two() {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    for (std::size_t j = i + 1; j < objects_.size(); ++j) {
      if (!claim_same_place(objects_[i], objects_[j])) continue;
      if (objects_[i].gain < objects_[j].gain) std::swap(objects_[i], objects_[j]);
      Object& kept = objects_[i];
      kept.members.insert(kept.members.end(), objects_[j].members.begin(), objects_[j].members.end());
      const double scale = 2.0 * std::max(kept.fit.scale, objects_[j].fit.scale);
      objects_.erase(objects_.begin() + static_cast<std::ptrdiff_t>(j));
      kept.fit = refitted({kept.fit.reflector, scale}, kept.members);
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

void Competition::settle() {
  share_out();
  bool kinds_are_open = true;
  for (int round = 0; round < kSettleRounds; ++round) {
    for (Object& object : objects_) {
      const EchoFit start{object.fit.reflector, 1.0};
      object.fit = kinds_are_open ? simplest(start, object.members) : refitted(start, object.members);
    }
    kinds_are_open = merge_two();
    share_out();
    if (kinds_are_open) continue;
    kinds_are_open = drop_weakest();
    if (kinds_are_open) {
      share_out();
    } else if (round > 0) {
      break;
    }
  }
  for (Object& object : objects_) object.has_news = false;
  allow_all();
}

void Competition::follow() {
  for (Object& object : objects_) {
    if (!object.has_news) continue;
    object.fit = improved(object.fit, arcs_, object.members, parameters_.robust);
    object.has_news = false;
  }
}

void Competition::restart() {
  objects_.clear();
  std::fill(explained_.begin(), explained_.end(), model_.log_clutter());
  std::fill(owner_.begin(), owner_.end(), kNobody);
  unexplained_ = static_cast<int>(arcs_.size());
  allow_all();
}

ContourMap Competition::map() const {
  ContourMap map;
  for (const Object& object : objects_) {
    const Reflector& reflector = object.fit.reflector;
    const Evidence e = evidence_of(reflector, arcs_, object.members);
    const Matrix3 covariance = echo_covariance(object.fit, arcs_, object.members, parameters_.robust);
    if (!covariance.allFinite()) continue;  // nothing that could be said of it
    if (reflector.is_wall()) {
      map.walls.push_back(wall_estimate(object.fit, covariance, e));
    } else if (reflector.type() == ContourType::arc) {
      const double view = viewing_angle_of(reflector, arcs_, object.members);
      map.cylinders.push_back({reflector.cylinder(), covariance, view, e.readings, e.stops});
    } else {
      map.points.push_back({reflector.cylinder().centre, covariance.topLeftCorner<2, 2>(), e.readings, e.stops});
    }
  }
  return map;
}

}  // namespace noctule::mapping
