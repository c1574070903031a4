/// The example configurations name every key of their filter once, in order, with the defaults of the class.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <regex>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "filters/slam/make_slam_filter.hpp"

namespace noctule::filters {
namespace {

struct Entry {
  std::string key;
  double value = 0.0;  ///< of numbers, in the unit of the file
  bool operator==(const Entry&) const = default;
};

/// Flattens a parameter struct: a group's key stands before its members, also where it may be absent.
template <class Object>
class Lister {
 public:
  Lister(const Object& object, std::vector<Entry>& entries) : object_(object), entries_(entries) {}
  template <class Class, class T>
  void field(const char* key, T Class::*member, Unit unit, const char*, Range) {
    double value = 0.0;  // of lists
    if constexpr (std::is_arithmetic_v<T>) value = static_cast<double>(object_.*member) / unit.to_si;
    entries_.push_back({key, value});
  }
  template <class Class>
  void field(const char* key, bool Class::*, const char*) {
    entries_.push_back({key, 0.0});
  }
  template <class Class, class Enum>
  void choice(const char* key, Enum Class::*, const Choices<Enum>&, const char*) {
    entries_.push_back({key, 0.0});
  }
  template <class Class, class... Alternatives>
  void one_of(const char* key, std::variant<Alternatives...> Class::*member, const std::vector<std::string>&,
              const char*) {
    entries_.push_back({key, 0.0});
    entries_.push_back({"type", 0.0});
    std::visit(
        [&]<class Alternative>(const Alternative& alternative) {
          Lister<Alternative> inner(alternative, entries_);
          Alternative::describe(inner);
        },
        object_.*member);
  }
  template <class Class, class Group>
  void group(const char* key, Group Class::*member, const char*) {
    list(key, object_.*member);
  }
  template <class Class, class Group>
  void group(const char* key, std::optional<Group> Class::*, const char*) {
    list(key, Group{});
  }

 private:
  template <class Group>
  void list(const char* key, const Group& group) {
    entries_.push_back({key, 0.0});
    Lister<Group> inner(group, entries_);
    Group::describe(inner);
  }

  const Object& object_;
  std::vector<Entry>& entries_;
};

/// Keys of a file in order; those of a group that is absent by default are commented out.
std::vector<Entry> keys_of(const std::string& name) {
  std::ifstream file(NOCTULE_SOURCE_DIR "/config/filters/" + name + ".yaml");
  EXPECT_TRUE(file) << name;
  const std::regex key("^(# )? *([a-z0-9_]+):(?: +([^ #]+))?.*");
  std::vector<Entry> found;
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (std::regex_match(line, match, key)) found.push_back({match[2], std::strtod(match[3].str().c_str(), nullptr)});
  }
  return found;
}

template <std::size_t I>
void expect_keys_and_defaults() {
  const std::string& name = kSlamFilterNames[I];
  const std::variant_alternative_t<I, SlamFilterParameters> defaults;
  std::vector<Entry> expected{{"type", 0.0}};
  Lister lister(defaults, expected);
  defaults.describe(lister);

  const std::vector<Entry> found = keys_of(name);
  ASSERT_EQ(found.size(), expected.size()) << name;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].key, expected[i].key) << name;
    EXPECT_NEAR(found[i].value, expected[i].value, 1e-12) << name << ": " << found[i].key;
  }
}

TEST(ExampleConfiguration, HoldsAllKeysAndDefaults) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (expect_keys_and_defaults<I>(), ...);
  }
  (std::make_index_sequence<std::variant_size_v<SlamFilterParameters>>());
}

}  // namespace
}  // namespace noctule::filters
