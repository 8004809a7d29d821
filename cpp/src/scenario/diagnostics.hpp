#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "der/core/error.hpp"
#include "der/scenario/document.hpp"

namespace der::scenario {

/// A value together with the way to it from the top of the document: a linked list on the stack, so
/// that a scene without mistakes pays nothing for its paths.
struct Place {
  const Value* value = nullptr;
  const Place* parent = nullptr;
  std::string_view key{};  ///< under which it stands in its parent, if that is a mapping
  int index = -1;          ///< of it in its parent, if that is a sequence

  [[nodiscard]] Place at(const Entry& entry) const { return {&entry.value, this, entry.key, -1}; }
  [[nodiscard]] Place at(int item, const Value& child) const { return {&child, this, {}, item}; }
};

/// One step of a path: a key or an index.
struct Segment {
  Segment(const char* name) : key(name) {}             // NOLINT(google-explicit-constructor)
  Segment(std::string name) : key(std::move(name)) {}  // NOLINT(google-explicit-constructor)
  Segment(int item) : index(item) {}                   // NOLINT(google-explicit-constructor)
  bool operator==(const Segment& other) const { return key == other.key && index == other.index; }

  std::string key;
  int index = -1;
};
using Path = std::vector<Segment>;
Path operator/(const Path& path, Segment next);

/// More diagnostics than these help nobody, and a text with a million mistakes is read no further.
inline constexpr std::size_t kMaxDiagnostics = 100;

/// Collects what the reader finds in a document: everything that is wrong with it, and the numbers
/// that it has in units of their own. The diagnostic after the last that is kept throws SceneError
/// with those before it.
class Diagnostics {
 public:
  explicit Diagnostics(const Document& document) : document_(document) {}

  /// About a value.
  void add(const Place& place, std::string message);
  /// About a key of a mapping; `mark` is where that key stands, or should.
  void add_key(const Place& mapping, std::string_view key, const Mark& mark, std::string message);
  /// About a value, or (where it is absent) about the nearest that holds it.
  void add(const Path& path, std::string message);

  /// Notes a vector, which has as many components as its value has items. Reports it if one with
  /// fewer or more has come before; `hint` may tell, in a clause, why it has as many.
  void note_vector(const Place& place, std::string (*hint)(const Sequence&));
  /// Components of the scene's vectors: 3 as soon as one has 3.
  [[nodiscard]] int dimension() const { return vectors_[1] ? 3 : 2; }
  /// Whether vectors of two components stand beside vectors of three. Then nothing that compares
  /// places can be checked.
  [[nodiscard]] bool vectors_differ() const { return vectors_[0] && vectors_[1]; }

  /// Notes the number in SI units of a value that has a unit.
  void note_number(const Place& place, double number) { numbers_.emplace(place.value, number); }
  /// The numbers of all values that have a unit.
  [[nodiscard]] const std::unordered_map<const Value*, double>& numbers() const { return numbers_; }

  [[nodiscard]] std::size_t size() const { return found_.size(); }
  /// Whether something at this path, or below it, is wrong: then nothing can be concluded from it.
  [[nodiscard]] bool under(const Path& path) const;
  /// Whether the value itself, not one of its parts, is of the wrong kind.
  [[nodiscard]] bool at(const Path& path) const;
  /// Throws SceneError with all of them, sorted by line.
  void throw_if_any() const;

 private:
  struct Found {
    Path path;
    Diagnostic diagnostic;
  };
  void record(Path path, const Mark& mark, std::string message);
  /// All diagnostics, sorted by line.
  [[nodiscard]] std::vector<Diagnostic> diagnostics() const;
  [[nodiscard]] std::string written(const Path& path) const;

  struct FirstVector {
    Path path;
    Mark mark;
  };

  const Document& document_;
  std::array<std::optional<FirstVector>, 2> vectors_;  // the first with 2 components, and with 3
  std::vector<Found> found_;
  std::unordered_map<const Value*, double> numbers_;
};

}  // namespace der::scenario
