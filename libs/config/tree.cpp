#include "config/tree.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "core/error.hpp"

namespace noctule::config {
namespace {

constexpr int kMaxDepth = 64;               // of nesting; an alias that contains itself has no end
constexpr std::size_t kMaxNodes = 1000000;  // aliases of aliases grow exponentially
constexpr int kMaxReferences = 16;          // file: a -> b -> a has no end

class Converter {
 public:
  explicit Converter(std::shared_ptr<const Source> source) : source_(std::move(source)) {}

  Tree convert(const YAML::Node& node, int depth = 0) {
    Tree tree;
    tree.place = {source_, line_of(node)};
    if (depth > kMaxDepth) refuse(tree.place, "nested deeper than 64 levels");
    if (++nodes_ > kMaxNodes) refuse(tree.place, "more than a million values (aliases of aliases?)");
    switch (node.Type()) {
      case YAML::NodeType::Scalar:
        tree.kind = Tree::Kind::scalar;
        tree.text = node.Scalar();
        tree.quoted = node.Tag() == "!";
        break;
      case YAML::NodeType::Sequence:
        tree.kind = Tree::Kind::list;
        for (const auto& item : node) tree.items.push_back(convert(item, depth + 1));
        break;
      case YAML::NodeType::Map:
        tree.kind = Tree::Kind::map;
        for (const auto& entry : node) tree.entries.push_back(convert_entry(entry.first, entry.second, depth));
        break;
      default:
        break;
    }
    return tree;
  }

 private:
  Entry convert_entry(const YAML::Node& key, const YAML::Node& value, int depth) {
    const Place place{source_, line_of(key)};
    if (!key.IsScalar()) refuse(place, "expected a plain word as key, got a list or a map");
    Entry entry{key.Scalar(), place, convert(value, depth + 1)};
    if (entry.value.kind == Tree::Kind::nothing) entry.value.place = place;
    return entry;
  }

  int line_of(const YAML::Node& node) const {
    const bool lines = source_->has_lines;
    return lines ? std::max(node.Mark().line, 0) + 1 : 0;
  }

  [[noreturn]] static void refuse(const Place& place, const std::string& text) {
    throw InputError(to_string(place) + ": " + text);
  }

  std::shared_ptr<const Source> source_;
  std::size_t nodes_ = 0;
};

Tree parse_text(std::string_view text, std::shared_ptr<const Source> source) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(std::string(text));
    if (documents.size() > 1) {
      throw InputError(to_string({source, documents[1].Mark().line + 1}) + ": expected one YAML document, got " +
                       std::to_string(documents.size()));
    }
    Tree tree = documents.empty() ? Tree{} : Converter(source).convert(documents.front());
    if (tree.kind == Tree::Kind::nothing) tree.place = {source, source->has_lines ? 1 : 0};
    return tree;
  } catch (const YAML::Exception& e) {
    throw InputError(to_string({source, e.mark.line + 1}) + ": not valid YAML: " + e.msg);
  }
}

std::string read_text(const std::filesystem::path& file, const std::string& referrer) {
  const std::string prefix = referrer.empty() ? file.string() : referrer + ": " + file.string();
  if (std::filesystem::is_directory(file)) throw InputError(prefix + ": expected a file, got a directory");
  if (!std::filesystem::exists(file)) throw InputError(prefix + ": no such file");
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in || text.fail()) throw InputError(prefix + ": cannot be read");
  return text.str();
}

Tree parse_file(const std::filesystem::path& file, const std::string& referrer) {
  const auto source = std::make_shared<const Source>(Source{file.string(), file.parent_path()});
  return parse_text(read_text(file, referrer), source);
}

void merge(Tree& base, Tree&& over) {
  if (base.kind != Tree::Kind::map || over.kind != Tree::Kind::map || over.replaces) {
    base = std::move(over);
    return;
  }
  for (Entry& entry : over.entries) {
    const auto old = std::ranges::find(base.entries, entry.key, &Entry::key);
    if (old == base.entries.end()) {
      base.entries.push_back(std::move(entry));
    } else {
      old->place = entry.place;
      merge(old->value, std::move(entry.value));
    }
  }
}

void resolve_references(Tree& tree, int references) {
  for (Tree& item : tree.items) resolve_references(item, references);
  for (Entry& entry : tree.entries) resolve_references(entry.value, references);
  const auto reference = std::ranges::find(tree.entries, "file", &Entry::key);
  if (reference == tree.entries.end()) return;
  const Place place = reference->place;
  const Tree& name = reference->value;
  if (name.kind != Tree::Kind::scalar || name.text.empty()) {
    throw InputError(to_string(place) + ": file: expected the path of a YAML file, got " + describe(name));
  }
  if (references >= kMaxReferences) {
    throw InputError(to_string(place) + ": file: more than 16 files refer to each other in a chain");
  }
  const std::filesystem::path path = (place.source->directory / name.text).lexically_normal();
  Tree content = parse_file(path, to_string(place) + ": file");
  if (content.kind != Tree::Kind::map) {
    throw InputError(to_string(content.place) + ": expected a map of keys, got " + describe(content));
  }
  resolve_references(content, references + 1);
  tree.entries.erase(reference);
  Tree overriding = std::move(tree);
  tree = std::move(content);
  merge(tree, std::move(overriding));
  tree.replaces = true;
}

constexpr const char* kSet = "--set ";

/// `a.b[2].c=value` taken apart.
struct Assignment {
  std::vector<std::string> keys;  ///< "a", "b", "[2]", "c"
  Tree value;
};

Assignment parse_assignment(const std::string& text, const std::string& origin) {
  const auto source = std::make_shared<const Source>(Source{origin + text, {}, false});
  const auto refuse = [&] { throw InputError(source->name + ": expected key.path=value"); };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse();
  Assignment assignment;
  std::string key;
  for (const char c : text.substr(0, equals)) {
    if ((c == '.' || c == '[') && !key.empty()) assignment.keys.push_back(std::exchange(key, ""));
    if (c != '.') key += c;
  }
  if (key.empty()) refuse();
  assignment.keys.push_back(key);
  assignment.value = parse_text(text.substr(equals + 1), source);
  return assignment;
}

bool swaps_a_file(const Assignment& a) {
  return a.keys.back() == "file";
}

Tree& list_item(Tree& list, const std::string& index, const Place& place) {
  std::size_t i = 0;
  const char* end = index.data() + index.size() - 1;
  const auto [stop, error] = std::from_chars(index.data() + 1, end, i);
  if (error != std::errc{} || stop != end || *end != ']') {
    throw InputError(to_string(place) + ": expected an index such as [0], got " + index);
  }
  if (list.kind != Tree::Kind::list || i >= list.items.size()) {
    throw InputError(to_string(place) + ": there is no item " + index + " (" + std::to_string(list.items.size()) +
                     " items)");
  }
  return list.items[i];
}

void apply(Tree& root, Assignment assignment) {
  const Place place = assignment.value.place;
  Tree* tree = &root;
  for (const std::string& key : assignment.keys) {
    if (key.starts_with('[')) {
      tree = &list_item(*tree, key, place);
      continue;
    }
    if (tree->kind != Tree::Kind::map) {
      *tree = Tree{};
      tree->kind = Tree::Kind::map;
      tree->place = place;
    }
    auto entry = std::ranges::find(tree->entries, key, &Entry::key);
    if (entry == tree->entries.end()) entry = tree->entries.insert(entry, Entry{key, place, Tree{}});
    entry->place = place;
    tree = &entry->value;
  }
  *tree = std::move(assignment.value);
}

Tree finish(Tree tree, std::span<const std::string> assignments, const std::string& origin = kSet) {
  std::vector<Assignment> parsed;
  for (const std::string& text : assignments) parsed.push_back(parse_assignment(text, origin));
  for (Assignment& a : parsed) {
    if (swaps_a_file(a)) apply(tree, a);
  }
  resolve_references(tree, 0);
  for (Assignment& a : parsed) {
    if (!swaps_a_file(a)) apply(tree, std::move(a));
  }
  return tree;
}

}  // namespace

const Tree* Tree::find(std::string_view key) const {
  const auto entry = std::ranges::find(entries, key, &Entry::key);
  return entry == entries.end() ? nullptr : &entry->value;
}
std::string describe(const Tree& tree) {
  constexpr std::size_t kShown = 60;
  switch (tree.kind) {
    case Tree::Kind::nothing:
      return "nothing";
    case Tree::Kind::list:
      return "a list";
    case Tree::Kind::map:
      return "a map";
    case Tree::Kind::scalar:
      break;
  }
  std::string text = tree.text.size() > kShown ? tree.text.substr(0, kShown) + "..." : tree.text;
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20; }, ' ');
  return tree.quoted ? '"' + text + '"' : text;
}

Tree load_tree(const std::filesystem::path& file, std::span<const std::string> assignments) {
  return finish(parse_file(file, ""), assignments);
}

Tree override_tree(Tree tree, std::span<const std::string> assignments, const std::string& origin) {
  return finish(std::move(tree), assignments, origin);
}

Tree parse_tree(std::string_view text, const std::string& name, std::span<const std::string> assignments) {
  return finish(parse_text(text, std::make_shared<const Source>(Source{name, {}})), assignments);
}

}  // namespace noctule::config
