#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace noctule::datasets {

/// The real numeric arrays of a MATLAB level 5 file by name, column by column. Little-endian and not compressed, as
/// MATLAB wrote them up to version 6; whatever else the file holds is passed over.
/// \throws InputError naming the file: not such a file, cut off, a number that is not finite
[[nodiscard]] std::map<std::string, std::vector<double>> read_mat(const std::filesystem::path& path);

}  // namespace noctule::datasets
