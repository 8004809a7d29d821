#include "der/model/internal_damping.hpp"

#include <type_traits>
#include <utility>

#include "der/energies/registry.hpp"
#include "der/energies/strain_rate.hpp"
#include "der/model/prescribed_motion.hpp"

namespace der {
namespace {

/// Calls use(list, damped) for each element with internal damping.
template <class Use>
void for_each_damped(const Model& model, const Use& use) {
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (StrainRate<Kernel>::kExists) {
      for (const DampedElement& damped : list.damped) use(list, damped);
    }
  });
}

double turn_rate(const Model& model, const State& state, Index control, double from, double to,
                 double time) {
  const double change =
      control_value(model, state, control, to) - control_value(model, state, control, from);
  return control_rate(model, state, control, time, change / (to - from));
}

/// From when to when the last step went [s]; before the first one a short time from then on.
std::pair<double, double> last_motion(const State& state) {
  constexpr double kShort = 1e-6;
  if (state.last_step == 0.0) return {state.time, state.time + kShort};
  return {state.time - state.last_step, state.time};
}

}  // namespace

ElementCounts count_elements(const Model& model) {
  ElementCounts counts;
  for_each_list(*model.elements, [&](const auto& list) { counts.push_back(list.size()); });
  return counts;
}

void damp_elements(const DampingTimes& times, const ElementCounts& before, Model& model) {
  auto first = before.begin();
  for_each_list(*model.elements, [&](auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (StrainRate<Kernel>::kExists) {
      for (std::size_t e = *first; e < list.size(); ++e) {
        const Mat3 viscosity = StrainRate<Kernel>::viscosity(list.constants[e], times);
        if (!viscosity.isZero(0.0)) list.damped.push_back({e, viscosity});
      }
    }
    ++first;
  });
}

void add_viscous_forces(const Model& model, const Moving& moving, Vector& gradient) {
  for_each_damped(model, [&](const auto& list, const DampedElement& damped) {
    const auto term = viscous_term(list, damped, moving);
    const auto& dofs = list.dofs[damped.element];
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      gradient[dofs[i]] += term.gradient[static_cast<Index>(i)];
    }
  });
}

double driven_viscous_power(const Model& model, const Moving& moving) {
  double power = 0.0;
  if (moving.turn_rates.size() == 0) return power;
  for_each_damped(model, [&](const auto& list, const DampedElement& damped) {
    power += viscous_term(list, damped, moving).driven;
  });
  return power;
}

void set_turn_rates(const Model& model, const State& state, double from, double to, double time,
                    Vector& rates) {
  bool turns = false;
  const auto set = [&](Index control) {
    if (control < 0) return;
    if (!turns) rates.setZero(model.tables.size());
    turns = true;
    rates[control] = turn_rate(model, state, control, from, to, time);
  };
  for (const RodMesh& rod : model.rods) {
    if (!rod.damping.any()) continue;
    for (const Clamp& clamp : rod.clamps) {
      set(clamp.rotation);
      set(clamp.held.rotation);
      set(clamp.held.twist);
    }
  }
}

void set_turn_rates(const Model& model, const State& state, Vector& rates) {
  const auto [from, to] = last_motion(state);
  set_turn_rates(model, state, from, to, state.time, rates);
}

double turn_rate(const Model& model, const State& state, Index control) {
  const auto [from, to] = last_motion(state);
  return turn_rate(model, state, control, from, to, state.time);
}

}  // namespace der
