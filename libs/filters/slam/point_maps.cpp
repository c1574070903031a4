#include "filters/slam/point_maps.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/gaussian.hpp"
#include "particle/parallel.hpp"

namespace noctule::filters {

PointMaps::PointMaps(std::size_t particles, const SightingParameters& sightings,
                     const std::optional<LandmarkLifeParameters>& life, MapStorage storage, int threads)
    : rule_(sightings),
      life_(life),
      threads_(threads),
      maps_(particles, storage),
      tracks_(particles, sightings.tracks),
      shared_identity_(sightings.named_gate == 0.0),
      events_(life ? particles : 0) {
  if (sightings.match == Matching::joint) {
    throw InputError("sightings.match: expected likelihood or nearest, got joint, which is for EKF-SLAM");
  }
}

void PointMaps::begin(const LandmarkDetections& detections, std::int64_t& next_id) {
  scan_.sensor_in_base = detections.sensor_in_base;
  auto& sightings = scan_.sightings;
  sightings.clear();
  for (const LandmarkDetection& d : detections.detections) {
    sightings.emplace_back(d, next_id--);
  }
  // Insertion sort: stable, and allocates nothing. Of one landmark, sightings that can begin it come first.
  const auto before = [](const Sighting& a, const Sighting& b) {
    return a.id >= 0 && (b.id < 0 || a.id < b.id || (a.id == b.id && a.kind < b.kind));
  };
  for (std::size_t k = 1; k < sightings.size(); ++k) {
    for (std::size_t j = k; j > 0 && before(sightings[j], sightings[j - 1]); --j) {
      std::swap(sightings[j], sightings[j - 1]);
    }
  }
}

void PointMaps::associate(std::span<const Pose2> poses, const PoseGaussian& motion) {
  const std::size_t width = scan_.sightings.size();
  shared_identity_ &= width == 0 || scan_.sightings.back().id >= 0;
  slots_.resize(shared_identity_ ? width : width * maps_.particles());
  if (shared_identity_) {
    find_named();
    return;
  }
  particle::for_blocks(maps_.particles(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const PredictedPose pose{poses[i], motion};
      filters::associate(scan_, pose, maps_, i, rule_, {slots_.data() + i * width, width});
      if (life_) find_events(scan_, pose, maps_, i, *life_, slots(i), events_[i]);
    }
  });
}

void PointMaps::find_named() {
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    const Sighting& z = scan_.sightings[k];
    if (z.is_whole()) {
      slots_[k] = slot_of_.try_emplace(z.id, static_cast<std::int32_t>(slot_of_.size())).first->second;
    } else {
      const auto found = slot_of_.find(z.id);
      slots_[k] = found != slot_of_.end() ? found->second : kTracked;
    }
  }
}

void PointMaps::make_writable() {
  for (std::size_t i = 0; i < maps_.particles(); ++i) {
    const auto mine = slots(i);
    const auto size = static_cast<std::int32_t>(maps_.size(i));
    maps_.own(i, mine);
    if (life_ && !shared_identity_) {
      maps_.own(i, events_[i].missed);
      if (events_[i].duplicate >= 0) maps_.own(i, static_cast<std::size_t>(events_[i].duplicate));
    }
    const std::int32_t last = mine.empty() ? kDropped : *std::ranges::max_element(mine);
    if (last >= size) maps_.reserve(i, static_cast<std::size_t>(last - size + 1));
  }
  maps_.copy_pages(threads_);
}

bool PointMaps::live(std::span<const Pose2> poses, std::size_t best, std::span<ObservationFit> fits) {
  if (life_ && !shared_identity_) {
    particle::for_blocks(maps_.particles(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) apply_events(maps_, i, *life_, slots(i), events_[i]);
    });
  }
  return track(poses, best, fits);
}

bool PointMaps::track(std::span<const Pose2> poses, std::size_t best, std::span<ObservationFit> fits) {
  tracks_.begin(scan_);
  bool begun = false;
  for (std::size_t k = 0; k < scan_.sightings.size(); ++k) {
    if (slots(best)[k] != kTracked) continue;
    sensors_.resize(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      sensors_[i] = sensor_pose(poses[i], scan_.sensor_in_base);
      if (slots(i)[k] >= 0) sensors_[i].x = std::nan("");
    }
    const LandmarkTrack* fixed = tracks_.add(scan_.sightings[k], sensors_, best);
    if (fixed == nullptr) continue;
    begin_landmark(*fixed, best, fits);
    tracks_.remove(*fixed);
    begun = true;
  }
  return begun;
}

/// A landmark with a name begins in all particles: where the search ends nowhere, at the place that `best` sees from
/// its pose. One without begins where the particle has nothing there that may be it.
void PointMaps::begin_landmark(const LandmarkTrack& track, std::size_t best, std::span<ObservationFit> fits) {
  const TrackFix seen = tracks_.fix(track, best).value();
  const Pose2 from = track.poses_of(best).back();
  const Vector2 offset = inverse(from) * seen.place;
  const bool named = track.id >= 0;
  double log_free = 0.0;
  for (const Sighting& z : track.kept) log_free += rule_.log_density_of_new(z.kind);
  const double log_density = rule_.log_new[0] - std::log(offset.norm());  // of landmarks, per m^2
  births_.resize(maps_.particles());
  particle::for_blocks(maps_.particles(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      births_[i].reset();
      const Pose2& sensor = track.poses_of(i).back();
      const Vector2 guess = sensor.finite() ? sensor * offset : seen.place;
      auto fix = tracks_.fix(track, i, guess);
      if (!fix && named) fix = tracks_.judge(track, i, guess, seen.covariance);
      if (!fix) continue;
      bool known = false;
      for (std::size_t slot = 0; !named && !known && slot < maps_.size(i); ++slot) {
        const PointLandmark& m = maps_.at(i, slot);
        known =
            mahalanobis2<2>(m.position() - fix->place, m.covariance() + fix->covariance) < rule_.parameters.new_above;
      }
      if (known) continue;
      births_[i] = fix;
      fits[i].log_likelihood += fix->log_likelihood + log_density - log_free * fix->numbers / seen.numbers;
      fits[i].nis += fix->misfit;
      fits[i].degrees_of_freedom += fix->numbers - 2;
    }
  });
  for (std::size_t i = 0; i < births_.size(); ++i) {
    if (births_[i]) maps_.reserve(i, 1);
  }
  maps_.copy_pages(threads_);
  for (std::size_t i = 0; i < births_.size(); ++i) {
    if (!births_[i]) continue;
    PointLandmark m;
    m.set(births_[i]->place, births_[i]->covariance);
    m.id = track.new_id;
    m.observations = births_[i]->numbers;
    if (life_) m.existence = static_cast<float>(life_->born + life_->seen);
    maps_.append(i, m);
  }
  if (shared_identity_) slot_of_.emplace(track.id, static_cast<std::int32_t>(slot_of_.size()));
}

void PointMaps::begin_on(std::span<const PointLandmark> map, std::int64_t& next_id) {
  for (std::size_t i = 0; i < maps_.particles(); ++i) maps_.reserve(i, map.size());
  maps_.copy_pages(threads_);
  for (const PointLandmark& known : map) {
    PointLandmark m = known;
    if (life_) m.existence = static_cast<float>(life_->confirm_above);
    for (std::size_t i = 0; i < maps_.particles(); ++i) maps_.append(i, m);
    if (m.id >= 0) {
      slot_of_.emplace(m.id, static_cast<std::int32_t>(slot_of_.size()));
    } else {
      shared_identity_ = false;  // slots are no longer those of names alone
      next_id = std::min(next_id, m.id - 1);
    }
  }
}

void PointMaps::transfer(StateArchive& archive) {
  // Identities in the order of their slots: the table itself has none.
  std::vector<std::int64_t> names(slot_of_.size());
  for (const auto& [id, slot] : slot_of_) names[static_cast<std::size_t>(slot)] = id;
  archive(shared_identity_, names, maps_, tracks_);
  if (!archive.reads()) return;
  slot_of_.clear();
  for (const std::int64_t id : names) slot_of_.emplace(id, static_cast<std::int32_t>(slot_of_.size()));
}

void PointMaps::inherit(std::span<const std::uint32_t> ancestors) {
  if (shared_identity_) return;
  const std::size_t width = scan_.sightings.size();
  for (std::size_t i = 0; i < ancestors.size(); ++i) {
    if (ancestors[i] == i) continue;
    std::copy_n(slots_.data() + ancestors[i] * width, width, slots_.data() + i * width);
    if (life_) events_[i] = events_[ancestors[i]];
  }
}

}  // namespace noctule::filters
