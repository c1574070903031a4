#pragma once
/// Draws a room as a camera on a robot sees it: walls with pictures, upright cylinders, floor and ceiling.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/pose2.hpp"
#include "models/camera.hpp"
#include "sim/texture.hpp"
#include "sim/world.hpp"

namespace noctule::sim {

struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<float> depth;  ///< along the optical axis [m], row by row from the top left
};

/// Casts one ray through each corner between pixels. Where all four corners of a pixel see the same surface its light
/// is taken from its middle, from a texture of fitting resolution; where they differ, from 16 rays: edges are smooth.
/// Upright surfaces are found through a table over the azimuth. Depends on nothing but the arguments.
class Renderer {
 public:
  /// \param channels 1 (grey) or 3 (blue, green, red)
  /// \throws InputError where the lens model sends no ray through a part of the image
  Renderer(const RoomParameters&, const models::CameraIntrinsics&, const models::CameraMounting&, int channels);

  /// Adds `weight` times the light of every pixel, in grey levels, row by row, channels next to each other.
  void add_light(const Pose2& base_in_map, float weight, std::vector<float>& light);
  /// Depth in the middle of each pixel.
  [[nodiscard]] DepthImage depth(const Pose2& base_in_map);

 private:
  /// Direction in the axes of the base, 1 m long along the optical axis.
  struct Ray {
    float x, y, z;
  };
  struct RoomWall {
    Vector2 from, tangent, normal;
    double length;
    float grey;  ///< mean, by which side the light comes from
    std::vector<int> pictures;
  };
  struct Picture {
    int wall;
    float along, height, half;
    Texture texture;
  };
  struct Cylinder {
    Vector2 centre;
    double radius, height;
    std::array<float, 3> tint;
  };
  /// Walls and cylinders in the axes of the base, around the optical centre.
  struct NearWall {
    float nx, ny, rho, ax, ay, tx, ty, length;
  };
  struct NearCylinder {
    float x, y, radius, outside;  ///< outside: squared distance of the axis less the squared radius
    float top;                    ///< over the floor
  };
  struct Hit {
    float s = 0.0f;  ///< in lengths of the ray: depth along the optical axis
    int surface = 0;
    float along = 0.0f;  ///< of a wall
    float z = 0.0f;      ///< over the floor
  };

  void build_rays();
  void build_bins();
  void hang_on_walls(const RoomParameters&);
  void place(const Pose2& base_in_map);
  void fill_table();
  /// Calls `visit(bin, begin, end)` for the used bins that an interval of azimuth touches, `begin` and `end` being the
  /// azimuths between which a ray of that bin may lie.
  template <class Visit>
  void for_bins(double from, double to, Visit visit) const;
  [[nodiscard]] Ray ray(int x, int y, float dx, float dy) const;
  [[nodiscard]] std::span<const int> candidates(int x, int y) const;
  [[nodiscard]] Hit cast(const Ray&, std::span<const int> candidates) const;
  /// The point of a surface known to be met.
  [[nodiscard]] Hit meet(const Ray&, int surface) const;
  void meet_floor_or_ceiling(const Ray&, Hit& nearest) const;
  void meet_wall(const Ray&, int wall, Hit& nearest) const;
  void meet_cylinder(const Ray&, int cylinder, Hit& nearest) const;
  /// Light of a surface where a ray meets it. \param pixel size of what the ray stands for [pixels]
  [[nodiscard]] float grey(const Ray&, const Hit&, float pixel) const;
  [[nodiscard]] float plaster_at(float u, float v, float footprint) const;
  void add_pixel(int x, int y, const int* above, const int* below, float weight, float* light) const;

  models::CameraIntrinsics camera_;
  models::CameraMounting mounting_;
  int channels_;
  float ceiling_;
  float contrast_;
  Texture plaster_;
  std::vector<RoomWall> walls_;
  std::vector<Picture> pictures_;
  std::vector<Cylinder> cylinders_;
  int first_cylinder_, first_cap_, first_picture_;  ///< surfaces: floor, ceiling, walls, cylinders, caps, pictures
  std::vector<std::array<float, 3>> tints_;         ///< of each surface, a factor for each channel

  std::vector<Ray> rays_;          ///< through the corners between pixels, (width + 1) x (height + 1)
  std::vector<std::int32_t> bin_;  ///< azimuth of each pixel; the last bin stands for all surfaces
  std::vector<bool> bin_used_;
  int bins_ = 0;

  // Of the pose that is drawn.
  Vector2 eye_ = Vector2::Zero();  ///< map frame
  float eye_height_ = 0.0f;
  Matrix2 base_to_map_ = Matrix2::Identity();
  std::vector<NearWall> near_walls_;
  std::vector<NearCylinder> near_cylinders_;
  std::vector<std::vector<int>> table_;  ///< upright surfaces that a ray of each bin may meet
};

}  // namespace noctule::sim
