#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace der::scenario {

/// Bounds of a number; an open bound is itself excluded.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  bool min_open = false;
  double max = std::numeric_limits<double>::infinity();
  bool max_open = false;

  [[nodiscard]] bool holds(double value) const {
    return (min_open ? value > min : value >= min) && (max_open ? value < max : value <= max);
  }
};

inline Range positive() { return {0.0, true}; }
inline Range not_negative() { return {0.0}; }
inline Range at_least(double min) { return {min}; }
inline Range between(double min, double max) { return {min, true, max, true}; }

/// A word that a key accepts, and what it means.
struct Word {
  std::string name;
  std::string doc;
};

/// A word that the format knows but this version cannot do, and what to say then.
struct ReservedWord {
  std::string name;
  std::string message;
};

struct TableInfo;

/// The allowed values of a key. Messages, JSON Schema and scene reference are all made from it.
struct Shape {
  enum class Kind {
    Number,
    Integer,
    Boolean,
    Text,
    Name,
    Choice,
    Vector,       ///< [x, y] or [x, y, z]; with `min_items` 3 only the latter
    Pair,         ///< [k1, k2]
    Triple,       ///< [k1, k2, kt]
    List,         ///< of parts[0]
    Table,        ///< a mapping with the keys of `table`
    NamedTables,  ///< a mapping from free names to `table`
    AnyOf,        ///< one of `parts`
  };
  Kind kind = Kind::Text;
  std::string unit{};
  Range range{};
  std::vector<Word> words{};
  std::vector<ReservedWord> reserved{};
  std::vector<Shape> parts{};
  int min_items = 0;
  std::shared_ptr<const TableInfo> table{};
};

/// One key of a table.
struct FieldInfo {
  std::string key;
  Shape shape;
  bool required = false;
  std::string default_text;         ///< as it would be written, or in words; "" if there is none
  bool default_is_literal = false;  ///< `default_text` is a value, not words
  std::string doc;
  bool is_kind = false;  ///< in a table with `one_key`: it says which kind the mapping is
};

/// Keys of which only one branch may be present; all keys of that branch are then needed.
struct Alternatives {
  std::vector<std::vector<std::string>> branches;
  bool required = false;  ///< one branch must be present

  /// "a and b, or c": `listing` joins the keys of one branch.
  template <class Listing>
  [[nodiscard]] std::string described(Listing listing) const {
    bool single = true;
    for (const auto& branch : branches) single = single && branch.size() == 1;
    std::string text;
    for (const auto& branch : branches) {
      text += (text.empty() ? "" : single ? " or " : ", or ") + listing(branch);
    }
    return text;
  }
};

/// All that is known of a mapping: its keys and how they exclude each other.
struct TableInfo {
  std::string name;  ///< one word, as in "a support has no key ..."
  std::string doc;
  std::vector<FieldInfo> fields;
  std::vector<Alternatives> alternatives;
  bool one_key = false;          ///< exactly one of the keys that say which kind it is is present
  bool unit_of_the_key = false;  ///< values take the unit of the key that the table stands under

  [[nodiscard]] std::vector<std::string> keys() const;
  /// Those that say which kind it is.
  [[nodiscard]] std::vector<std::string> kinds() const;
  /// "m", "" or, of a value in a table over time, "of the key".
  [[nodiscard]] std::string unit_of(const FieldInfo& field) const;
  /// Position in `fields`; -1 for an unknown key.
  [[nodiscard]] int find(std::string_view key) const;
};

/// "a mapping with the keys 'a' and 'b'"
std::string expected_mapping(const TableInfo& table);
/// "a number in m", "one of 'a', 'b'", "a list", ... for "expected ..."
std::string expected(const Shape& shape);
/// "greater than 0", "at least 2", "between 0 and 1 (both excluded)"; "" without bounds.
std::string bounds(const Range& range);

/// The names of a shape's words.
std::vector<std::string> names_of(const std::vector<Word>& words);

/// The allowed form of a name, as a regular expression.
inline constexpr const char* kNamePattern = "^[A-Za-z_][A-Za-z0-9_-]*$";
bool is_name(std::string_view text);

}  // namespace der::scenario
