#pragma once
/// The list of fields of one parameter object, bound to its members: made from `T::describe`, after which reading,
/// writing and documenting need no templates.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/tree.hpp"
#include "core/parameters.hpp"
#include "core/pose2.hpp"

namespace noctule::config {

struct Field;

struct Group {
  std::vector<Field> fields;
  std::function<std::string()> validate;  ///< empty text when sound
};
/// A group that may be absent.
struct OptionalGroup {
  std::function<bool()> present;
  std::function<Group()> value;      ///< makes it present
  std::function<Group()> prototype;  ///< one with default values, for documents
};
struct List {
  std::function<std::size_t()> size;
  std::function<void(std::size_t)> resize;
  std::function<Group(std::size_t)> item;
  std::function<Group()> prototype;
};
struct Choice {
  std::vector<std::string> names;
  std::function<std::size_t()> get;  ///< index into names
  std::function<void(std::size_t)> set;
};
/// One of several groups; the key `type` among its keys says which. The groups made here have that key.
struct OneOf {
  std::vector<std::string> names;
  std::function<std::size_t()> index;
  std::function<Group(std::size_t)> value;  ///< makes the object hold that alternative
  std::function<Group(std::size_t)> prototype;
};

using Target = std::variant<bool*, int*, std::int64_t*, std::uint64_t*, double*, std::string*, std::filesystem::path*,
                            Vector2*, Pose2*, std::vector<double>*, std::vector<std::string>*, std::vector<Vector2>*,
                            Tree*, Choice, Group, OptionalGroup, List, OneOf>;

struct Field {
  std::string key;
  std::string doc;
  Unit unit = unit::one;
  Range range;
  Target target;
};

template <class T>
[[nodiscard]] Group bind(T& object);

/// A group of a default-constructed T that lives as long as the group.
template <class T>
[[nodiscard]] Group prototype() {
  auto object = std::make_shared<T>();
  Group group = bind(*object);
  group.validate = [object, check = group.validate] { return check(); };
  return group;
}

/// What the visitor does that does not depend on the types: compiled once.
class FieldCollector {
 protected:
  void add(const char* key, const char* doc, const Unit& unit, const Range& range, Target&& target);
  void add(const char* key, const char* doc, Target&& target) { add(key, doc, unit::one, {}, std::move(target)); }
  /// The group with the key `type`, whose value is the i-th of the names.
  [[nodiscard]] static Group with_type(Group group, const std::vector<std::string>& names, std::size_t i,
                                       const char* doc);

  std::vector<Field> fields_;
};

/// The visitor of `T::describe` (core/parameters.hpp).
template <class T>
class Binder : private FieldCollector {
 public:
  explicit Binder(T& object) : object_(object) {}

  template <class Class, class Member>
  void field(const char* key, Member Class::*member, const Unit& unit, const char* doc, const Range& range = {}) {
    add(key, doc, unit, range, &(object_.*member));
  }
  /// Without a unit: texts, paths, switches, and a Tree, which takes any value as it stands: its reader comes later.
  template <class Class, class Member>
  void field(const char* key, Member Class::*member, const char* doc) {
    add(key, doc, &(object_.*member));
  }

  template <class Class, class Enum>
  void choice(const char* key, Enum Class::*member, const Choices<Enum>& choices, const char* doc) {
    Choice choice;
    std::vector<Enum> values;
    for (const auto& [name, value] : choices) {
      choice.names.emplace_back(name);
      values.push_back(value);
    }
    Enum* target = &(object_.*member);
    choice.get = [target, values] {
      return static_cast<std::size_t>(std::find(values.begin(), values.end(), *target) - values.begin());
    };
    choice.set = [target, values](std::size_t i) { *target = values[i]; };
    add(key, doc, std::move(choice));
  }

  template <class Class, class Member>
  void group(const char* key, Member Class::*member, const char* doc) {
    add(key, doc, bind(object_.*member));
  }
  template <class Class, class Member>
  void group(const char* key, std::optional<Member> Class::*member, const char* doc) {
    std::optional<Member>* target = &(object_.*member);
    add(key, doc,
        OptionalGroup{[target] { return target->has_value(); },
                      [target] { return bind(target->has_value() ? **target : target->emplace()); },
                      &prototype<Member>});
  }

  template <class Class, class Member>
  void list(const char* key, std::vector<Member> Class::*member, const char* doc) {
    std::vector<Member>* target = &(object_.*member);
    add(key, doc,
        List{[target] { return target->size(); }, [target](std::size_t n) { target->assign(n, Member{}); },
             [target](std::size_t i) { return bind((*target)[i]); }, &prototype<Member>});
  }

  /// \param names of the alternatives, in their order
  template <class Class, class... Alternatives>
  void one_of(const char* key, std::variant<Alternatives...> Class::*member, const std::vector<std::string>& names,
              const char* doc) {
    std::variant<Alternatives...>* target = &(object_.*member);
    OneOf one{names, [target] { return target->index(); }, {}, {}};
    one.value = [target, names, doc](std::size_t i) {
      visit_alternative<Alternatives...>(i, [&]<class Alternative>(std::type_identity<Alternative>) {
        if (target->index() != i) target->template emplace<Alternative>();
      });
      return std::visit([&](auto& value) { return with_type(bind(value), names, i, doc); }, *target);
    };
    one.prototype = [names, doc](std::size_t i) {
      Group group;
      visit_alternative<Alternatives...>(
          i, [&]<class Alternative>(std::type_identity<Alternative>) { group = config::prototype<Alternative>(); });
      return with_type(std::move(group), names, i, doc);
    };
    add(key, doc, std::move(one));
  }

  [[nodiscard]] Group finish() && {
    Group group{std::move(fields_), [] { return std::string(); }};
    if constexpr (requires { object_.validate(); }) group.validate = [&object = object_] { return object.validate(); };
    return group;
  }

 private:
  template <class... Alternatives, class Function>
  static void visit_alternative(std::size_t i, const Function& function) {
    std::size_t n = 0;
    ((n++ == i ? function(std::type_identity<Alternatives>{}) : void()), ...);
  }

  T& object_;
};

template <class T>
Group bind(T& object) {
  Binder<T> binder(object);
  T::describe(binder);
  return std::move(binder).finish();
}

}  // namespace noctule::config
