#include "datasets/recorded_source.hpp"

#include <utility>

#include "core/observation_order.hpp"

namespace noctule::datasets {

RecordedSource::RecordedSource(Recording recording) : recording_(std::move(recording)) {
  put_in_order(recording_.observations);
}

std::optional<Observation> RecordedSource::next() {
  if (next_ == recording_.observations.size()) return std::nullopt;
  return std::move(recording_.observations[next_++]);
}

}  // namespace noctule::datasets
