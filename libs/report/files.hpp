#pragma once
#include <filesystem>
#include <string_view>

namespace noctule::report {

/// Writes under a temporary name beside `path` and renames, so that a reader never sees half a file,
/// whoever else writes the same.
/// \throws InputError naming the file and the reason
void write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace noctule::report
