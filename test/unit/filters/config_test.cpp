/// The example configuration names every key of the filter once, in order, with the defaults of the class.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <type_traits>
#include <variant>
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
  template <class Class, class T>
  void field(const char* key, T Class::*member, Unit unit, const char*, Range) {
    double value = 0.0;  // of lists
    if constexpr (std::is_arithmetic_v<T>) value = static_cast<double>(object_.*member) / unit.to_si;
    entries_.push_back({key, value});
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
    entries_.push_back({key, 0.0});
    Lister<Group> inner(object_.*member, entries_);
    Group::describe(inner);
  }

 private:
  const Object& object_;
  std::vector<Entry>& entries_;
};

template <class Parameters>
void expect_defaults_in(const std::string& name) {
  const Parameters defaults;
  std::vector<Entry> expected{{"type", 0.0}};
  Lister<Parameters> lister(defaults, expected);
  Parameters::describe(lister);

  std::ifstream file(NOCTULE_SOURCE_DIR "/config/filters/" + name);
  ASSERT_TRUE(file) << name;
  std::vector<Entry> found;
  for (std::string line; std::getline(file, line);) {
    line = line.substr(0, line.find('#'));
    const auto colon = line.find(':'), first = line.find_first_not_of(' ');
    if (colon == std::string::npos) continue;
    found.push_back({line.substr(first, colon - first), std::strtod(line.c_str() + colon + 1, nullptr)});
  }
  ASSERT_EQ(found.size(), expected.size()) << name;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].key, expected[i].key) << name;
    EXPECT_NEAR(found[i].value, expected[i].value, 1e-12) << name << ": " << found[i].key;
  }
}

TEST(ExampleConfiguration, HoldsAllKeysAndDefaults) {
  expect_defaults_in<ParticleSlamParameters>("pf.yaml");
  expect_defaults_in<VbParticleSlamParameters>("vb_pf.yaml");
  expect_defaults_in<EmParticleSlamParameters>("em_pf.yaml");
}

}  // namespace
}  // namespace noctule::filters
