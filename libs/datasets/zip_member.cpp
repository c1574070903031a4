#include "datasets/zip_member.hpp"

#include <zlib.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>

#include "core/error.hpp"

namespace noctule::datasets {
namespace {

// Records of the format (PKWARE APPNOTE 6.3): where the fields lie that are needed here.
constexpr std::string_view kLocal = "PK\3\4", kEntry = "PK\1\2", kEnd = "PK\5\6";
constexpr std::size_t kLocalSize = 30, kEntrySize = 46, kEndSize = 22;

class Archive {
 public:
  explicit Archive(const std::filesystem::path& path) : path_(path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw InputError(path.string() + ": expected a readable zip archive, got none");
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
  }

  [[nodiscard]] std::string member(const std::string& name) const {
    const std::size_t end = bytes_.rfind(kEnd);
    if (end == bytes_.npos || end + kEndSize > bytes_.size()) refuse("a zip archive", "no end of its directory");
    std::size_t at = number(end + 16, 4);
    for (std::size_t entries = number(end + 10, 2); entries > 0; --entries) {
      require(at, kEntrySize, kEntry);
      const std::size_t length = number(at + 28, 2);
      require(at + kEntrySize, length, {});
      if (std::string_view(bytes_).substr(at + kEntrySize, length) == name) return unpacked(at, name);
      at += kEntrySize + length + number(at + 30, 2) + number(at + 32, 2);
    }
    refuse("a member " + name, "none");
  }

 private:
  [[noreturn]] void refuse(const std::string& expected, const std::string& got) const {
    throw InputError(path_.string() + ": expected " + expected + ", got " + got);
  }
  void require(std::size_t at, std::size_t size, std::string_view signature) const {
    const bool inside = at <= bytes_.size() && size <= bytes_.size() - at;
    if (!inside || bytes_.compare(at, signature.size(), signature) != 0) refuse("a zip archive", "a damaged one");
  }
  /// Little-endian.
  [[nodiscard]] std::size_t number(std::size_t at, std::size_t size) const {
    std::size_t value = 0;
    for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes_[at + i]);
    return value;
  }

  /// \param entry the member's record in the directory
  [[nodiscard]] std::string unpacked(std::size_t entry, const std::string& name) const {
    const std::size_t method = number(entry + 10, 2), packed = number(entry + 20, 4), size = number(entry + 24, 4);
    const std::size_t local = number(entry + 42, 4);
    require(local, kLocalSize, kLocal);
    const std::size_t begin = local + kLocalSize + number(local + 26, 2) + number(local + 28, 2);
    require(begin, packed, {});
    if ((number(entry + 8, 2) & 1) != 0 || (method != 0 && method != 8)) {
      refuse(name + " stored or deflated", "method " + std::to_string(method) + " or encryption");
    }
    if (method == 0) return bytes_.substr(begin, packed);
    if (size / 1032 > packed) refuse(name + " whole", "an impossible size");  // deflate packs no tighter
    std::string out(size, '\0');
    z_stream stream{};
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes_.data() + begin));  // zlib's way of const
    stream.avail_in = static_cast<uInt>(packed);
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(size);
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) refuse(name + " whole", "no memory to unpack it");
    const int code = inflate(&stream, Z_FINISH);
    inflateEnd(&stream);
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(out.data()), static_cast<uInt>(out.size()));
    if (code != Z_STREAM_END || stream.total_out != size || sum != number(entry + 16, 4)) {
      refuse(name + " whole", "a damaged one");
    }
    return out;
  }

  std::filesystem::path path_;
  std::string bytes_;
};

}  // namespace

std::string read_zip_member(const std::filesystem::path& archive, const std::string& member) {
  return Archive(archive).member(member);
}

}  // namespace noctule::datasets
