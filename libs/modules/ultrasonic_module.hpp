#pragma once
#include "modules/module.hpp"
#include "sensors/ultrasonic/extractor.hpp"

namespace noctule::modules {

/// ODOMETRY, ULTRASONIC_SCAN -> CONTOUR_FEATURES, one for each scan and under its number.
class UltrasonicModule : public Module {
 public:
  UltrasonicModule(bus::Bus& bus, const sensors::ExtractorParameters& parameters);

 private:
  sensors::UltrasonicExtractor extractor_;
};

}  // namespace noctule::modules
