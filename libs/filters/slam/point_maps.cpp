#include "filters/slam/point_maps.hpp"

#include <algorithm>
#include <cmath>

#include "particle/parallel.hpp"

namespace noctule::filters {

PointMaps::PointMaps(std::size_t particles, const SightingParameters& sightings,
                     const std::optional<LandmarkLifeParameters>& life, MapStorage storage, int threads)
    : parameters_(sightings),
      life_(life),
      threads_(threads),
      log_new_density_(std::log(sightings.new_density)),
      maps_(particles, storage),
      events_(life ? particles : 0) {}

void PointMaps::begin(const LandmarkDetections& detections, std::int64_t& next_id) {
  scan_.sensor_in_base = detections.sensor_in_base;
  auto& sightings = scan_.sightings;
  sightings.clear();
  for (const LandmarkDetection& d : detections.detections) {
    Sighting& z = sightings.emplace_back();
    z.range = d.range;
    z.bearing = wrap(d.bearing);
    z.rr = d.covariance(0, 0);
    z.rb = d.covariance(0, 1);
    z.bb = d.covariance(1, 1);
    z.id = d.id;
    z.new_id = next_id--;
  }
  // Insertion sort: stable, and allocates nothing.
  const auto before = [](const Sighting& a, const Sighting& b) { return a.id >= 0 && (b.id < 0 || a.id < b.id); };
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
      filters::associate(scan_, pose, maps_, i, parameters_, {slots_.data() + i * width, width});
      if (life_) find_events(scan_, pose, maps_, i, *life_, slots(i), events_[i]);
    }
  });
}

void PointMaps::find_named() {
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    slots_[k] = slot_of_.try_emplace(scan_.sightings[k].id, static_cast<std::int32_t>(slot_of_.size())).first->second;
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

void PointMaps::live() {
  if (!life_ || shared_identity_) return;
  particle::for_blocks(maps_.particles(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) apply_events(maps_, i, *life_, slots(i), events_[i]);
  });
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
