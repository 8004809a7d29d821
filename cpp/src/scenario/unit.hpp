#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace der::scenario {

/// A unit as products and quotients of those of the SI: `mm`, `N m^2`, `kg/m^3`, `deg/m`, `1/cm`.
/// A number in it is one of the SI after a shift of its decimal point and, for angles and times,
/// a factor.
struct Unit {
  std::array<int, 4> powers{};  ///< of m, kg, s, rad
  int decimals = 0;             ///< the decimal point moves to the right by so many digits
  double numerator = 1.0;       ///< a number is multiplied by numerator/denominator ...
  double denominator = 1.0;     ///< ... which are not powers of ten

  /// Whether both measure the same: an angle, such as `rad/m`, is not the pure number of `1/m`, as
  /// a frequency in Hz is not an angular one in rad/s.
  [[nodiscard]] bool same_kind(const Unit& other) const { return powers == other.powers; }
};

/// Reads the text of a unit; nothing if it is none. Powers are written `m^2`, `m2` or `m²`;
/// products have a blank, `*` or `·`. A product after a quotient, as in `N/m s`, is none: it is
/// read in two ways.
std::optional<Unit> read_unit(std::string_view text);

}  // namespace der::scenario
