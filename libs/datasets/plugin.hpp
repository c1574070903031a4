#pragma once
/// Libraries that are dear to load, and are only when they are needed.
#include <string>

namespace noctule::datasets {

/// The symbol of a plug-in beside the executable (build tree, installation), else wherever the loader looks.
/// \param user what needs it, as it begins the message \throws InputError where it cannot be loaded
[[nodiscard]] const void* plugin_symbol(const std::string& user, const std::string& library, const char* symbol);

}  // namespace noctule::datasets
