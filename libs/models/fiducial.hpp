#pragma once
/// Square fiducial markers of the ArUco dictionary 4x4_50 (Garrido-Jurado et al., Pattern Recognition 47, 2014), as
/// OpenCV prints and finds them.
#include "core/image.hpp"

namespace noctule::models {

inline constexpr int kFiducials = 50;      ///< markers in the dictionary
inline constexpr int kFiducialCells = 6;   ///< of the black square along a side: 4 and the border
inline constexpr int kFiducialMargin = 1;  ///< cells of white around it

/// The marker with its white margin, `pixels_per_cell` for each of its 8 x 8 cells; grey.
/// \param marker 0 to kFiducials - 1 \throws std::out_of_range for another
[[nodiscard]] Image fiducial_picture(int marker, int pixels_per_cell);

}  // namespace noctule::models
