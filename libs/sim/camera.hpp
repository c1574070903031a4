#pragma once
/// A camera in a room: exposure, lens, light and sensor.
#include <cstdint>
#include <vector>

#include "core/image.hpp"
#include "sim/camera_parameters.hpp"
#include "sim/renderer.hpp"

namespace noctule::sim {

class Camera {
 public:
  /// \throws InputError where the lens model sends no ray through a part of the image
  Camera(const CameraParameters&, const RoomParameters&, std::uint64_t seed);

  /// The picture number `seq`. Noise is addressed by (seed, seq, row): other settings do not shift it.
  /// \param begin,end true pose of the base when the shutter opens and closes
  /// \param time of the middle of the exposure, for the lighting [s]; the stamp's utime is left 0
  [[nodiscard]] CameraImage shoot(const Pose2& begin, const Pose2& end, std::int64_t seq, double time);
  [[nodiscard]] DepthImage depth(const Pose2& base_in_map) { return renderer_.depth(base_in_map); }
  [[nodiscard]] const CameraParameters& parameters() const { return parameters_; }

 private:
  void expose(const Pose2& begin, const Pose2& end);
  void defocus();
  [[nodiscard]] Image develop(std::int64_t seq, double time) const;

  CameraParameters parameters_;
  std::uint64_t seed_;
  int channels_;
  Renderer renderer_;
  std::vector<float> kernel_;  ///< of the defocus, from the middle outwards
  std::vector<float> light_;
  std::vector<float> blurred_;
};

}  // namespace noctule::sim
