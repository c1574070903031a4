#pragma once
#include <string>

#include "datasets/rawlog.hpp"

namespace noctule::datasets {

/// See RawlogPlugin::read and RawlogSource.
void read_rawlog(const RawlogParameters& parameters, const std::string& bytes, Recording& recording);

}  // namespace noctule::datasets
