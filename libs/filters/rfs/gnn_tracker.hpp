#pragma once
/// The baseline of multi-object filters: a Kalman filter per track and one association per scan (Blackman and Popoli,
/// Design and Analysis of Modern Tracking Systems, 1999, sections 6.2 and 6.4).
#include "filters/rfs/multi_object.hpp"

namespace noctule::filters {

struct GnnTrackerParameters {
  ObjectModel model;
  double gate = 13.82;    ///< largest squared Mahalanobis distance of a pair (99.9 % of 2 numbers)
  int confirm_hits = 4;   ///< a track is an object when it was seen so often ...
  int confirm_scans = 5;  ///< ... in its first so many scans; else it is given up
  int delete_misses = 3;  ///< an object not seen so many times running is gone

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = GnnTrackerParameters;
    v.group("model", &P::model, "how objects move and are seen");
    v.field("gate", &P::gate, unit::one, "largest squared Mahalanobis distance of a pair", positive());
    v.field("confirm_hits", &P::confirm_hits, unit::one, "a track is an object when seen so often", at_least(1));
    v.field("confirm_scans", &P::confirm_scans, unit::one, "in its first so many scans", at_least(1));
    v.field("delete_misses", &P::delete_misses, unit::one, "an object not seen so many times running is gone",
            at_least(1));
  }
  [[nodiscard]] std::string validate() const {
    return confirm_hits > confirm_scans ? "confirm_hits must not be above confirm_scans" : std::string();
  }
};

/// Global nearest neighbour: confirmed tracks take their measurements first, tentative ones of what is left, each by
/// the assignment of greatest likelihood against "not seen, and the measurement a false alarm"; what then remains
/// starts a tentative track.
class GnnTracker : public MultiObjectFilter {
 public:
  /// \throws InputError for parameters out of range
  explicit GnnTracker(const GnnTrackerParameters& = {});
  void update(std::span<const Vector2> measurements) override;
  [[nodiscard]] std::vector<ObjectEstimate> objects() const override;

 private:
  struct Track {
    ObjectEstimate object;
    bool confirmed = false;
    int scans = 1;  ///< since the first measurement, that included
    int hits = 1;
    int misses = 0;  ///< running
  };
  void associate(bool confirmed, std::span<const Vector2> measurements, std::vector<bool>& taken);

  GnnTrackerParameters parameters_;
  std::vector<Track> tracks_;  ///< by ascending label
  std::int64_t next_label_ = 0;
};

}  // namespace noctule::filters
