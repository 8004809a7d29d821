#include "der/catalog/quantities.hpp"

#include <algorithm>

namespace der {

const std::vector<Quantity>& quantities() {
  using Kind = QuantityKind;
  static const std::vector<Quantity> table{
      {"x", "m", Kind::Position, "horizontal position"},
      {"y", "m", Kind::Position, "vertical position"},
      {"vx", "m/s", Kind::Velocity, "horizontal velocity"},
      {"vy", "m/s", Kind::Velocity, "vertical velocity"},
      {"speed", "m/s", Kind::Velocity, "magnitude of the velocity"},
      {"turning_angle", "rad", Kind::Turn,
       "angle from the edge before a node to the edge after it, positive counter-clockwise"},
      {"curvature", "1/m", Kind::Bend, "turning angle per length"},
      {"moment", "N m", Kind::Bend, "bending moment, positive where it bends counter-clockwise"},
      {"strain", "", Kind::Edge, "elongation per rest length"},
      {"tension", "N", Kind::Edge, "axial force, positive in tension"},
      {"kinetic_energy", "J", Kind::Energy, "energy of motion"},
      {"elastic_energy", "J", Kind::Energy, "energy of stretching, bending and springs"},
      {"stretch_energy", "J", Kind::Energy, "energy of stretching"},
      {"bend_energy", "J", Kind::Energy, "energy of bending"},
      {"spring_energy", "J", Kind::Energy, "energy of spring supports"},
      {"gravity_energy", "J", Kind::Energy, "potential energy of the weight, zero at the origin"},
      {"total_energy", "J", Kind::Energy, "kinetic, elastic and gravity energy together"},
  };
  return table;
}

const Quantity* find_quantity(std::string_view name) {
  const auto& table = quantities();
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const Quantity& quantity) { return quantity.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace der
