/// The example configuration names every key of the filter once, in order, with the defaults of the class.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "filters/slam/parameters.hpp"

namespace noctule::filters {
namespace {

struct Entry {
  std::string key;
  double value = 0.0;  ///< of numbers, in the unit of the file
  bool operator==(const Entry&) const = default;
};

/// Flattens a parameter struct: a group's key stands before its members.
template <class Object>
class Lister {
 public:
  Lister(const Object& object, std::vector<Entry>& entries) : object_(object), entries_(entries) {}
  template <class T>
  void field(const char* key, T Object::*member, Unit unit, const char*, Range) {
    entries_.push_back({key, static_cast<double>(object_.*member) / unit.to_si});
  }
  template <class Enum>
  void choice(const char* key, Enum Object::*, const Choices<Enum>&, const char*) {
    entries_.push_back({key, 0.0});
  }
  template <class Group>
  void group(const char* key, Group Object::*member, const char*) {
    entries_.push_back({key, 0.0});
    Lister<Group> inner(object_.*member, entries_);
    Group::describe(inner);
  }

 private:
  const Object& object_;
  std::vector<Entry>& entries_;
};

TEST(ExampleConfiguration, HoldsAllKeysAndDefaults) {
  const ParticleSlamParameters defaults;
  std::vector<Entry> expected{{"type", 0.0}};
  Lister<ParticleSlamParameters> lister(defaults, expected);
  ParticleSlamParameters::describe(lister);

  std::ifstream file(NOCTULE_SOURCE_DIR "/config/filters/pf.yaml");
  ASSERT_TRUE(file);
  std::vector<Entry> found;
  for (std::string line; std::getline(file, line);) {
    line = line.substr(0, line.find('#'));
    const auto colon = line.find(':'), first = line.find_first_not_of(' ');
    if (colon == std::string::npos) continue;
    found.push_back({line.substr(first, colon - first), std::strtod(line.c_str() + colon + 1, nullptr)});
  }
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].key, expected[i].key);
    EXPECT_NEAR(found[i].value, expected[i].value, 1e-12) << found[i].key;
  }
}

}  // namespace
}  // namespace noctule::filters
