#pragma once
/// Figures printed by Yuan et al. (Chinese Journal of Scientific Instrument 2021, 10.19650/j.cnki.cjsi.J2108489),
/// section 2.3: a room of seven walls and two cylinders heard by an HC-SR04 on a small robot.
#include <string>
#include <vector>

#include "core/contour.hpp"

namespace noctule::eval {

/// The room: true values of tables 3 and 4; the walls' ends follow from their neighbours. Robot at the origin, 60 cm
/// from walls 1 and 7. Frame of the tables.
[[nodiscard]] const Room& published_room();

/// One method's columns of tables 3 and 4, as printed.
struct PublishedContours {
  std::string method;
  ContourMap map;  ///< walls and cylinders in the order of the room, without covariances
};
/// PF-SLAM, VB-PF-SLAM and VB-APF-SLAM.
[[nodiscard]] const std::vector<PublishedContours>& published_contours();

/// What a reader of these figures must know: one theta that is almost surely a misprint, and the reductions claimed in
/// the text that the printed values do not give.
[[nodiscard]] const std::string& published_contours_note();

/// The same walls and cylinders, in the same order, up to `tolerance` [m, rad]: only then may figures stand side by
/// side.
[[nodiscard]] bool same_contours(const Room&, const Room&, double tolerance = 1e-4);

}  // namespace noctule::eval
