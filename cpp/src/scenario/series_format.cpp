#include "scenario/table.hpp"

namespace der::scenario {
namespace {

/// Times that increase, and a value for each.
template <class Table>
void check_table(const Table& table, const Place& place, Diagnostics& diagnostics) {
  const Mapping& entries = *place.value->mapping();
  const Place times = place.at(*find_entry(entries, "times"));
  for (std::size_t i = 1; i < table.times.size(); ++i) {
    if (table.times[i] > table.times[i - 1]) continue;
    diagnostics.add(times.at(static_cast<int>(i), (*times.value->sequence())[i]),
                    fmt::format("times must increase, but {} s follows {} s", table.times[i],
                                table.times[i - 1]));
    return;
  }
  if (table.times.size() != table.values.size()) {
    diagnostics.add(place.at(*find_entry(entries, "values")),
                    fmt::format("a table needs one value for each of its {} times, got {}",
                                table.times.size(), table.values.size()));
  }
}

/// A constant or a table: `Constant` is the type of one value, `Result` that of the series.
template <class Result, class Constant>
Format<Result> constant_or_table(const Format<Constant>& constant, const std::string& name) {
  const Format<Result> table = mapping(
      Table<Result>(name,
                    "A value over time: linear between the times of the list, constant "
                    "before the first and after the last.")
          .required("times", &Result::times, list_of(number("s"), 1), "Increasing times.")
          .required("values", &Result::values, list_of(constant, 1), "One value for each time.")
          .in_unit_of_the_key()
          .check(check_table<Result>));
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = constant.shape.unit;
  shape.parts = {constant.shape, table.shape};
  return {std::move(shape), [constant, table](const Shape& self, const Place& place,
                                              Diagnostics& diagnostics, Result& out) {
            if (place.value->mapping()) return table.read(place, diagnostics, out);
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
  return constant_or_table<Series>(number(unit), "table");
}

Format<VectorSeries> vector_series(const std::string& unit) {
  return constant_or_table<VectorSeries>(vector(unit), "table of vectors");
}

Format<VectorSeries> space_vector_series(const std::string& unit) {
  return constant_or_table<VectorSeries>(space_vector(unit), "table of vectors in space");
}

}  // namespace der::scenario
