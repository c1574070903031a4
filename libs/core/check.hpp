#pragma once
/// Checks parameter structs that were built in code against the ranges of their describe() and their validate(), as
/// the config room does for files.
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/error.hpp"
#include "core/parameters.hpp"
#include "core/pose2.hpp"

namespace noctule {

namespace detail {

template <class T>
class Checker {
 public:
  Checker(const T& object, std::string prefix) : object_(object), prefix_(std::move(prefix)) {}

  template <class Class, class Member>
  void field(const char* key, Member Class::*member, const Unit& unit, const char*, const Range& range = {}) {
    check(key, object_.*member, unit, range);
  }
  template <class Class, class Member>
  void field(const char* key, Member Class::*member, const char*) {
    check(key, object_.*member, unit::one, {});
  }
  template <class Class, class Enum>
  void choice(const char*, Enum Class::*, const Choices<Enum>&, const char*) {}
  template <class Class, class Member>
  void group(const char* key, Member Class::*member, const char*) {
    nested(key, object_.*member);
  }
  template <class Class, class Member>
  void group(const char* key, std::optional<Member> Class::*member, const char*) {
    if (object_.*member) nested(key, *(object_.*member));
  }
  template <class Class, class Member>
  void list(const char* key, std::vector<Member> Class::*member, const char*) {
    const auto& items = object_.*member;
    for (std::size_t i = 0; i < items.size(); ++i) nested(std::string(key) + "[" + std::to_string(i) + "]", items[i]);
  }

  template <class Class, class... Alternatives>
  void one_of(const char* key, std::variant<Alternatives...> Class::*member, const std::vector<std::string>&,
              const char*) {
    std::visit([&](const auto& alternative) { nested(key, alternative); }, object_.*member);
  }

  /// The first problem: of a value, of a nested struct, else across the fields of this one.
  [[nodiscard]] std::string problem() {
    T::describe(*this);
    if constexpr (requires { object_.validate(); }) {
      if (problem_.empty()) report("", object_.validate());
    }
    return problem_;
  }

 private:
  void report(const std::string& key, const std::string& text) {
    if (!problem_.empty() || text.empty()) return;
    std::string path = prefix_;
    if (!path.empty() && !key.empty()) path += ".";
    path += key;
    problem_ = path.empty() ? text : path + ": " + text;
  }

  template <class Member>
  void nested(const std::string& key, const Member& member) {
    if (problem_.empty()) problem_ = Checker<Member>(member, (prefix_.empty() ? "" : prefix_ + ".") + key).problem();
  }

  void check_number(const char* key, double value, const Range& range) {
    const bool above = range.min_allowed ? value >= range.min : value > range.min;
    const bool below = range.max_allowed ? value <= range.max : value < range.max;
    if (std::isfinite(value) && above && below) return;
    std::ostringstream text;
    text << "expected a finite number";
    if (std::isfinite(range.min)) text << (range.min_allowed ? " >= " : " > ") << range.min;
    if (std::isfinite(range.min) && std::isfinite(range.max)) text << " and";
    if (std::isfinite(range.max)) text << (range.max_allowed ? " <= " : " < ") << range.max;
    text << ", got " << value;
    report(key, text.str());
  }

  template <class Member>
  void check(const char* key, const Member& value, const Unit& unit, const Range& range) {
    if constexpr (std::is_same_v<Member, bool> || std::is_convertible_v<Member, std::string>) {
      return;  // switches, texts, paths
    } else if constexpr (std::is_arithmetic_v<Member>) {
      check_number(key, static_cast<double>(value) / unit.to_si, range);
    } else if constexpr (std::is_same_v<Member, Vector2>) {
      for (const double v : value) check_number(key, v / unit.to_si, range);
    } else if constexpr (std::is_same_v<Member, Pose2>) {
      for (const double v : value.vector()) check_number(key, v, range);
    } else {
      for (const auto& element : value) check(key, element, unit, range);
    }
  }

  const T& object_;
  std::string prefix_;
  std::string problem_;
};

}  // namespace detail

/// What is wrong with the parameters, `key.path: expected .., got ..` with values in the unit of the key; empty when
/// they are sound.
template <class T>
[[nodiscard]] std::string first_problem(const T& parameters) {
  return detail::Checker<T>(parameters, "").problem();
}

/// \throws InputError with first_problem() behind the given name, when there is one
template <class T>
void require_sound(const T& parameters, const std::string& name) {
  const std::string problem = first_problem(parameters);
  if (!problem.empty()) throw InputError(name + ": " + problem);
}

}  // namespace noctule
