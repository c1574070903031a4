#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/source.hpp"
#include "modules/pipeline_parameters.hpp"
#include "modules/source_module.hpp"

namespace noctule::modules {

/// A source on the bus and what is known of its world.
struct SourceAndWorld {
  std::unique_ptr<SourceModule> module;
  KnownWorld world;
  std::vector<std::string> notes;  ///< what the reader left out or repaired
};

/// The source of a pipeline file.
/// \throws InputError when the recording cannot be opened or read
[[nodiscard]] SourceAndWorld make_source(bus::Bus& bus, const PipelineParameters& pipeline);

/// What make_source() would know, for modules that run apart from the source.
[[nodiscard]] KnownWorld known_world(const SourceParameters& parameters);

}  // namespace noctule::modules
