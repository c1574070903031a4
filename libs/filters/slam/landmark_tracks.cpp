#include "filters/slam/landmark_tracks.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/chi2.hpp"
#include "core/symmetric_eigen.hpp"

namespace noctule::filters {
namespace {

constexpr std::size_t kMostTracks = 64;  // without identity: clutter must not fill the memory
constexpr int kStarts = 12;              // places on the circle of a first range
constexpr double kMirror = 13.8;         // a second place is excluded when the first is 1000 times as likely
constexpr int kIterations = 30;
constexpr double kBow = 0.5;  // of the circle, over one sd, in units of the sd along its radius
constexpr int kMisfits = 3;   // sightings in a row that do not agree with the others
constexpr double kSds = 3.0;
// Of a track without identity: so many sightings that could disagree, and seen in such a share of the messages.
constexpr int kSurplus = 4;
constexpr double kSeenShare = 0.7;

/// Residuals of the sightings at a place, as the normal equations of Gauss-Newton.
struct Normal {
  Matrix2 information = Matrix2::Zero();
  Vector2 gradient = Vector2::Zero();
  double misfit = 0.0, log_variances = 0.0;
  int numbers = 0;
  bool ranged = false;
  bool ahead = true;  ///< no bearing points away from the place
};

Normal equations(std::span<const Sighting> sightings, std::span<const Pose2> sensors, const Vector2& place) {
  Normal n;
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    if (!sensors[k].finite()) continue;
    const Sighting& z = sightings[k];
    const Innovation v = innovation<double>(z, sensors[k], place.x(), place.y());
    const bool bearing = z.kind == DetectionKind::bearing_only;
    const Vector2 h = bearing ? Vector2(-v.inverse_range * v.uy, v.inverse_range * v.ux) : Vector2(v.ux, v.uy);
    const double residual = bearing ? v.bearing : v.range, variance = bearing ? z.bb : z.rr;
    n.information += h * h.transpose() / variance;
    n.gradient += h * (residual / variance);
    n.misfit += residual * residual / variance;
    n.log_variances += std::log(kTwoPi * variance);
    n.ranged |= !bearing;
    n.ahead &= !bearing || std::abs(v.bearing) < 0.5 * kPi;
    ++n.numbers;
  }
  return n;
}

/// Levenberg-Marquardt. \return nothing where it ends nowhere
std::optional<TrackFix> descend(std::span<const Sighting> sightings, std::span<const Pose2> sensors, Vector2 place) {
  Normal at = equations(sightings, sensors, place);
  double damping = 1e-4;
  for (int k = 0; k < kIterations; ++k) {
    Matrix2 damped = at.information;
    damped.diagonal() *= 1.0 + damping;
    if (!(damped.determinant() > 0.0)) return std::nullopt;
    const Vector2 step = damped.inverse() * at.gradient;
    if (!step.allFinite()) return std::nullopt;
    const Normal next = equations(sightings, sensors, place + step);
    if (next.misfit > at.misfit) {
      damping *= 10.0;
      if (damping > 1e8) break;
      continue;
    }
    const double gain = at.misfit - next.misfit;
    place += step;
    at = next;
    damping = std::max(0.1 * damping, 1e-9);
    if (gain < 1e-9 * (1.0 + at.misfit) && step.dot(at.information * step) < 1e-6) break;
  }
  const double determinant = at.information.determinant();
  if (!at.ahead || !(determinant > 0.0) || !place.allFinite()) return std::nullopt;
  TrackFix fix{place, at.information.inverse(), at.misfit, at.numbers, at.ranged, 0.0};
  fix.log_likelihood = -0.5 * (at.misfit + at.log_variances + std::log(determinant)) + std::log(kTwoPi);
  return fix;
}

/// Where the rays of all bearings come nearest to each other.
std::optional<Vector2> crossing(std::span<const Sighting> sightings, std::span<const Pose2> sensors) {
  Matrix2 a = Matrix2::Zero();
  Vector2 b = Vector2::Zero();
  int rays = 0;
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    if (sightings[k].kind != DetectionKind::bearing_only || !sensors[k].finite()) continue;
    const double direction = sensors[k].yaw + sightings[k].bearing;
    const Vector2 n(-std::sin(direction), std::cos(direction));
    a += n * n.transpose();
    b += n * n.dot(sensors[k].position());
    ++rays;
  }
  if (rays < 2 || !(a.determinant() > 1e-9)) return std::nullopt;
  return a.inverse() * b;
}

Vector2 along(const Pose2& sensor, double bearing, double range) {
  return sensor.position() + range * Vector2(std::cos(sensor.yaw + bearing), std::sin(sensor.yaw + bearing));
}

/// Bearings fix the place where their rays cross. Ranges may fix two, mirrored at the way: the search begins all
/// around the first one, and all places but one must be excluded.
std::optional<TrackFix> search(std::span<const Sighting> sightings, std::span<const Pose2> sensors) {
  if (const auto place = crossing(sightings, sensors)) {
    if (auto fix = descend(sightings, sensors, *place)) return fix;
  }
  const auto is_range = [&](std::size_t k) {
    return sightings[k].kind == DetectionKind::range_only && sensors[k].finite();
  };
  std::size_t first = 0;
  while (first < sightings.size() && !is_range(first)) ++first;
  if (first == sightings.size()) return std::nullopt;
  std::optional<TrackFix> best, second;
  for (int s = 0; s < kStarts; ++s) {
    const auto fix = descend(sightings, sensors, along(sensors[first], s * kTwoPi / kStarts, sightings[first].range));
    if (!fix) continue;
    const auto elsewhere = [&](const TrackFix& other) {
      const Vector2 d = fix->place - other.place;
      return d.dot(other.covariance.inverse() * d) > 1.0;
    };
    if (!best || fix->misfit < best->misfit) {
      if (best && elsewhere(*best)) second = best;
      best = fix;
    } else if (elsewhere(*best) && (!second || fix->misfit < second->misfit)) {
      second = fix;
    }
  }
  if (!best || (second && second->misfit < best->misfit + kMirror)) return std::nullopt;
  return best;
}

}  // namespace

void LandmarkTracks::begin(const LandmarkScan& scan) {
  ++message_;
  if (tracks_.empty()) return;
  std::erase_if(tracks_, [&](const LandmarkTrack& t) {
    if (t.id < 0) return message_ - t.last_seen > parameters_.forget_after;
    return std::ranges::any_of(scan.sightings, [&](const Sighting& z) { return z.is_whole() && z.id == t.id; });
  });
}

const LandmarkTrack* LandmarkTracks::add(const Sighting& z, std::span<const Pose2> sensors, std::size_t best) {
  LandmarkTrack* track = find(z, sensors[best], best);
  if (track == nullptr) {
    if (z.id < 0 && tracks_.size() >= kMostTracks) return nullptr;
    track = &tracks_.emplace_back();
    track->id = z.id;
    track->new_id = z.id >= 0 ? z.id : z.new_id;
    track->first_seen = message_;
    track->spacing = parameters_.spacing;
    track->row = static_cast<std::size_t>(parameters_.sightings);
    track->sensors.resize(particles_ * track->row);
  }
  track->last_seen = message_;
  ++track->times_seen;
  const auto poses = track->poses_of(best);
  const bool other_kind = !track->kept.empty() && track->kept.back().kind != z.kind;
  if (!poses.empty() && poses.back().finite() && !other_kind &&
      (poses.back().position() - sensors[best].position()).norm() < track->spacing) {
    return nullptr;
  }
  keep(*track, z, sensors);
  const auto found = fix(*track, best);
  track->place.reset();
  if (!found) return nullptr;
  const int surplus = found->numbers - 2;
  if (surplus < 1) return nullptr;  // nothing yet that could disagree
  if (found->misfit > chi2_quantile(parameters_.agreement, surplus)) {
    track->kept.pop_back();  // perhaps of something else
    if (++track->misfits >= kMisfits) remove(*track);
    return nullptr;
  }
  track->misfits = 0;
  const Pose2 back = inverse(sensors[best]);
  const Matrix2 turn = Eigen::Rotation2Dd(back.yaw).toRotationMatrix();
  track->place = back * found->place;
  track->covariance = turn * found->covariance * turn.transpose();
  if (!is_certain(*found, sensors[best])) return nullptr;
  if (z.id < 0 &&
      (surplus < kSurplus || track->times_seen < kSeenShare * static_cast<double>(message_ - track->first_seen + 1))) {
    return nullptr;
  }
  return track;
}

bool LandmarkTracks::is_certain(const TrackFix& fix, const Pose2& sensor) const {
  const double distance = (fix.place - sensor.position()).norm();
  const auto variances = symmetric_eigen<2>(fix.covariance).values;
  const double worst = variances.maxCoeff(), best = variances.minCoeff();
  // Across a circle about the sensor, as ranges leave it, a Gaussian is straight: the bow must not show.
  const bool straight = !fix.ranged || worst < kBow * 2.0 * distance * std::sqrt(best);
  return straight && distance < parameters_.max_range && worst < std::pow(parameters_.certain * distance, 2);
}

LandmarkTrack* LandmarkTracks::find(const Sighting& z, const Pose2& sensor, std::size_t best) {
  LandmarkTrack* found = nullptr;
  double nearest = kInf;
  for (LandmarkTrack& track : tracks_) {
    if (z.id >= 0 || track.id >= 0) {
      if (track.id == z.id) return &track;
      continue;
    }
    double distance = 0.0;
    if (track.last_seen == message_ || !continues(track, z, sensor, best, distance) || distance >= nearest) continue;
    nearest = distance;
    found = &track;
  }
  return found;
}

/// Whether the bearing may be of the landmark that the track has seen last, somewhere along that ray.
bool LandmarkTracks::continues(const LandmarkTrack& track, const Sighting& z, const Pose2& sensor, std::size_t best,
                               double& distance) const {
  const auto poses = track.poses_of(best);
  const Pose2& before = poses.back();
  if (!before.finite()) return false;
  const Sighting& last = track.kept.back();
  if (track.place) {
    const Vector2 d = before * *track.place - sensor.position();
    const Vector2 across = Vector2(-d.y(), d.x()) / std::max(d.squaredNorm(), 1e-12);
    const Matrix2 turn = Eigen::Rotation2Dd(before.yaw).toRotationMatrix();
    distance = std::abs(wrap(std::atan2(d.y(), d.x()) - sensor.yaw - z.bearing));
    return distance < kSds * std::sqrt(z.bb + across.dot(turn * track.covariance * turn.transpose() * across));
  }
  const double way = (sensor.position() - before.position()).norm();
  const auto bearing_of = [&](double range) {
    const Vector2 d = along(before, last.bearing, range) - sensor.position();
    return wrap(std::atan2(d.y(), d.x()) - sensor.yaw);
  };
  const double far = bearing_of(parameters_.max_range);
  const double near = wrap(bearing_of(std::max(3.0 * way, 1e-3)) - far), off = wrap(z.bearing - far);
  const double margin = kSds * std::sqrt(last.bb + z.bb);
  distance = std::abs(off);
  return off > std::min(near, 0.0) - margin && off < std::max(near, 0.0) + margin;
}

void LandmarkTracks::keep(LandmarkTrack& track, const Sighting& z, std::span<const Pose2> sensors) {
  if (track.kept.size() == track.row) thin(track);
  for (std::size_t i = 0; i < particles_; ++i) track.sensors[i * track.row + track.kept.size()] = sensors[i];
  track.kept.push_back(z);
}

/// Every second sighting goes, unused.
void LandmarkTracks::thin(LandmarkTrack& track) const {
  track.spacing *= 2.0;
  const std::size_t half = (track.kept.size() + 1) / 2;
  for (std::size_t k = 0; k < half; ++k) {
    track.kept[k] = track.kept[2 * k];
    for (std::size_t i = 0; i < particles_; ++i) {
      track.sensors[i * track.row + k] = track.sensors[i * track.row + 2 * k];
    }
  }
  track.kept.resize(half);
}

std::optional<TrackFix> LandmarkTracks::fix(const LandmarkTrack& track, std::size_t particle,
                                            const std::optional<Vector2>& guess) const {
  const auto poses = track.poses_of(particle);
  if (std::ranges::count_if(poses, [](const Pose2& p) { return p.finite(); }) < 2) return std::nullopt;
  return guess ? descend(track.kept, poses, *guess) : search(track.kept, poses);
}

TrackFix LandmarkTracks::judge(const LandmarkTrack& track, std::size_t particle, const Vector2& place,
                               const Matrix2& covariance) const {
  const Normal n = equations(track.kept, track.poses_of(particle), place);
  return {place,    covariance,
          n.misfit, n.numbers,
          n.ranged, -0.5 * (n.misfit + n.log_variances - std::log(covariance.determinant())) + std::log(kTwoPi)};
}

void LandmarkTracks::remove(const LandmarkTrack& track) {
  tracks_.erase(tracks_.begin() + (&track - tracks_.data()));
}

void LandmarkTracks::resample(std::span<const std::uint32_t> ancestors) {
  for (LandmarkTrack& track : tracks_) {
    for (std::size_t i = 0; i < ancestors.size(); ++i) {
      if (ancestors[i] == i) continue;
      std::copy_n(track.sensors.data() + ancestors[i] * track.row, track.kept.size(),
                  track.sensors.data() + i * track.row);
    }
  }
}

}  // namespace noctule::filters
