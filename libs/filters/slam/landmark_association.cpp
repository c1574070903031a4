#include "filters/slam/landmark_association.hpp"

#include <algorithm>

#include "core/assignment.hpp"
#include "core/chi2.hpp"
#include "core/error.hpp"
#include "core/limits.hpp"

namespace noctule::filters {
namespace {

/// A sighting and a landmark that may have made it.
struct Candidate {
  std::size_t sighting;
  std::int32_t slot;
  double cost;  ///< -log of how much likelier than that the sighting stays free
};

/// Kept by each thread, so that matching allocates nothing once warm (but where sightings compete for landmarks).
struct Scratch {
  std::vector<Candidate> candidates;
  std::vector<double> nearest;        ///< of each sighting, least squared Mahalanobis distance
  std::vector<std::int32_t> columns;  ///< slots that sightings compete for
  std::vector<std::size_t> rows;      ///< the sightings that compete
};

class Matcher {
 public:
  Matcher(const LandmarkScan& scan, const PredictedPose& pose, const LandmarkMaps& maps, std::size_t particle,
          const MatchRule& rule, std::span<std::int32_t> slots, Scratch& scratch)
      : scan_(scan),
        pose_(pose),
        maps_(maps),
        particle_(particle),
        rule_(rule),
        parameters_(rule.parameters),
        slots_(slots),
        scratch_(scratch),
        size_(static_cast<std::int32_t>(maps.size(particle))),
        next_(size_) {}

  void run() {
    std::size_t k = 0;
    for (; k < scan_.sightings.size() && scan_.sightings[k].id >= 0; ++k) find_named(k);
    if (parameters_.named_gate > 0.0) drop_outliers(k);
    if (k == scan_.sightings.size()) return;
    gather(k);
    if (parameters_.match == Matching::nearest) {
      match_nearest();
    } else {
      match_jointly();
    }
    for (; k < scan_.sightings.size(); ++k) {
      const Sighting& z = scan_.sightings[k];
      if (slots_[k] != kDropped || !(scratch_.nearest[k] > parameters_.new_above)) continue;
      if (z.is_whole()) slots_[k] = next_++;
      if (z.kind == DetectionKind::bearing_only) slots_[k] = kTracked;
    }
  }

 private:
  void find_named(std::size_t k) {
    const std::int64_t id = scan_.sightings[k].id;
    if (k > 0 && scan_.sightings[k - 1].id == id) {  // whole ones come first
      slots_[k] = slots_[k - 1];
      return;
    }
    std::int32_t slot = 0;
    while (slot < size_ && maps_.at(particle_, static_cast<std::size_t>(slot)).id != id) ++slot;
    slots_[k] = slot < size_ ? slot : scan_.sightings[k].is_whole() ? next_++ : kTracked;
  }

  /// Of the first `named` sightings.
  void drop_outliers(std::size_t named) {
    const Pose2 moved = pose_.base * pose_.motion.mean, sensor = sensor_pose(moved, scan_.sensor_in_base);
    for (std::size_t k = 0; k < named; ++k) {
      if (slots_[k] < 0 || slots_[k] >= size_) continue;
      const Sighting& z = scan_.sightings[k];
      const double distance2 =
          predict(z, maps_.at(particle_, static_cast<std::size_t>(slots_[k])), sensor, moved).distance2;
      if ((z.is_whole() ? distance2 : distance2 * rule_.one_number) > parameters_.named_gate) slots_[k] = kDropped;
    }
  }

  [[nodiscard]] bool is_named(std::int64_t id, std::size_t unnamed) const {
    return id >= 0 &&
           std::any_of(scan_.sightings.begin(), scan_.sightings.begin() + static_cast<std::ptrdiff_t>(unnamed),
                       [id](const Sighting& z) { return z.id == id; });
  }

  /// Pairs within the gate, from the first sighting without identity on.
  void gather(std::size_t first) {
    scratch_.candidates.clear();
    scratch_.nearest.assign(scan_.sightings.size(), kInf);
    const Pose2 moved = pose_.base * pose_.motion.mean;
    const Pose2 sensor = sensor_pose(moved, scan_.sensor_in_base);
    const bool certain = pose_.motion.covariance.isZero(0.0);
    // No pose in the prior is farther from its mean than this, at the level of the gate.
    const double reach2 = certain ? 0.0 : pose_.motion.covariance.topLeftCorner<2, 2>().trace();
    for (std::size_t k = first; k < scan_.sightings.size(); ++k) slots_[k] = kDropped;
    for (std::int32_t slot = 0; slot < size_; ++slot) {
      const PointLandmark& m = maps_.at(particle_, static_cast<std::size_t>(slot));
      const double dx = m.x - sensor.x, dy = m.y - sensor.y;
      const double distance = std::sqrt(dx * dx + dy * dy);
      const double spread2 =
          m.xx + m.yy + 2.0 * reach2 +
          (certain ? 0.0 : 2.0 * scan_.sensor_in_base.position().squaredNorm() * pose_.motion.covariance(2, 2));
      bool checked_name = false;
      for (std::size_t k = first; k < scan_.sightings.size(); ++k) {
        const Sighting& z = scan_.sightings[k];
        // d2 >= (range innovation)^2 / its variance: most pairs need no bearing.
        const double off = z.kind == DetectionKind::bearing_only ? 0.0 : z.range - distance;
        if (off * off > parameters_.new_above * (spread2 + z.rr)) continue;
        if (!checked_name && is_named(m.id, first)) break;
        checked_name = true;
        consider(k, slot, m, sensor, moved);
      }
    }
  }

  /// With the motion's uncertainty.
  [[nodiscard]] InnovationCovariance predict(const Sighting& z, const PointLandmark& m, const Pose2& sensor,
                                             const Pose2& moved) const {
    auto [v, c, s] = PredictedSighting(m, z, sensor);
    if (!pose_.motion.covariance.isZero(0.0)) {
      const auto h =
          by_motion(z, v, {std::cos(pose_.base.yaw), std::sin(pose_.base.yaw)}, sensor.position() - moved.position());
      const Matrix2 p = h * pose_.motion.covariance * h.transpose();
      s = {s.rr + p(0, 0), s.rb + p(0, 1), s.bb + p(1, 1), v};
    }
    return s;
  }

  void consider(std::size_t k, std::int32_t slot, const PointLandmark& m, const Pose2& sensor, const Pose2& moved) {
    const Sighting& z = scan_.sightings[k];
    const InnovationCovariance s = predict(z, m, sensor, moved);
    const double distance2 = z.is_whole() ? s.distance2 : s.distance2 * rule_.one_number;
    scratch_.nearest[k] = std::min(scratch_.nearest[k], distance2);
    if (distance2 > parameters_.gate) return;
    const double unmeasured = z.is_whole() ? 0.0 : 0.5 * std::log(kTwoPi);  // of the number that never strays
    scratch_.candidates.push_back({k, slot, rule_.log_density_of_new(z.kind) - unmeasured - s.log_density()});
  }

  void match_nearest() {
    auto& candidates = scratch_.candidates;
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      double best = kInf;
      for (const Candidate& c : candidates) {
        if (c.sighting == k && c.cost < best) {
          best = c.cost;
          slots_[k] = c.slot;
        }
      }
    }
  }

  /// The most likely assignment, each landmark at most once, a free sighting at the price of a new landmark. Only where
  /// sightings have several candidates or share one is there something to solve.
  void match_jointly() {
    auto& candidates = scratch_.candidates;
    std::erase_if(candidates, [](const Candidate& c) { return c.cost >= 0.0; });
    bool contested = false;
    for (std::size_t a = 0; a < candidates.size() && !contested; ++a) {
      for (std::size_t b = a + 1; b < candidates.size() && !contested; ++b) {
        contested = candidates[a].sighting == candidates[b].sighting || candidates[a].slot == candidates[b].slot;
      }
    }
    if (!contested) {
      for (const Candidate& c : candidates) slots_[c.sighting] = c.slot;
      return;
    }
    auto& rows = scratch_.rows;
    auto& columns = scratch_.columns;
    rows.clear();
    columns.clear();
    for (const Candidate& c : candidates) {
      if (std::ranges::find(rows, c.sighting) == rows.end()) rows.push_back(c.sighting);
      if (std::ranges::find(columns, c.slot) == columns.end()) columns.push_back(c.slot);
    }
    Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(rows.size()),
                                                     static_cast<Eigen::Index>(columns.size()), kInf);
    for (const Candidate& c : candidates) {
      cost(std::ranges::find(rows, c.sighting) - rows.begin(), std::ranges::find(columns, c.slot) - columns.begin()) =
          c.cost;
    }
    const auto column_of = assign(cost, 0.0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (column_of[i] >= 0) slots_[rows[i]] = columns[static_cast<std::size_t>(column_of[i])];
    }
  }

  const LandmarkScan& scan_;
  const PredictedPose& pose_;
  const LandmarkMaps& maps_;
  std::size_t particle_;
  const MatchRule& rule_;
  const SightingParameters& parameters_;
  std::span<std::int32_t> slots_;
  Scratch& scratch_;
  std::int32_t size_, next_;
};

}  // namespace

std::vector<PointLandmark> point_landmarks(const LandmarkMap& map) {
  std::vector<PointLandmark> result;
  for (const LandmarkEstimate& e : map.landmarks) {
    if (e.kind != LandmarkKind::point) throw InputError("map: expected point landmarks only, got walls or cylinders");
    if (!e.parameters.allFinite() || !e.covariance.allFinite()) throw InputError("map: expected finite landmarks");
    PointLandmark& m = result.emplace_back();
    m.set(e.parameters.head<2>(), e.covariance.topLeftCorner<2, 2>());
    m.id = e.id;
    m.observations = e.observations;
  }
  return result;
}

MatchRule::MatchRule(const SightingParameters& p)
    : parameters(p),
      log_new{std::log(p.new_density), std::log(p.new_density * p.tracks.max_range), std::log(p.new_density * kPi)},
      one_number(p.gate / chi2_quantile(chi2_cdf(p.gate, 2), 1)) {}

void associate(const LandmarkScan& scan, const PredictedPose& pose, const LandmarkMaps& maps, std::size_t particle,
               const MatchRule& rule, std::span<std::int32_t> slots) {
  thread_local Scratch scratch;
  Matcher(scan, pose, maps, particle, rule, slots, scratch).run();
}

}  // namespace noctule::filters
