#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/fields.hpp"
#include "der/model/model.hpp"

namespace der {

/// A number that a program can set, as a saved state remembers it: what a state sets it knows by
/// the number of the control alone.
struct ControlName {
  std::string name;       ///< of the load, support or actuation; "support 0" of one without a name
  std::string component;  ///< "x", "natural_curvature"
  std::string unit;       ///< SI
  Index control = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        field("name", "", &ControlName::name), field("component", "", &ControlName::component),
        field("unit", "", &ControlName::unit), field("control", "", &ControlName::control));
  }
};
static_assert(lists_all_members<ControlName>());

/// All that programs can set in a model, in its order.
std::vector<ControlName> control_names(const Model& model);

/// Throws Error unless a state can be one of a model by what its own model could set: the same
/// names, of the same kinds and in the same order.
void check_control_names(const Model& model, const std::vector<ControlName>& of_state);

}  // namespace der
