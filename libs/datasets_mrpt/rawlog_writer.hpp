#pragma once
#include <filesystem>

#include "datasets/rawlog.hpp"

namespace noctule::datasets {

/// See RawlogPlugin::create and RawlogWriter.
[[nodiscard]] RawlogSink* create_rawlog(const std::filesystem::path& path);

}  // namespace noctule::datasets
