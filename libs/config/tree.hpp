#pragma once
/// A YAML text as a plain tree in which every node knows its place, and in which references to other files are
/// resolved. Independent of the YAML library.
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/problems.hpp"

namespace noctule::config {

struct Entry;

struct Tree {
  enum class Kind { nothing, scalar, list, map };
  Kind kind = Kind::nothing;
  Place place;
  std::string text;       ///< of a scalar
  bool quoted = false;    ///< the scalar stood in quotes: a text, never a number
  bool replaces = false;  ///< came with a `file:` of its own: as an overriding value it replaces, it is not merged
  std::vector<Tree> items;
  std::vector<Entry> entries;  ///< in the order of the file, duplicates included

  /// First entry of a map with this key, or null.
  [[nodiscard]] const Tree* find(std::string_view key) const;
};
struct Entry {
  std::string key;
  Place place;
  Tree value;
};

/// What a message says it got: `-5`, `"text"`, `a list`, `a map`, `nothing`.
[[nodiscard]] std::string describe(const Tree&);

/// Reads a file and the files it refers to. A map may hold `file: other.yaml` (relative to the file it stands in): the
/// content of that file takes its place, keys beside it override single values deep inside. Lists are replaced whole.
/// \param assignments `a.b[2].c=value` as given to --set, applied on top; `a.file=other.yaml` swaps a reference
///        (relative to the working directory)
/// \throws InputError where a file is missing, unreadable, not YAML, or an assignment cannot be understood
[[nodiscard]] Tree load_tree(const std::filesystem::path& file, std::span<const std::string> assignments = {});

/// The same assignments on a tree that was read before (its references are resolved).
/// \param origin what messages put before an assignment
[[nodiscard]] Tree override_tree(Tree tree, std::span<const std::string> assignments,
                                 const std::string& origin = "--set ");

/// The same for a text; `name` stands for the file in messages.
[[nodiscard]] Tree parse_tree(std::string_view text, const std::string& name,
                              std::span<const std::string> assignments = {});

}  // namespace noctule::config
