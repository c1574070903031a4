#include "datasets/mat_file.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "core/error.hpp"
#include "datasets/file_content.hpp"

namespace noctule::datasets {
namespace {

// Types of data elements ("MAT-File Format", The MathWorks, table 1-1).
enum Type : std::uint32_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kSingle = 7,
  kDouble = 9,
  kMatrix = 14,
  kCompressed = 15
};
constexpr std::size_t kHeader = 128;

struct Element {
  std::uint32_t type = 0;
  std::string_view data;
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::filesystem::path& path) : rest_(bytes), path_(path) {}

  [[nodiscard]] bool done() const { return rest_.empty(); }
  [[nodiscard]] Element next() {
    const std::uint32_t tag = word(0);
    if (const std::uint32_t size = tag >> 16; size != 0) {  // a small element: four bytes at most, in the tag itself
      if (size > 4) refuse("a data element", "a damaged one");
      static_cast<void>(word(4));  // is there
      const Element element{tag & 0xFFFF, rest_.substr(4, size)};
      rest_.remove_prefix(8);
      return element;
    }
    const std::size_t size = word(4);
    if (size > rest_.size() - 8) refuse("the whole file", "one that was cut off");
    const Element element{tag, rest_.substr(8, size)};
    const std::size_t padded = tag == kCompressed ? size : (size + 7) / 8 * 8;
    rest_.remove_prefix(std::min(rest_.size(), 8 + padded));
    return element;
  }
  [[noreturn]] void refuse(const std::string& expected, const std::string& got) const {
    throw InputError(path_.string() + ": expected " + expected + ", got " + got);
  }

 private:
  [[nodiscard]] std::uint32_t word(std::size_t at) const {
    if (rest_.size() < at + 4) refuse("the whole file", "one that was cut off");
    std::uint32_t value = 0;
    std::memcpy(&value, rest_.data() + at, 4);
    return value;
  }

  std::string_view rest_;
  const std::filesystem::path& path_;
};

template <class T>
std::vector<double> as_doubles(std::string_view data) {
  std::vector<double> values(data.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value{};
    std::memcpy(&value, data.data() + i * sizeof(T), sizeof(T));
    values[i] = static_cast<double>(value);
  }
  return values;
}

std::vector<double> numbers(const Element& e, const Reader& reader) {
  switch (e.type) {
    case kInt8:
      return as_doubles<std::int8_t>(e.data);
    case kUint8:
      return as_doubles<std::uint8_t>(e.data);
    case kInt16:
      return as_doubles<std::int16_t>(e.data);
    case kUint16:
      return as_doubles<std::uint16_t>(e.data);
    case kInt32:
      return as_doubles<std::int32_t>(e.data);
    case kUint32:
      return as_doubles<std::uint32_t>(e.data);
    case kSingle:
      return as_doubles<float>(e.data);
    case kDouble:
      return as_doubles<double>(e.data);
    default:
      reader.refuse("an array of numbers", "data of type " + std::to_string(e.type));
  }
}

}  // namespace

std::map<std::string, std::vector<double>> read_mat(const std::filesystem::path& path) {
  const FileContent content = read_file(path);
  const std::string_view bytes = content.bytes;
  Reader file(bytes.size() > kHeader ? bytes.substr(kHeader) : std::string_view{}, path);
  if (bytes.size() <= kHeader || !bytes.starts_with("MATLAB 5.0 MAT-file") || bytes.substr(126, 2) != "IM") {
    file.refuse("a MATLAB 5.0 MAT-file, little-endian", "something else");
  }
  std::map<std::string, std::vector<double>> arrays;
  while (!file.done()) {
    const Element element = file.next();
    if (element.type == kCompressed) file.refuse("arrays that are not compressed", "a compressed one");
    if (element.type != kMatrix) continue;
    Reader parts(element.data, path);
    const Element flags = parts.next();
    if (flags.data.size() < 8) parts.refuse("an array", "a damaged one");
    const auto kind = static_cast<unsigned char>(flags.data[0]);
    static_cast<void>(parts.next());  // dimensions
    const Element name = parts.next();
    constexpr unsigned char kFirstNumeric = 6, kLastNumeric = 13;
    if (kind < kFirstNumeric || kind > kLastNumeric) continue;
    std::vector<double>& values = arrays[std::string(name.data)] = numbers(parts.next(), parts);
    for (const double v : values) {
      if (!std::isfinite(v)) parts.refuse(std::string(name.data) + ": finite numbers", std::to_string(v));
    }
  }
  return arrays;
}

}  // namespace noctule::datasets
