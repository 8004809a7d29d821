#pragma once

#include <fmt/core.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "der/scenario/location.hpp"
#include "der/scenario/rod.hpp"
#include "der/scenario/series.hpp"
#include "scenario/diagnostics.hpp"
#include "scenario/shape.hpp"

namespace der::scenario {

/// How a value of type T is written in a scene: what it may look like, and how it is read.
template <class T>
struct Format {
  Shape shape;
  /// Reads and checks; reports and returns false where the text does not fit the shape.
  std::function<bool(const Shape&, const Place&, Diagnostics&, T&)> read_shape;
  /// A value as one would write it, for the defaults in the documentation; may be absent.
  std::function<std::string(const T&)> print{};

  bool read(const Place& place, Diagnostics& diagnostics, T& out) const {
    return read_shape(shape, place, diagnostics, out);
  }
};

/// "expected a number in m, got 'abc'" and, behind a colon, what to do.
void report_expected(const std::string& what, const Place& place, Diagnostics& diagnostics,
                     const std::string& hint = {});

/// Says what to write if items of a list in one line are the parts of a number with commas, as a
/// clause; empty if none seem to be. No space follows such a comma.
std::string split_number_in(const Sequence& items);

/// The text of a scalar that is not typed, quoted or not; null for everything else.
const std::string* text_of(const Value& value);

Format<double> number(std::string unit, Range range = {});
Format<int> integer(Range range);
Format<bool> boolean();
Format<std::string> text();
/// A word that other keys and override paths can refer to.
Format<std::string> name();
/// One of some words, as itself.
Format<std::string> one_of(const std::vector<Word>& words, std::vector<ReservedWord> reserved = {});
/// A vector of two or three components. All vectors of a scene have as many, see check_vectors.
Format<Components> vector(std::string unit);
/// A vector of three components.
Format<Components> space_vector(std::string unit);
/// `[k1, k2, kt]`: toward the two directors, and about the tangent.
Format<Components> section_triple(std::string unit);
/// `[k1, k2]`.
Format<CurvaturePair> pair(std::string unit);

/// Position among the shape's words of the one that is written; -1 after a diagnostic, which says
/// that `whole` was expected, the shape or one that it is a part of.
int read_word(const Shape& shape, const Shape& whole, const Place& place, Diagnostics& diagnostics);

/// One of some words, as the value that belongs to it.
template <class E>
Format<E> choice(const std::vector<std::pair<Word, E>>& options,
                 std::vector<ReservedWord> reserved = {}) {
  Shape shape{Shape::Kind::Choice};
  std::vector<E> values;
  for (const auto& [word, value] : options) {
    shape.words.push_back(word);
    values.push_back(value);
  }
  shape.reserved = std::move(reserved);
  return {std::move(shape),
          [values](const Shape& self, const Place& place, Diagnostics& diagnostics, E& out) {
            const int chosen = read_word(self, self, place, diagnostics);
            if (chosen >= 0) out = values[static_cast<std::size_t>(chosen)];
            return chosen >= 0;
          },
          [options](const E& value) {
            for (const auto& [word, candidate] : options) {
              if (candidate == value) return word.name;
            }
            return std::string();
          }};
}

/// Reports and returns false unless the value is a list with enough items.
bool is_list(const Shape& shape, const Place& place, Diagnostics& diagnostics);

/// In a long list of numbers the first mistakes are enough.
inline constexpr int kMaxMistakesInNumbers = 10;

/// A list; its items keep their positions even where some cannot be read.
template <class T>
Format<std::vector<T>> list_of(Format<T> item, int min_items) {
  Shape shape{Shape::Kind::List};
  shape.unit = item.shape.unit;
  shape.parts = {item.shape};
  shape.min_items = min_items;
  const bool numbers =
      item.shape.kind == Shape::Kind::Number || item.shape.kind == Shape::Kind::Vector;
  return {std::move(shape),
          [item = std::move(item), numbers](const Shape& self, const Place& place,
                                            Diagnostics& diagnostics, std::vector<T>& out) {
            if (!is_list(self, place, diagnostics)) return false;
            const Sequence& items = *place.value->sequence();
            out.clear();
            out.resize(items.size());
            int mistakes = 0;
            for (std::size_t i = 0; i < items.size(); ++i) {
              const Place here = place.at(static_cast<int>(i), items[i]);
              if (item.read(here, diagnostics, out[i])) continue;
              if (++mistakes == kMaxMistakesInNumbers && numbers && i + 1 < items.size()) {
                diagnostics.add(here,
                                "the rest of this list is not checked before these are mended");
                break;
              }
            }
            return mistakes == 0;
          }};
}

/// A constant, or a table over time.
Format<Series> series(const std::string& unit);
Format<VectorSeries> vector_series(const std::string& unit);
Format<VectorSeries> space_vector_series(const std::string& unit);

/// `at:`. `All` names every node; without it the place is a single one.
Format<Location> location();
Format<Location> single_location(const std::string& why_not_all);

}  // namespace der::scenario
