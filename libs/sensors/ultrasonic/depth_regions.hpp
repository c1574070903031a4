#pragma once
/// Regions of constant depth (Leonard and Durrant-Whyte 1992): runs of neighbouring pings with the same range, each
/// the echo of one object, and the scale of the range noise as the differences inside the runs show it.
#include <array>
#include <cstdint>
#include <vector>

#include "core/observations.hpp"
#include "core/parameters.hpp"
#include "models/ultrasonic.hpp"
#include "sensors/ultrasonic/geometry.hpp"

namespace noctule::sensors {

struct DepthRegionParameters {
  models::RangeNoise noise;    ///< nominal; the scale on top is estimated
  double threshold = 3.0;      ///< pings join a run within this many standard deviations
  double noise_memory = 40.0;  ///< differences between neighbours that the noise scale is estimated from, about

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("noise", &DepthRegionParameters::noise, "nominal range noise; its scale is estimated online");
    v.field("threshold", &DepthRegionParameters::threshold, unit::one,
            "pings join a region within this many standard deviations", positive());
    v.field("noise_memory", &DepthRegionParameters::noise_memory, unit::one,
            "about how many differences of neighbouring pings the noise scale remembers", at_least(1.0));
  }
};

/// The pings that heard one object, fused; in base_link at the scan.
struct DepthRegion {
  Sighting heard;                   ///< mean sensor position, robust mean range, mean of the axes
  double extent = 0.0;              ///< angle between the outermost axes [rad]
  std::vector<std::int32_t> beams;  ///< ascending by angle
};

/// Scale of the range noise, in units of the nominal one, from differences between neighbouring pings: a discounted
/// Bayes filter on a grid of scales, Gaussian differences plus a uniform share from pings at different objects.
class NoiseScale {
 public:
  /// \param memory number of differences after which old ones have lost 63 % of their weight
  explicit NoiseScale(double memory);
  /// \param difference of two ranges [m]
  /// \param nominal_variance of the difference at scale 1 [m^2]
  /// \param other_variance part that does not scale with the range noise [m^2]
  void add(double difference, double nominal_variance, double other_variance);
  [[nodiscard]] double value() const;

 private:
  static constexpr int kScales = 25;  ///< 1/4 to 16, four an octave
  std::array<double, kScales> log_posterior_{};
  double discount_;
};

class DepthRegionFinder {
 public:
  explicit DepthRegionFinder(const DepthRegionParameters& parameters);

  /// Regions of one scan, down to lone pings, ascending by angle. First takes the scan's differences into the noise
  /// scale. Beams that are no hit are passed over; hits that are not finite, outside the limits or of a non-finite
  /// sensor pose are ignored and counted. The result is valid until the next call. \throws InputError when the cone or
  /// the limits of the scan make no sense
  [[nodiscard]] const std::vector<DepthRegion>& find(const UltrasonicScan& scan);

  [[nodiscard]] double noise_scale() const { return noise_scale_.value(); }
  [[nodiscard]] std::int64_t ignored_beams() const { return ignored_beams_; }

 private:
  struct Ping {
    Vector2 position;
    double axis;  ///< [rad], unrolled: ascending along the scan, over 2 pi where it wraps
    double range;
    std::int32_t beam;
  };
  struct Run {
    double first_axis, last_axis;
    double mean;  ///< range as heard at the position of the first ping [m]
    Vector2 origin;
    std::vector<std::int32_t> pings;  ///< indices into pings_
  };

  void collect(const UltrasonicScan& scan);
  void unroll_at_widest_gap();
  void learn_noise(double half_angle);
  void group(double half_angle);
  void summarise(const Run& run, double half_angle, DepthRegion& region);
  [[nodiscard]] double displacement(const Ping& from, const Vector2& to, double axis) const;

  DepthRegionParameters parameters_;
  NoiseScale noise_scale_;
  std::int64_t ignored_beams_ = 0;
  std::vector<Ping> pings_;
  std::vector<Run> runs_;  ///< the first run_count_ are in use; capacity is kept between scans
  std::size_t run_count_ = 0;
  std::vector<double> ranges_;  ///< scratch of summarise()
  std::vector<DepthRegion> regions_;
};

}  // namespace noctule::sensors
