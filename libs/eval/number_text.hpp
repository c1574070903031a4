#pragma once
#include <string>

namespace noctule::eval {

/// The shortest text that reads back as the same double, with a point whatever the locale; "nan", "inf", "-inf".
[[nodiscard]] std::string shortest(double value);

}  // namespace noctule::eval
