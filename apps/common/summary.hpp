#pragma once
#include <ostream>
#include <string>

#include "report/run_data.hpp"

namespace noctule::apps {

/// The main figures of a run for the terminal, in centimetres and degrees.
void print_summary(std::ostream& out, const report::RunData& data, const std::string& folder);

}  // namespace noctule::apps
