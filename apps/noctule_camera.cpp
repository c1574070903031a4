/// The landmark detectors as a process: CAMERA_IMAGE -> LANDMARK_DETECTIONS.
#include "apps/common/single_module.hpp"
#include "core/error.hpp"
#include "modules/camera_module.hpp"

int main(int argc, char** argv) {
  using namespace noctule;
  const apps::Program program{.name = "noctule-camera", .description = "Finds landmarks in the images of a camera."};
  return apps::run_single_module(
      argc, argv, program,
      [](bus::Bus& bus, const modules::PipelineParameters& parameters, const apps::CommandLine& line) {
        if (!parameters.camera) throw InputError(line.file + ": expected a section 'camera'");
        return std::make_unique<modules::CameraModule>(bus, *parameters.camera);
      });
}
