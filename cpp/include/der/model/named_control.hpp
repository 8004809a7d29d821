#pragma once

#include <array>
#include <string>
#include <vector>

#include "der/core/types.hpp"

namespace der {

/// A number that a program can set, with the controls that follow it: several where a support holds
/// several nodes.
struct ControlComponent {
  std::string name;  ///< "x", "angle"
  std::string unit;  ///< SI
  std::vector<Index> controls;
};

/// Something in the scene that has a name and that a program can set (Simulation::set): a load, or
/// the prescribed motion of a support. A new kind of these adds one to Model::named where it is
/// built, with the tables that it follows; all else finds it there.
struct NamedControl {
  std::string name;
  /// Whether it is a vector, set as a list of its components; otherwise each has a meaning of its
  /// own.
  bool is_vector = false;
  std::vector<ControlComponent> components;
};

/// A vector along the axes, of the controls that are not -1.
NamedControl vector_control(const std::string& name, const std::string& unit,
                            const std::array<Index, 3>& controls);

}  // namespace der
