#include "modules/filter_state.hpp"

#include <array>

#include "config/config.hpp"
#include "core/error.hpp"
#include "report/files.hpp"

namespace noctule::modules {
namespace {

constexpr std::string_view kMagic = "noctule filter state\n";
constexpr std::uint32_t kVersion = 1, kByteOrder = 0x01020304;

std::uint64_t crc64(std::string_view bytes) {
  static const auto table = [] {
    std::array<std::uint64_t, 256> t{};
    for (std::uint64_t i = 0; i < t.size(); ++i) {
      t[i] = i;
      for (int bit = 0; bit < 8; ++bit) t[i] = (t[i] >> 1) ^ ((t[i] & 1) != 0 ? 0xC96C5795D7870F42u : 0u);
    }
    return t;
  }();
  std::uint64_t crc = ~std::uint64_t{0};
  for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xff] ^ (crc >> 8);
  return ~crc;
}

struct Choice {
  filters::SlamFilterParameters filter;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.one_of("filter", &Choice::filter, filters::kSlamFilterNames, "the filter");
  }
};

struct Header {
  std::vector<char> parameters;  ///< YAML
  std::uint64_t seed = 0;
  std::int64_t utime = 0;
  LandmarkMap map;

  void transfer(StateArchive& archive) {
    archive(parameters, seed, utime, map.stamp);
    archive.each(map.landmarks, LandmarkEstimate{},
                 [&](LandmarkEstimate& e) { archive(e.id, e.kind, e.parameters, e.covariance, e.observations); });
  }
};

std::vector<char> text_of(const filters::SlamFilterParameters& parameters) {
  const std::string text = config::dump(Choice{parameters});
  return {text.begin(), text.end()};
}

/// The first line that differs.
std::string difference(const std::vector<char>& expected, const std::vector<char>& got) {
  const auto line = [](const std::vector<char>& text, std::size_t at) {
    std::size_t begin = std::min(at, text.size()), end = begin;
    while (begin > 0 && text[begin - 1] != '\n') --begin;
    while (end < text.size() && text[end] != '\n') ++end;
    const std::string all(text.begin() + static_cast<std::ptrdiff_t>(begin),
                          text.begin() + static_cast<std::ptrdiff_t>(end));
    const std::string value = all.substr(0, all.find('#'));
    const std::size_t first = value.find_first_not_of(' '), last = value.find_last_not_of(' ');
    return first == std::string::npos ? std::string("nothing") : "'" + value.substr(first, last - first + 1) + "'";
  };
  std::size_t at = 0;
  while (at < expected.size() && at < got.size() && expected[at] == got[at]) ++at;
  return "expected the state of a filter with " + line(expected, at) + ", got one with " + line(got, at);
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what);
}

/// The archive stands behind magic, version and byte order; the sum is checked.
StateArchive open(const std::filesystem::path& file, const std::string& content) {
  if (!content.starts_with(kMagic)) refuse(file, "expected a filter state of noctule, got another kind of file");
  const std::size_t head = kMagic.size() + 2 * sizeof(std::uint32_t), tail = sizeof(std::uint64_t);
  if (content.size() < head + tail) refuse(file, "expected a whole filter state, got a truncated one");
  StateArchive front{std::span<const char>(content).subspan(kMagic.size(), head - kMagic.size())};
  std::uint32_t version = 0, byte_order = 0;
  front(version, byte_order);
  if (version != kVersion || byte_order != kByteOrder) {
    refuse(file, "expected a filter state of version " + std::to_string(kVersion) + ", got version " +
                     std::to_string(version) + (byte_order == kByteOrder ? "" : " of a machine of other byte order"));
  }
  StateArchive back{std::span<const char>(content).last(tail)};
  std::uint64_t sum = 0;
  back(sum);
  if (sum != crc64(std::string_view(content).substr(0, content.size() - tail))) {
    refuse(file, "expected a whole filter state, got one that is truncated or damaged (checksum)");
  }
  return StateArchive{std::span<const char>(content).subspan(head, content.size() - head - tail)};
}

}  // namespace

void save_filter_state(const std::filesystem::path& file, filters::SlamFilter& filter, const FilterIdentity& identity,
                       std::int64_t utime) {
  StateArchive archive;
  std::uint32_t version = kVersion, byte_order = kByteOrder;
  Header header{text_of(identity.parameters), identity.seed, utime, filter.map()};
  archive(version, byte_order, header);
  filter.transfer(archive);
  std::string content = std::string(kMagic) + archive.bytes();
  StateArchive sum;
  std::uint64_t crc = crc64(content);
  sum(crc);
  report::write_file(file, content + sum.bytes());
}

std::int64_t load_filter_state(const std::filesystem::path& file, filters::SlamFilter& filter,
                               const FilterIdentity& identity) {
  const std::string content = report::read_file(file);
  StateArchive archive = open(file, content);
  try {
    Header header;
    archive(header);
    const std::vector<char> expected = text_of(identity.parameters);
    if (header.parameters != expected) throw InputError(difference(expected, header.parameters));
    if (header.seed != identity.seed) {
      throw InputError("expected the state of a filter with seed " + std::to_string(identity.seed) +
                       ", got one with seed " + std::to_string(header.seed));
    }
    filter.transfer(archive);
    archive.expect_end();
    return header.utime;
  } catch (const InputError& e) {
    refuse(file, e.what());
  }
}

LandmarkMap load_state_map(const std::filesystem::path& file) {
  const std::string content = report::read_file(file);
  StateArchive archive = open(file, content);
  Header header;
  archive(header);
  return header.map;
}

}  // namespace noctule::modules
