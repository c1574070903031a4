#include "modules/rawlog_module.hpp"

#include "modules/names.hpp"
#include "noctule/landmark_detections.hpp"
#include "noctule/odometry.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::modules {

RawlogModule::RawlogModule(bus::Bus& bus, const std::filesystem::path& file) : Module(bus, "rawlog"), writer_(file) {
  listen<odometry>(bus::channel::kOdometry, [this](const Odometry& o) { writer_.write(o); });
  listen<ultrasonic_scan>(bus::channel::kUltrasonicScan, [this](const UltrasonicScan& s) { writer_.write(s); });
  listen<landmark_detections>(bus::channel::kLandmarkDetections,
                              [this](const LandmarkDetections& d) { writer_.write(d); });
  finish_after({name::kSource});
}

}  // namespace noctule::modules
