#pragma once
/// What all readers of recordings share.
#include <string>
#include <vector>

#include "core/source.hpp"

namespace noctule::datasets {

/// A whole recording in memory.
struct Recording {
  std::vector<Observation> observations;  ///< in any order; numbered by RecordedSource
  KnownWorld world;
  std::vector<std::string> notes;  ///< what was left out or repaired, one line each
};

/// Yields a recording that its derived reader has read whole.
class RecordedSource : public ObservationSource {
 public:
  [[nodiscard]] std::optional<Observation> next() override;
  [[nodiscard]] const KnownWorld& world() const override { return recording_.world; }
  /// What the reader left out or repaired, one complete line each; for the user to see.
  [[nodiscard]] const std::vector<std::string>& notes() const { return recording_.notes; }

 protected:
  explicit RecordedSource(Recording recording);

 private:
  Recording recording_;
  std::size_t next_ = 0;
};

}  // namespace noctule::datasets
