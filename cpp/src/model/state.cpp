#include "der/model/state.hpp"

#include <type_traits>

#include "der/assembly/element_energy.hpp"
#include "der/model/model.hpp"
#include "der/supports/supports.hpp"

namespace der {

State initial_state(const Model& model) {
  State state;
  state.positions = model.initial_positions;
  state.velocities = model.initial_velocities;
  state.extra_force.setZero(model.num_dofs());
  state.accelerations.setZero(model.num_dofs());
  Vector controls;
  model.controls.evaluate(0.0, controls);
  place_held(model, controls, state.positions);
  return state;
}

Energies energies(const Model& model, const State& state) {
  Vector controls;
  model.controls.evaluate(state.time, state.ramps, controls);
  return energies(model, controls, state.positions, state.velocities);
}

Energies energies(const Model& model, const Vector& controls, const Vector& positions,
                  const Vector& velocities) {
  Energies result;
  result.kinetic = model.mass.kinetic_energy(velocities);
  result.gravity = -model.gravity_force.dot(positions);
  for_each_list(model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    const double energy = element_energy(list, controls, positions);
    if constexpr (Kernel::kTerm == EnergyTerm::Stretch) result.stretch += energy;
    if constexpr (Kernel::kTerm == EnergyTerm::Bend) result.bend += energy;
    if constexpr (Kernel::kTerm == EnergyTerm::Spring) result.spring += energy;
  });
  return result;
}

std::array<double, kEnergyNames.size()> by_name(const Energies& energies) {
  return {energies.kinetic, energies.stretch, energies.bend, energies.spring, energies.gravity};
}

void forget_steps(State& state) {
  state.accelerations.setZero();
  state.last_step = 0.0;
  state.history.clear();
  state.next_step = 0.0;
  state.last_error = 0.0;
}

void start_ledger(const Model& model, State& state) {
  state.work = {};
  state.audit = {};
  const Energies start = energies(model, state);
  state.work.start = start.total();
  state.audit.exchanged = start.kinetic;
}

double numerical_loss(const Work& work, const Energies& now) {
  return work.start + work.loads + work.supports + work.solver - work.drag - now.total();
}

std::array<double, kLedgerNames.size()> ledger(const Work& work, const Energies& now) {
  return {work.loads, work.supports, work.drag, numerical_loss(work, now), work.solver};
}

}  // namespace der
