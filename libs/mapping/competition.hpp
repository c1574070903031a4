#pragma once
/// Walls, cylinders and points compete to explain echoes.
#include <optional>
#include <vector>

#include "core/contour.hpp"
#include "mapping/mapper_parameters.hpp"

namespace noctule::mapping {

/// An object of the map and what speaks for it.
struct Object {
  EchoFit fit;
  std::vector<int> members;  ///< arcs it explains
  double gain = 0.0;         ///< sum over arcs of the log likelihood ratio to the best other explanation
  int stops = 0;
  double span = 0.0;   ///< [m], see SupportParameters
  double begin = 0.0;  ///< of a wall, along its tangent [m]
  double end = 0.0;
  double viewing_angle = 0.0;  ///< of a cylinder or point [rad]
};

/// The set of objects that best explains a set of arcs.
///
/// Every echo is explained by one object or by clutter: a Student-t of its range about the object's, a Gaussian of the
/// direction about the axis of the cone (sd half of half_angle, as transducers hear), or a uniform density. Objects
/// are proposed by the peaks of the Hough accumulators and refined on the echoes; the one that raises the likelihood
/// most, beyond what the objects before it explain, is taken; its echoes leave the accumulators; and so on (`grow`).
/// Then all objects share out all echoes anew, are refitted, merged where solids would overlap, and dropped where too
/// little is left to them (`settle`).
///
/// An echo heard from behind an object contradicts it (the first echo counts): what is contradicted too often is
/// refused. That, and the points among the rivals, keep corners from becoming false walls.
class Competition {
 public:
  Competition(const MapperParameters& parameters, const Extent& extent);

  void add(const SonarArc& arc);
  void grow();
  void settle();

  [[nodiscard]] const std::vector<SonarArc>& arcs() const { return arcs_; }
  [[nodiscard]] const std::vector<Object>& objects() const { return objects_; }
  [[nodiscard]] ContourMap map() const;

 private:
  struct Blocked {
    std::vector<Wall> walls;
    std::vector<Cylinder> cylinders;
  };
  [[nodiscard]] double log_likelihood(const EchoFit& fit, const SonarArc& arc) const;
  [[nodiscard]] double log_likelihood(const EchoFit& fit, std::span<const int> members) const;
  [[nodiscard]] std::optional<Object> best_wall(Blocked& blocked);
  [[nodiscard]] std::optional<Object> best_cylinder(Blocked& blocked);
  [[nodiscard]] std::optional<Object> refined(const Reflector& start) const;
  [[nodiscard]] std::optional<Object> refined_round(const Cylinder& start) const;
  [[nodiscard]] EchoFit simplest(const EchoFit& fit, std::span<const int> members) const;
  [[nodiscard]] std::vector<int> supporters(const EchoFit& fit, double window) const;
  void measure(Object& object) const;
  [[nodiscard]] bool supported(const Object& object) const;
  [[nodiscard]] bool still_worth(Object& object) const;
  void accept(Object object);
  void share_out();
  [[nodiscard]] bool overlap(const Object& a, const Object& b) const;
  bool merge_overlapping();
  bool drop_weakest();

  MapperParameters parameters_;
  double log_clutter_;
  std::vector<SonarArc> arcs_;
  std::vector<double> explained_;  // log likelihood of the best explanation so far
  std::vector<int> owner_;
  std::vector<char> voted_;
  std::vector<Object> objects_;
  LineVotes lines_;
  CircleVotes circles_;
};

}  // namespace noctule::mapping
