#pragma once
/// Upright round posts of known colour and diameter, as the robots of MR.CLAM see.
#include <memory>
#include <string>
#include <vector>

#include "core/parameters.hpp"
#include "sensors/camera/ground.hpp"
#include "sensors/camera/landmark_detector.hpp"

namespace noctule::sensors {

struct PostParameters {
  std::int64_t id = 0;
  std::vector<double> colour{200.0, 40.0, 40.0};
  double radius = 0.05;  ///< [m]
  double height = 0.0;   ///< [m]; 0: unknown

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = PostParameters;
    v.field("id", &P::id, unit::one, "identity as a landmark", at_least(0));
    v.field("colour_rgb", &P::colour, unit::one, "its colour: red, green, blue", between(0.0, 255.0));
    v.field("radius_cm", &P::radius, unit::centimetre, "its radius", positive());
    v.field("height_cm", &P::height, unit::centimetre, "from the floor to its top; 0: unknown", at_least(0.0));
  }
};

struct PostDetectorParameters {
  std::vector<PostParameters> catalogue;
  double hue_gate = radians(12.0);  ///< largest angle between colours, seen from grey [rad]
  double min_saturation = 0.25;     ///< share of a pixel's brightness that is colour
  double min_width_px = 5.0;
  double edge_sd_px = 0.25;  ///< common to all pixels of an edge
  bool check_ground = true;  ///< whether the foot must stand where the width says
  GroundParameters ground;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = PostDetectorParameters;
    v.list("catalogue", &P::catalogue, "posts that can be met");
    v.field("hue_gate_deg", &P::hue_gate, unit::degree, "largest difference of hue to the post's", between(1.0, 60.0));
    v.field("min_saturation", &P::min_saturation, unit::one, "least share of a pixel's brightness that is colour",
            between(0.05, 1.0));
    v.field("min_width_px", &P::min_width_px, unit::one, "narrower posts are left out", at_least(2.0));
    v.field("edge_sd_px", &P::edge_sd_px, unit::one, "sd that all pixels of an edge share, in pixels", positive());
    v.field("check_ground", &P::check_ground, "whether a visible foot must stand where the width says");
    v.group("ground", &P::ground, "what is uncertain about the foot");
  }
  [[nodiscard]] std::string validate() const;
};

/// Posts by colour, then by the azimuths of their two edges. An edge of an upright cylinder lies in one vertical plane
/// through the optical centre, however the camera is pitched or rolled; the axis lies in the middle at
/// radius / sin(half the angle between the planes). Where the foot is seen, the floor gives the range a second time:
/// what contradicts it is no post. The landmark is the axis. Grey pictures have no posts.
[[nodiscard]] std::unique_ptr<LandmarkDetector> make_post_detector(const PostDetectorParameters& parameters,
                                                                   const models::CameraIntrinsics& camera,
                                                                   const models::CameraMounting& mounting);

}  // namespace noctule::sensors
