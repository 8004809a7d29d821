#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "der/scenario/mark.hpp"

namespace der::scenario {

struct Value;
struct Entry;

/// An unquoted scalar of a text, untouched: what it means depends on the key that it belongs to, so
/// the reader, not the parser, turns it into a number, a truth value or a name.
struct Plain {
  std::string text;
};
using Sequence = std::vector<Value>;
/// Keys in the order of the text. Duplicate keys are kept here and reported by the reader.
using Mapping = std::vector<Entry>;

/// Levels that values may be nested in: a scene has fewer than ten, and those who walk through a
/// document call themselves level by level.
inline constexpr std::size_t kMaxDepth = 100;

/// A marked value: nothing, an unquoted scalar, a text (quoted, or a Python str), a value that
/// already has a type (from Python), a sequence or a mapping.
struct Value {
  std::variant<std::monostate, Plain, std::string, bool, std::int64_t, double, Sequence, Mapping>
      content;
  Mark mark;

  [[nodiscard]] bool is_null() const { return std::holds_alternative<std::monostate>(content); }
  [[nodiscard]] const Sequence* sequence() const { return std::get_if<Sequence>(&content); }
  [[nodiscard]] const Mapping* mapping() const { return std::get_if<Mapping>(&content); }
};

struct Entry {
  std::string key;
  Value value;
  Mark mark;  ///< of the key
};

/// Builders for values that do not come from a text (the Python bindings turn a dict into these).
Value make_null();
Value make_scalar(bool value);
Value make_scalar(int value);
Value make_scalar(std::int64_t value);
Value make_scalar(double value);
Value make_scalar(std::string value);
Value make_scalar(const char* value);
Value make_sequence(Sequence items);
/// The entries' own marks are kept.
Value make_mapping(Mapping entries);

/// The first entry with this key; null if there is none.
const Entry* find_entry(const Mapping& mapping, std::string_view key);
/// The value of an item's key `name`, when the item is a mapping that has a text there.
const std::string* name_of(const Value& item);

/// An ordered tree of marked values, and the name of what it was read from.
class Document {
 public:
  explicit Document(Value root, std::string source = {})
      : root_(std::move(root)), source_(std::move(source)) {}

  /// Reads YAML. Anchors and aliases are resolved; tags, merge keys and further documents are
  /// errors. Throws SceneError.
  static Document parse(std::string_view text, const std::string& source);
  /// Parses a file. Throws SceneError, or UnreadableSceneError if the file cannot be read.
  static Document load(const std::filesystem::path& file);

  [[nodiscard]] const Value& root() const noexcept { return root_; }
  [[nodiscard]] const std::string& source() const noexcept { return source_; }
  /// YAML text that reads back to the same values: scalars of a text as they were written, numbers
  /// of Python in the shortest form that reads back to the same double.
  [[nodiscard]] std::string to_yaml() const;

 private:
  Value root_;
  std::string source_;
};

/// One value as one line of YAML, as an `Override` takes it.
std::string to_flow_yaml(const Value& value);

}  // namespace der::scenario
