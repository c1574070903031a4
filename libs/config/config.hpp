#pragma once
/// Strict YAML <-> parameter structs (core/parameters.hpp). Keys that are absent keep their defaults; anything that is
/// not understood is a problem. All problems are found before InputError is thrown, one a line:
/// `path:line: key.path: expected an integer >= 1, got -5`.
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "config/schema.hpp"
#include "config/tree.hpp"

namespace noctule::config {

/// Writes the values of `tree` into the bound object. \throws InputError that lists all problems
void read(const Group& group, const Tree& tree);
/// YAML with the unit, the allowed values and the meaning behind every key; absent optional groups are left out.
[[nodiscard]] std::string write(const Group& group);
/// A Markdown table of all keys: unit, default, allowed values, meaning.
[[nodiscard]] std::string document(const Group& group);

template <class T>
[[nodiscard]] T load(const Tree& tree) {
  T object{};
  read(bind(object), tree);
  return object;
}

/// \param assignments overriding values `a.b[2].c=value` (see load_tree)
template <class T>
[[nodiscard]] T load(const std::filesystem::path& file, std::span<const std::string> assignments = {}) {
  return load<T>(load_tree(file, assignments));
}

template <class T>
[[nodiscard]] T parse(std::string_view text, const std::string& name = "<text>",
                      std::span<const std::string> assignments = {}) {
  return load<T>(parse_tree(text, name, assignments));
}

/// load(dump(x)) has the same bits as x.
template <class T>
[[nodiscard]] std::string dump(const T& object) {
  T copy = object;
  return write(bind(copy));
}

template <class T>
[[nodiscard]] std::string reference() {
  return document(prototype<T>());
}

}  // namespace noctule::config
