#include "datasets/file_content.hpp"

#include <zlib.h>

#include <array>
#include <cerrno>
#include <memory>
#include <system_error>

#include "core/error.hpp"
#include "datasets/zip_member.hpp"

namespace noctule::datasets {

FileContent read_file(const std::filesystem::path& path) {
  if (path.empty()) throw InputError("path: expected the path of a file, got an empty one");
  if (const auto archive = path.parent_path();
      archive.extension() == ".zip" && std::filesystem::is_regular_file(archive)) {
    return {.bytes = read_zip_member(archive, path.filename().string()), .cut_off = false};
  }
  const auto refuse = [&](const std::string& got) {
    return InputError(path.string() + ": expected a readable file, plain or gzip, got: " + got);
  };
  errno = 0;
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), &gzclose_r);
  if (!file) throw refuse(std::generic_category().message(errno));
  FileContent content;
  std::array<char, 1 << 16> block;
  for (;;) {
    const int got = gzread(file.get(), block.data(), static_cast<unsigned>(block.size()));
    if (got > 0) content.bytes.append(block.data(), static_cast<std::size_t>(got));
    if (got == static_cast<int>(block.size())) continue;
    int code = Z_OK;
    const std::string message = gzerror(file.get(), &code);
    if (code == Z_ERRNO) throw refuse(std::generic_category().message(errno));
    if (code != Z_OK && code != Z_BUF_ERROR) throw refuse(message);
    content.cut_off = code == Z_BUF_ERROR;
    return content;
  }
}

}  // namespace noctule::datasets
