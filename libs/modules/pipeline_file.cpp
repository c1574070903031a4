#include "modules/pipeline_file.hpp"

#include "config/config.hpp"

namespace noctule::modules {

PipelineParameters load_pipeline(const std::filesystem::path& file, std::span<const std::string> assignments) {
  return config::load<PipelineParameters>(file, assignments);
}

std::string dump_pipeline(const PipelineParameters& parameters) {
  return config::dump(parameters);
}

std::string pipeline_reference() {
  return config::reference<PipelineParameters>();
}

}  // namespace noctule::modules
