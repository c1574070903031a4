#pragma once
#include <string>

#include "datasets/rawlog.hpp"

namespace mrpt::obs {
class CObservation2DRangeScan;
}

namespace noctule::datasets {

/// The scan of the virtual ring, without its stamp: for each cone the nearest valid laser return inside it.
/// \param place of the laser scan, for messages
/// \throws InputError for a scanner that is not level, a cone that is not wholly inside its field or holds no laser
/// beam
[[nodiscard]] UltrasonicScan virtual_scan(const mrpt::obs::CObservation2DRangeScan& laser, const VirtualRing& ring,
                                          const std::string& place);

}  // namespace noctule::datasets
