#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace der::scenario {

/// A value, or a clause that says what is wrong with the text and what to write (may be empty).
template <class T>
struct Reading {
  std::optional<T> value;
  std::string problem;
  bool had_unit = false;  ///< the value stands in the text in a unit that is written there
};

/// The form of a number with a unit, as a regular expression.
inline constexpr const char* kNumberWithUnitPattern =
    R"(^[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)? *(1?/)?[^0-9/. +-].*$)";

/// Numbers are decimal on purpose: an optional sign, digits with or without a point on either side
/// of them (`.5`, `5.`), an optional exponent (`1e-3`). Everything that YAML 1.1 or a programming
/// language would read differently (`010`, `0x1F`, `1_000`, `1:30`) is refused with a hint, as are
/// infinities, NaN, and values outside the range of a double.
///
/// `unit` is the unit of the key. A unit of the same kind may stand behind the number: `5 mm` is
/// the same double as `5e-3`.
Reading<double> read_real(std::string_view text, std::string_view unit);

/// Reads a whole number; `2.0` and `1e2` are refused with a hint.
Reading<std::int64_t> read_whole(std::string_view text);

/// Says what to write in place of a number with a decimal comma (`1,5`) or parted thousands
/// (`1,000,000`, `1.000.000`, `1 000`, `1.000,5`), as a clause; empty for another text.
std::string separator_problem(std::string_view text);
/// Commas part no more pieces than these of a number that is meant.
inline constexpr std::size_t kMostParts = 8;

/// Whether a text would be read as a number, or only just not (`010`, `.inf`).
bool looks_like_number(std::string_view text);

/// The shortest text that reads back to the same double, always with a point or an exponent.
std::string shortest(double value);

}  // namespace der::scenario
