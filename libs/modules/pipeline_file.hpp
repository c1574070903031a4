#pragma once
/// Pipeline files as text. Apart from the parameters themselves, because this is dear to compile.
#include <filesystem>
#include <span>
#include <string>

#include "modules/pipeline_parameters.hpp"

namespace noctule::modules {

/// \param assignments `key.path=value`, applied on top
/// \throws InputError that lists all problems
[[nodiscard]] PipelineParameters load_pipeline(const std::filesystem::path& file,
                                               std::span<const std::string> assignments = {});
/// The effective configuration: load_pipeline() of it gives the same parameters.
[[nodiscard]] std::string dump_pipeline(const PipelineParameters& parameters);
/// A Markdown table of all keys.
[[nodiscard]] std::string pipeline_reference();

}  // namespace noctule::modules
