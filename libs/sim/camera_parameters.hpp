#pragma once
/// A simulated camera: its lens, its place, and what spoils its pictures.
#include <string>

#include "core/parameters.hpp"
#include "models/camera.hpp"

namespace noctule::sim {

/// Brightness of the scene over time: gain (1 + swing sin(2 pi t / period)), and across the image.
struct LightingParameters {
  double gain = 1.0;
  double swing = 0.0;
  double period = 20.0;
  double gradient = 0.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LightingParameters;
    v.field("gain", &P::gain, unit::one, "brightness; 1: as the pictures are", at_least(0.0));
    v.field("swing", &P::swing, unit::one, "how much it rises and falls, as a fraction", between(0.0, 1.0));
    v.field("period_s", &P::period, unit::second, "of one rise and fall", positive());
    v.field("gradient", &P::gradient, unit::one, "fraction by which the right edge is brighter than the middle",
            between(-1.0, 1.0));
  }
};

struct CameraParameters {
  models::CameraIntrinsics intrinsics;
  models::CameraMounting mounting;
  bool colour = true;
  double rate = 0.0;
  double exposure = 0.005;
  double blur = 0.5;
  double noise = 2.0;
  LightingParameters lighting;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = CameraParameters;
    v.group("intrinsics", &P::intrinsics, "lens and sensor");
    v.group("mounting", &P::mounting, "where it sits on the robot");
    v.field("colour", &P::colour, "whether it sees colours");
    v.field("rate_hz", &P::rate, unit::hertz, "most pictures a second while the robot moves; 0: one at each stop",
            between(0.0, 1000.0));
    v.field("exposure_s", &P::exposure, unit::second, "time of one exposure: motion blur", at_least(0.0));
    v.field("blur", &P::blur, unit::one, "standard deviation of the defocus [pixels]", between(0.0, 20.0));
    v.field("noise", &P::noise, unit::one, "standard deviation of a pixel [grey levels of 255]", at_least(0.0));
    v.group("lighting", &P::lighting, "brightness over time");
  }
};

}  // namespace noctule::sim
