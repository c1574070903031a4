#include "report/files.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "core/error.hpp"
#include "report/results.hpp"

namespace noctule::report {
namespace fs = std::filesystem;
namespace {

/// Of this process: others may write the same file, on other machines too.
const std::string& unique_suffix() {
  static const std::string suffix = [] {
    std::random_device device;
    return "." + std::to_string(device()) + std::to_string(device()) + ".partial";
  }();
  return suffix;
}

}  // namespace

void write_file(const fs::path& path, std::string_view content) {
  const fs::path partial = path.parent_path() / ("." + path.filename().string() + unique_suffix());
  errno = 0;
  std::ofstream file(partial, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  std::error_code error(errno, std::generic_category());
  if (file) fs::rename(partial, path, error = {});
  if (!file || error) {
    std::error_code ignored;
    fs::remove(partial, ignored);
    throw InputError(path.string() + ": expected a file that can be written, got: " +
                     (error ? error.message() : std::string("write error")));
  }
}

std::string read_file(const fs::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), {}};
  if (!file) {
    throw InputError(path.string() +
                     ": expected a file that can be read, got: " + std::strerror(errno != 0 ? errno : EIO));
  }
  return content;
}

void prepare_results(const fs::path& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error || !fs::is_directory(dir)) {
    throw InputError(dir.string() + ": expected a folder for the results, got: " +
                     (error ? error.message() : std::string("not a folder")));
  }
  const fs::path probe = dir / ".writable";
  errno = 0;
  if (!std::ofstream(probe)) {
    throw InputError(dir.string() + ": expected a folder that can be written, got: " + std::strerror(errno));
  }
  fs::remove(probe, error);
}

}  // namespace noctule::report
