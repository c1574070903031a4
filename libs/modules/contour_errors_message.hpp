#pragma once
#include "eval/contour_error.hpp"
#include "noctule/contour_errors.hpp"

namespace noctule::modules {

/// As sent on CONTOUR_ERRORS; its seq is left at 0.
[[nodiscard]] contour_errors contour_errors_message(const eval::ContourErrors& errors, std::int64_t utime);

}  // namespace noctule::modules
