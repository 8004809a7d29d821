#include "scenario/scene_text.hpp"
#include "scenario/table.hpp"

namespace der::scenario {

Format<AxialSpring> axial_spring_format() {
  return mapping(
      Table<AxialSpring>("spring between joints",
                         "A spring along the line between two joints, and a damper beside it.")
          .required("name", &AxialSpring::name, name(), "Name of the spring.")
          .required("between", &AxialSpring::between, list_of(name(), 2),
                    "Names of the two joints. A joint of one rod names a point of it.")
          .required("stiffness", &AxialSpring::stiffness, number("N/m", not_negative()),
                    "Force per change of its length; 0 for a damper alone.")
          .optional("rest_length", &AxialSpring::rest_length, series("m"),
                    "Length without a force, that of a tendon or a muscle also over time.",
                    "the distance between the joints as drawn")
          .optional("damping", &AxialSpring::damping, number("N s/m", not_negative()),
                    "Force per rate of its length.", "0"));
}

}  // namespace der::scenario
