#include "der/model/state.hpp"

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "der/model/gravity.hpp"
#include "der/model/model.hpp"
#include "der/model/moment_place.hpp"
#include "der/model/prescribed_motion.hpp"

namespace der {
State initial_state(const Model& model) {
  State state;
  state.positions = model.initial_positions;
  state.velocities = model.initial_velocities;
  state.extra_force.setZero(model.num_dofs());
  state.accelerations.setZero(model.num_dofs());
  Vector controls;
  model.tables.evaluate(0.0, controls);
  apply_prescribed_motion(model, controls, state.positions);
  // Supports that are elsewhere at time 0 have come there on a way that nothing tells.
  state.followed = unwrapped_of_reference(model);
  return state;
}

void evaluate_controls(const Model& model, const State& state, double time, Vector& controls) {
  if (model.load_variation) {
    controls = model.load_variation->controls.at(state.load_factor);
  } else {
    model.tables.evaluate(time, controls);
  }
  for (const Ramp& ramp : state.ramps) controls[ramp.control] = ramp.at(time);
  model.natural_strain.enter(controls);
  enter_followed(model, state.followed, controls);
}

void follow(const Model& model, State& state) {
  if (state.followed.size() == 0) return;
  Vector controls;
  evaluate_controls(model, state, state.time, controls);
  follow(model, state.positions, controls, state.followed);
}

const Ramp* find_ramp(const State& state, Index control) {
  const auto found = std::find_if(state.ramps.begin(), state.ramps.end(),
                                  [control](const Ramp& ramp) { return ramp.control == control; });
  return found == state.ramps.end() ? nullptr : &*found;
}

double control_value(const Model& model, const State& state, Index control) {
  return control_value(model, state, control, state.time);
}

double control_value(const Model& model, const State& state, Index control, double time) {
  if (const Ramp* ramp = find_ramp(state, control)) return ramp->at(time);
  if (!model.load_variation) return value_at(model.tables[control], time);
  return model.load_variation->controls.at(state.load_factor)[control];
}

void configuration_of(const Model& model, const State& state, Configuration& here) {
  here.coordinates = state.positions;
  here.load_factor = state.load_factor;
  evaluate_controls(model, state, state.time, here.controls);
}

Configuration configuration_of(const Model& model, const State& state) {
  Configuration here;
  configuration_of(model, state, here);
  return here;
}

Energies energies(const Model& model, const State& state) {
  return energies(model, configuration_of(model, state), state.velocities);
}

Energies energies(const Model& model, const Configuration& here, const Vector& velocities) {
  Energies result;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (is_recorded(Kernel::kTerm)) result[Kernel::kTerm] += element_energy(list, here);
  });
  for (const RodMesh& rod : model.rods) {
    result += cell_energies(rod, model, here);
  }
  result[EnergyTerm::Kinetic] = model.mass.kinetic_energy(velocities);
  result[EnergyTerm::Gravity] = gravity_energy(model, here);
  return result;
}

void forget_steps(State& state) {
  state.accelerations.setZero();
  state.last_step = 0.0;
  state.memory = NoMemory{};
  state.next_step = 0.0;
  state.last_error = 0.0;
}

void start_ledger(const Model& model, State& state) {
  state.work = {};
  state.audit = {};
  const Energies start = energies(model, state);
  state.work.start = start.total();
  state.audit.exchanged = start[EnergyTerm::Kinetic];
}

double numerical_loss(const Work& work, const Energies& now) {
  return work.start + work.loads + work.supports + work.actuation + work.solver - work.drag -
         now.total();
}

std::array<double, kLedger.size()> ledger(const Work& work, const Energies& now) {
  std::array<double, kLedger.size()> values{};
  for (std::size_t row = 0; row < values.size(); ++row) values[row] = kLedger[row].value(work, now);
  return values;
}

}  // namespace der
