#include "bus/channels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "bus/codec.hpp"
#include "noctule/all_types.hpp"

namespace noctule::bus {
namespace {

std::set<std::string> top_level_types() {
  std::set<std::string> names;
  std::apply([&]<class... M>(const M&...) { (names.insert(M::getTypeName()), ...); }, TopLevelTypes{});
  return names;
}

/// The first bytes after the hash are utime, seq and frame, so that any tool can sort and check messages of any type.
TEST(Channels, EveryTypeBeginsWithUtimeSeqAndFrame) {
  const auto check = []<Message M>(M message) {
    message.utime = 0x0102030405060708;
    message.seq = 0x1112131415161718;
    message.frame.assign(1, 'f');
    std::vector<std::uint8_t> bytes;
    encode(message, bytes);
    const std::vector<std::uint8_t> expected = {1,    2,    3,    4,    5,    6, 7, 8, 0x11, 0x12, 0x13,
                                                0x14, 0x15, 0x16, 0x17, 0x18, 0, 0, 0, 2,    'f',  0};
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), bytes.begin() + 8)) << M::getTypeName();
  };
  std::apply([&]<class... M>(const M&... message) { (check(message), ...); }, TopLevelTypes{});
}

TEST(Channels, EveryTypeHasAChannelAndEveryChannelAType) {
  std::set<std::string> used;
  for (const auto& [name, type] : channel::kAll) used.insert(std::string(type));
  EXPECT_EQ(used, top_level_types());
}

TEST(Channels, TheTableInTypesSaysTheSame) {
  std::ifstream in(NOCTULE_SOURCE_DIR "/types/CHANNELS.md");
  std::vector<std::string> rows;
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("| ") && std::isupper(static_cast<unsigned char>(line[2])) != 0) rows.push_back(line);
  ASSERT_EQ(rows.size(), channel::kAll.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [name, type] = channel::kAll[i];
    EXPECT_TRUE(rows[i].starts_with("| " + std::string(name) + " | " + std::string(type) + " |")) << rows[i];
  }
}

}  // namespace
}  // namespace noctule::bus
