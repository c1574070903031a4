#pragma once
#include <string>

#include "report/run_data.hpp"

namespace noctule::report {

/// report.html: one self-contained page for people, in centimetres and degrees.
[[nodiscard]] std::string page(const RunData& data);

}  // namespace noctule::report
