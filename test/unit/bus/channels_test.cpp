#include "bus/channels.hpp"

#include <gtest/gtest.h>

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
  std::apply(
      [&]<class... M>(const M&...) {
        static_assert((Message<M> && ...), "every top-level type begins with utime, seq and frame");
        (names.insert(M::getTypeName()), ...);
      },
      TopLevelTypes{});
  return names;
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
