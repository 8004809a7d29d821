#include "scenario/axis_stiffness.hpp"

#include <algorithm>

namespace der::scenario {

namespace {

Format<Components> one_or_each(const Format<double>& both, const Format<Components>& each,
                               const std::string& example) {
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = both.shape.unit;
  shape.parts = {both.shape, each.shape};
  return {
      std::move(shape), [both, each, example](const Shape& /*self*/, const Place& place,
                                              Diagnostics& diagnostics, Components& out) {
        if (!place.value->sequence()) {
          double stiffness = 0.0;
          if (!both.read(place, diagnostics, stiffness)) return false;
          out = {stiffness, stiffness, stiffness};
          return true;
        }
        if (!each.read(place, diagnostics, out)) return false;
        const bool negative = std::any_of(out.begin(), out.end(), [](double k) { return k < 0; });
        const bool none = std::all_of(out.begin(), out.end(), [](double k) { return k == 0; });
        if (negative)
          diagnostics.add(place,
                          "a stiffness must not be negative: write 0 for an axis without one");
        if (none)
          diagnostics.add(place, "one of the stiffnesses must be greater than 0, as in " + example);
        return !negative && !none;
      }};
}

}  // namespace

Format<Components> axis_stiffness(const std::string& unit) {
  return one_or_each(number(unit, positive()), vector(unit), "[0, 50]");
}

Format<Components> section_stiffness(const std::string& unit) {
  return one_or_each(number(unit, positive()), section_triple(unit), "[0, 50, 0]");
}

}  // namespace der::scenario
