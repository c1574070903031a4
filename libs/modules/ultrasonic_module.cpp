#include "modules/ultrasonic_module.hpp"

#include "modules/names.hpp"
#include "noctule/contour_features.hpp"
#include "noctule/odometry.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::modules {

UltrasonicModule::UltrasonicModule(bus::Bus& bus, const sensors::ExtractorParameters& parameters)
    : Module(bus, name::kUltrasonic), extractor_(parameters) {
  listen<odometry>(bus::channel::kOdometry, [this](const Odometry& o) { extractor_.predict(o); });
  listen<ultrasonic_scan>(bus::channel::kUltrasonicScan, [this](const UltrasonicScan& scan) {
    publish_as_numbered(bus::channel::kContourFeatures, extractor_.update(scan));
  });
  finish_after({name::kSource});
}

}  // namespace noctule::modules
