#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace noctule::report {

/// Writes under a temporary name beside `path` and renames, so that a reader never sees half a file,
/// whoever else writes the same.
/// \throws InputError naming the file and the reason
void write_file(const std::filesystem::path& path, std::string_view content);

/// The bytes of a file. \throws InputError naming the file and the reason
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

}  // namespace noctule::report
