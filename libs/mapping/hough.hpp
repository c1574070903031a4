#pragma once
/// The Hough transform for one kind of object at a time. Where walls, cylinders and corners are mixed, use
/// map_contours (mapping/contour_mapper.hpp), in which they compete.
#include <span>
#include <vector>

#include "core/contour.hpp"
#include "mapping/line_fit.hpp"
#include "mapping/mapper_parameters.hpp"

namespace noctule::mapping {

/// Greedy extraction: the highest peak is refined on its inliers, they leave the accumulator, and so on until no peak
/// has the support of `SupportParameters`. Map frame. Points know of no stops, so `min_stops` does not apply to them
/// and `stops` is 0; their inliers lie within 3 standard deviations.
[[nodiscard]] std::vector<WallEstimate> hough_lines(std::span<const SonarArc> arcs, const MapperParameters& parameters);
[[nodiscard]] std::vector<WallEstimate> hough_lines(std::span<const PointWithCovariance> points,
                                                    const MapperParameters& parameters);

/// The same for cylinders of min_radius to max_radius that were seen over at least 2 rad: less does not fix a radius.
[[nodiscard]] std::vector<CylinderEstimate> hough_circles(std::span<const SonarArc> arcs,
                                                          const MapperParameters& parameters);
[[nodiscard]] std::vector<CylinderEstimate> hough_circles(std::span<const PointWithCovariance> points,
                                                          const MapperParameters& parameters);

}  // namespace noctule::mapping
