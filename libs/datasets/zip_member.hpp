#pragma once
#include <filesystem>
#include <string>

namespace noctule::datasets {

/// The bytes of one file in a zip archive (stored or deflated; no encryption, no zip64).
/// \throws InputError naming archive and member: unreadable or damaged archive, no such member
[[nodiscard]] std::string read_zip_member(const std::filesystem::path& archive, const std::string& member);

}  // namespace noctule::datasets
