#include <optional>
#include <utility>

#include "scenario/table.hpp"

namespace der::scenario {
namespace {

/// `sine:`; `Constant` is the type of one value.
template <class Constant>
struct SineText {
  Constant amplitude{};
  double frequency = 1.0;
  double phase = 0.0;
  std::optional<Constant> offset;
};

/// `Result` is the type of the series.
template <class Result, class Constant>
struct TableText : Result {
  bool smooth = false;
  std::optional<SineText<Constant>> sine;
};

Components zero_like(const Components& vector) { return Components(vector.size(), 0.0); }
double zero_like(double /*number*/) { return 0.0; }

/// ": a decimal has a point, not a comma: write 0.5" for a list like `[0, 0,5, 1]`; empty where no
/// comma is followed by a space, so that all may part items.
std::string comma_hint(const Sequence& items) {
  const auto text_at = [&](std::size_t i) { return text_of(items[i]); };
  bool any_space = false;
  for (std::size_t i = 1; i < items.size(); ++i) {
    const std::string* before = text_at(i - 1);
    if (before == nullptr || items[i].mark.line != items[i - 1].mark.line) continue;
    const int behind = items[i - 1].mark.column + static_cast<int>(before->size()) + 1;
    any_space = any_space || items[i].mark.column > behind;
  }
  const std::string hint = any_space ? split_number_in(items) : std::string();
  return hint.empty() ? hint : ": " + hint;
}

/// The same of whichever of the two lists of a table has one.
std::string comma_hint(const Place& times, const Place& values) {
  for (const Place* place : {&times, &values}) {
    const Sequence* items = place->value->sequence();
    if (items == nullptr) continue;
    if (std::string hint = comma_hint(*items); !hint.empty()) return hint;
  }
  return {};
}

/// Times that increase, and a value for each.
template <class Table>
void check_entries(const Table& table, const Place& place, Diagnostics& diagnostics) {
  const Mapping& entries = *place.value->mapping();
  const Place times = place.at(*find_entry(entries, "times"));
  const Place values = place.at(*find_entry(entries, "values"));
  for (std::size_t i = 1; i < table.times.size(); ++i) {
    if (table.times[i] > table.times[i - 1]) continue;
    diagnostics.add(times.at(static_cast<int>(i), (*times.value->sequence())[i]),
                    fmt::format("times must increase, but {} s follows {} s{}", table.times[i],
                                table.times[i - 1], comma_hint(*times.value->sequence())));
    return;
  }
  if (table.times.size() != table.values.size()) {
    diagnostics.add(
        values, fmt::format("a table needs one value for each of its {} times, got {}{}",
                            table.times.size(), table.values.size(), comma_hint(times, values)));
  }
}

template <class Text>
void check_table(const Text& text, const Place& place, Diagnostics& diagnostics) {
  if (!text.sine) {
    check_entries(text, place, diagnostics);
  } else if (const Entry* smooth = find_entry(*place.value->mapping(), "smooth")) {
    diagnostics.add(place.at(*smooth), "a sine is smooth by itself: remove the key");
  }
}

template <class Result, class Constant>
Result completed(TableText<Result, Constant> text) {
  Result result = static_cast<Result&&>(text);
  if (text.smooth) result.course.kind = Course::Kind::Smooth;
  if (!text.sine) return result;
  auto& [amplitude, frequency, phase, offset] = *text.sine;
  result.course = {Course::Kind::Sine, frequency, phase};
  result.times.clear();
  result.values = {offset.value_or(zero_like(amplitude)), std::move(amplitude)};
  return result;
}

template <class Constant>
Format<SineText<Constant>> sine_format(const Format<Constant>& constant, const std::string& name) {
  using Text = SineText<Constant>;
  return mapping(
      Table<Text>(name, "offset + amplitude sin(2 pi frequency t + phase) at every time t.")
          .required("amplitude", &Text::amplitude, constant, "Amplitude.")
          .required("frequency", &Text::frequency, number("Hz", positive()), "Frequency.")
          .optional("phase", &Text::phase, number("rad"), "Phase at time 0.", "0")
          .optional("offset", &Text::offset, constant, "Mean value.", "0")
          .in_unit_of_the_key());
}

/// A constant or a table: `Constant` is the type of one value. `of_what` completes the names of the
/// tables.
template <class Result, class Constant>
Format<Result> constant_or_table(const Format<Constant>& constant, const std::string& of_what) {
  using Text = TableText<Result, Constant>;
  const Format<Text> table = mapping(
      Table<Text>("table" + of_what,
                  "A value over time: linear between the times of the list, constant before the "
                  "first and after the last; or a sine.")
          .optional("times", &Result::times, list_of(number("s"), 1), "Increasing times.")
          .optional("values", &Result::values, list_of(constant, 1), "One value for each time.")
          .optional("smooth", &Text::smooth, boolean(),
                    "Whether the value goes smoothly from entry to entry, with zero slope and "
                    "curvature at each: by 10 u^3 - 15 u^4 + 6 u^5 of the change after the share u "
                    "of the time.")
          .optional("sine", &Text::sine, sine_format(constant, "sine" + of_what),
                    "A sine at all times.")
          .either({{"times", "values"}, {"sine"}})
          .in_unit_of_the_key()
          .check(check_table<Text>));
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = constant.shape.unit;
  shape.parts = {constant.shape, table.shape};
  return {std::move(shape), [constant, table](const Shape& self, const Place& place,
                                              Diagnostics& diagnostics, Result& out) {
            if (place.value->mapping()) {
              Text text;
              const bool fine = table.read(place, diagnostics, text);
              out = completed(std::move(text));
              return fine;
            }
            if (place.value->sequence() && constant.shape.kind == Shape::Kind::Number) {
              report_expected(expected(self), place, diagnostics);
              return false;
            }
            Constant value{};
            if (!constant.read(place, diagnostics, value)) return false;
            out.times = {0.0};
            out.values = {std::move(value)};
            return true;
          }};
}

}  // namespace

Format<Series> series(const std::string& unit) {
  return constant_or_table<Series>(number(unit), "");
}

Format<VectorSeries> vector_series(const std::string& unit) {
  return constant_or_table<VectorSeries>(vector(unit), " of vectors");
}

Format<VectorSeries> space_vector_series(const std::string& unit) {
  return constant_or_table<VectorSeries>(space_vector(unit), " of vectors in space");
}

}  // namespace der::scenario
