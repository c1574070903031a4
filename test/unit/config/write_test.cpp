/// What is written is read back to the same bits.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "config/config.hpp"
#include "config/number.hpp"
#include "core/angles.hpp"
#include "core/rng.hpp"

namespace noctule::config {
namespace {

enum class Mode { slow, fast };

struct Item {
  std::string name;
  double angle = 0.0;
  friend bool operator==(const Item&, const Item&) = default;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &Item::name, "its name");
    v.field("angle_deg", &Item::angle, unit::degree, "an angle");
  }
};

struct Length {
  double value = 0.0;
  friend bool operator==(const Length&, const Length&) = default;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("value_m", &Length::value, unit::metre, "a length");
  }
};

struct Everything {
  bool flag = false;
  int count = 1;
  std::int64_t big = 0;
  std::uint64_t seed = 0;
  double length = 0.0;
  double angle = 0.0;
  std::string text;
  Mode mode = Mode::slow;
  Pose2 pose;
  Vector2 point = Vector2::Zero();
  std::vector<double> angles;
  std::vector<Vector2> points;
  std::vector<std::string> names;
  std::vector<Item> items;
  Item one;
  std::optional<Item> maybe;
  std::variant<Item, Length> either;
  friend bool operator==(const Everything&, const Everything&) = default;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("flag", &Everything::flag, "a switch");
    v.field("count", &Everything::count, unit::one, "a count", at_least(0));
    v.field("big", &Everything::big, unit::one, "a long number");
    v.field("seed", &Everything::seed, unit::one, "a seed");
    v.field("length_cm", &Everything::length, unit::centimetre, "a length");
    v.field("angle_deg", &Everything::angle, unit::degree, "an angle");
    v.field("text", &Everything::text, "a text");
    v.choice("mode", &Everything::mode, {{"slow", Mode::slow}, {"fast", Mode::fast}}, "a mode");
    v.field("pose_cm_deg", &Everything::pose, unit::centimetre_degree, "a pose");
    v.field("point_cm", &Everything::point, unit::centimetre, "a point");
    v.field("angles_deg", &Everything::angles, unit::degree, "angles");
    v.field("points_m", &Everything::points, unit::metre, "points");
    v.field("names", &Everything::names, "texts");
    v.list("items", &Everything::items, "items");
    v.group("one", &Everything::one, "one item");
    v.group("maybe", &Everything::maybe, "an item or none");
    v.one_of("either", &Everything::either, {"item", "length"}, "an item or a length");
  }
};

/// Any finite double: of every magnitude, with an even spread of bits.
double any_double(Rng& rng) {
  for (;;) {
    const auto value = std::bit_cast<double>(rng());
    if (std::isfinite(value) && std::abs(value) > 1e-290 && std::abs(value) < 1e290) return value;
  }
}
std::string any_text(Rng& rng) {
  std::string text;
  const std::uint64_t length = rng.index(12);
  for (std::uint64_t i = 0; i < length; ++i) text += static_cast<char>(1 + rng.index(127));
  return text;
}
Item any_item(Rng& rng) {
  return {any_text(rng), any_double(rng)};
}

Everything any_value(std::uint64_t seed) {
  Rng rng(seed, stream_id("config.round_trip"));
  Everything e;
  e.flag = rng.index(2) == 1;
  e.count = static_cast<int>(rng.index(1000000));
  e.big = static_cast<std::int64_t>(rng());
  e.seed = rng();
  e.length = any_double(rng);
  e.angle = any_double(rng);
  e.text = any_text(rng);
  e.mode = rng.index(2) == 1 ? Mode::fast : Mode::slow;
  e.pose = {any_double(rng), rng.normal(), rng.uniform(-kPi, kPi)};
  e.point = {rng.normal(), any_double(rng)};
  for (std::uint64_t i = rng.index(4); i > 0; --i) e.angles.push_back(rng.uniform(-kPi, kPi));
  for (std::uint64_t i = rng.index(4); i > 0; --i) e.points.emplace_back(rng.normal(), any_double(rng));
  for (std::uint64_t i = rng.index(4); i > 0; --i) e.names.push_back(any_text(rng));
  for (std::uint64_t i = rng.index(4); i > 0; --i) e.items.push_back(any_item(rng));
  e.one = any_item(rng);
  if (rng.index(2) == 1) e.maybe = any_item(rng);
  if (rng.index(2) == 1) e.either = Length{any_double(rng)};
  return e;
}

TEST(Write, LoadOfDumpHasTheSameBits) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const Everything value = any_value(seed);
    const std::string text = dump(value);
    ASSERT_EQ(parse<Everything>(text), value) << text;
    ASSERT_EQ(dump(parse<Everything>(text)), text);
  }
}

/// Takes a value as it stands, for a reader that comes later.
struct Deferred {
  Tree value;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("value", &Deferred::value, "anything");
  }
};

TEST(Write, TreesCarryEveryValueToALaterReader) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Everything value = any_value(seed);
    const std::string text = dump(Deferred{parse_tree(dump(value), "text")});
    const auto again = parse<Deferred>(text);
    ASSERT_EQ(load<Everything>(again.value), value) << text;
    ASSERT_EQ(dump(again), text);
  }
  EXPECT_EQ(dump(Deferred{}), "value: null  # anything\n");
}

TEST(Write, TreesKeepTextsInQuotesApartFromNumbersAndSwitches) {
  const std::string text = "value:  # anything\n  a: \"1\"\n  b: 1\n  c: \"true\"\n  d: true\n  e: [a, \"b c\", {}]\n";
  EXPECT_EQ(dump(parse<Deferred>(text)), text);
}

TEST(Write, TreesAreOverriddenInPlace) {
  const std::vector<std::string> assignments{"count=5", "items[0].name=x"};
  const Tree tree = parse_tree("{count: 1, items: [{name: a}]}", "text");
  const auto value = load<Everything>(override_tree(tree, assignments));
  EXPECT_EQ(value.count, 5);
  EXPECT_EQ(value.items.at(0).name, "x");
}

TEST(Write, EveryDoubleSurvivesEveryUnit) {
  Rng rng(1, stream_id("config.numbers"));
  for (const double to_si : {1.0, 0.01, 0.001, unit::degree.to_si}) {
    for (int i = 0; i < 20000; ++i) {
      const double si = i % 2 == 0 ? any_double(rng) : rng.uniform(-10.0, 10.0);
      const std::string text = print_number(si, to_si);
      ASSERT_EQ(std::bit_cast<std::uint64_t>(parse_number(text, to_si).value().si), std::bit_cast<std::uint64_t>(si))
          << text << " with unit " << to_si;
    }
  }
}

TEST(Write, RoundNumbersLookRound) {
  EXPECT_EQ(print_number(0.003, 0.01), "0.3");
  EXPECT_EQ(print_number(radians(1.5), unit::degree.to_si), "1.5");
  EXPECT_EQ(print_number(radians(0.7), unit::degree.to_si), "0.7");
  EXPECT_EQ(print_number(-0.0, 1.0), "-0");
  EXPECT_EQ(print_number(1e300, 1.0), "1e+300");
}

struct Documented {
  double turn = radians(1.5);
  Mode mode = Mode::fast;
  Item item{"a", 0.0};
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("turn_deg", &Documented::turn, unit::degree, "error of one turn", at_least(0.0));
    v.choice("mode", &Documented::mode, {{"slow", Mode::slow}, {"fast", Mode::fast}}, "how");
    v.group("item", &Documented::item, "what");
  }
};

TEST(Write, SaysUnitRangeAndMeaning) {
  EXPECT_EQ(dump(Documented{}),
            "turn_deg: 1.5  # error of one turn [deg]; >= 0\n"
            "mode: fast  # how; one of slow, fast\n"
            "item:  # what\n"
            "  name: a  # its name\n"
            "  angle_deg: 0  # an angle [deg]\n");
}

TEST(Write, TextsThatLookLikeSomethingElseStayTexts) {
  for (const char* text :
       {"",   "null", "~",  "true", "5", "- a", "a: b", "#x",   " a", "a ",          "a\nb", "\"", "\\",
        "*a", "&a",   "!a", "%a",   "{", "---", "...",  "\x01", "\t", "caf\xc3\xa9", "<<",   "=",  "nan"}) {
    Item item{text, 0.0};
    EXPECT_EQ(parse<Item>(dump(item)).name, text) << dump(item);
  }
}

TEST(Reference, ListsEveryKeyOnce) {
  const std::string table = reference<Everything>();
  EXPECT_NE(table.find("| `count` |  | `1` | >= 0 | a count |"), std::string::npos) << table;
  EXPECT_NE(table.find("| `mode` |  | `slow` | one of slow, fast | a mode |"), std::string::npos);
  EXPECT_NE(table.find("| `items[].angle_deg` | deg | `0` |  | an angle |"), std::string::npos);
  EXPECT_NE(table.find("| `maybe.name` |"), std::string::npos);
  EXPECT_NE(table.find("| `either<length>.value_m` | m | `0` |"), std::string::npos);
}

}  // namespace
}  // namespace noctule::config
