#pragma once
#include <filesystem>
#include <string>

namespace noctule::datasets {

struct FileContent {
  std::string bytes;
  bool cut_off = false;  ///< a gzip file that ends too early: `bytes` is what could be unpacked
};

/// A whole file, unpacked if it is gzip'ed. `archive.zip/member` is a member of that archive.
/// \throws InputError when it cannot be read or its compressed bytes are damaged
[[nodiscard]] FileContent read_file(const std::filesystem::path& path);

}  // namespace noctule::datasets
