#include "der/model/control_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "der/core/error.hpp"

namespace der {
namespace {

bool same_kind(const ControlName& a, const ControlName& b) {
  return a.component == b.component && a.unit == b.unit;
}

std::string kind_of(const ControlName& each) {
  return each.unit.empty() ? each.component : fmt::format("{} [{}]", each.component, each.unit);
}

/// The first of `these` whose name none of `others` has; null: there is none.
const ControlName* first_unknown(const std::vector<ControlName>& these,
                                 const std::vector<ControlName>& others) {
  const auto found = std::find_if(these.begin(), these.end(), [&](const ControlName& each) {
    return std::none_of(others.begin(), others.end(),
                        [&](const ControlName& other) { return other.name == each.name; });
  });
  return found == these.end() ? nullptr : &*found;
}

/// The difference between the scene of a state and another one, in words; empty: none.
std::string difference(const std::vector<ControlName>& of_state,
                       const std::vector<ControlName>& here) {
  if (const ControlName* each = first_unknown(of_state, here)) {
    return fmt::format("the state has '{}' ({}), which this scene lacks", each->name,
                       kind_of(*each));
  }
  if (const ControlName* each = first_unknown(here, of_state)) {
    return fmt::format("this scene has '{}' ({}), which that of the state lacks", each->name,
                       kind_of(*each));
  }
  const std::size_t common = std::min(of_state.size(), here.size());
  for (std::size_t i = 0; i < common; ++i) {
    if (of_state[i].name != here[i].name) {
      return fmt::format("'{}' of the state stands in the place of '{}' of this scene",
                         of_state[i].name, here[i].name);
    }
    if (!same_kind(of_state[i], here[i])) {
      return fmt::format("'{}' of the state is {}, and here {}", here[i].name, kind_of(of_state[i]),
                         kind_of(here[i]));
    }
  }
  if (of_state.size() != here.size()) {
    const bool more = of_state.size() > here.size();
    return fmt::format("'{}' has more components in {}", (more ? of_state : here).back().name,
                       more ? "the state" : "this scene");
  }
  for (std::size_t i = 0; i < common; ++i) {
    if (of_state[i].control == here[i].control) continue;
    return fmt::format("'{}' acts on another rod, or other tables without a name stand before it",
                       here[i].name);
  }
  return {};
}

}  // namespace

std::vector<ControlName> control_names(const Model& model) {
  std::vector<ControlName> names;
  for (const PrescribedControl& each : model.prescribed) {
    names.push_back({fmt::format("support {}", each.support), each.component, "", each.control});
  }
  for (const NamedControl& each : model.named) {
    for (const ControlComponent& component : each.components) {
      names.push_back({each.name, component.name, component.unit, component.controls.front()});
    }
  }
  return names;
}

void check_control_names(const Model& model, const std::vector<ControlName>& of_state) {
  const std::string what = difference(of_state, control_names(model));
  if (what.empty()) return;
  throw Error("model_error",
              what +
                  ": a state can only be restored into a simulation of the same rods and "
                  "supports, whose loads and actuations have the same names in the same order");
}

}  // namespace der
