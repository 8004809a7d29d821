#include "der/model/state.hpp"

#include <type_traits>

#include "der/energies/element_energy.hpp"
#include "der/model/model.hpp"
#include "der/model/moment_place.hpp"
#include "der/model/prescribed_motion.hpp"

namespace der {
namespace {

/// Zero at the origin [J].
double gravity_energy(const Model& model, double load_factor, const Vector& positions) {
  if (!model.load_variation) return -model.gravity_force.dot(positions);
  return -model.load_variation->gravity_force.at(load_factor).dot(positions);
}

}  // namespace

State initial_state(const Model& model) {
  State state;
  state.positions = model.initial_positions;
  state.velocities = model.initial_velocities;
  state.extra_force.setZero(model.num_dofs());
  state.accelerations.setZero(model.num_dofs());
  Vector controls;
  model.controls.evaluate(0.0, controls);
  apply_prescribed_motion(model, controls, state.positions);
  state.turns.setZero(static_cast<Index>(model.followed_edges.size()));
  follow_turns(model, state.positions, state.turns);
  return state;
}

void evaluate_controls(const Model& model, const State& state, double time, Vector& controls) {
  if (model.load_variation) {
    controls = model.load_variation->controls.at(state.load_factor);
  } else {
    model.controls.evaluate(time, controls);
  }
  for (const Ramp& ramp : state.ramps) controls[ramp.control] = ramp.at(time);
  enter_turns(model, state.turns, controls);
}

double control_value(const Model& model, const State& state, Index control) {
  for (const Ramp& ramp : state.ramps) {
    if (ramp.control == control) return ramp.at(state.time);
  }
  if (!model.load_variation) return value_at(model.controls[control], state.time);
  return model.load_variation->controls.at(state.load_factor)[control];
}

Energies energies(const Model& model, const State& state) {
  Vector controls;
  evaluate_controls(model, state, state.time, controls);
  return energies(model, state.load_factor, controls, state.positions, state.velocities);
}

Energies energies(const Model& model, double load_factor, const Vector& controls,
                  const Vector& positions, const Vector& velocities) {
  Energies result;
  result.kinetic = model.mass.kinetic_energy(velocities);
  result.gravity = gravity_energy(model, load_factor, positions);
  for_each_list(model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    const double energy = element_energy(list, controls, positions);
    if constexpr (Kernel::kTerm == EnergyTerm::Stretch) result.stretch += energy;
    if constexpr (Kernel::kTerm == EnergyTerm::Bend) result.bend += energy;
    if constexpr (Kernel::kTerm == EnergyTerm::Spring) result.spring += energy;
  });
  for (const RodLayout& rod : model.rods) {
    const CellEnergies cells = cell_energies(rod, model, controls, positions);
    result.bend += cells.bend;
    result.spring += cells.spring;
  }
  return result;
}

std::array<double, kEnergyNames.size()> by_name(const Energies& energies) {
  return {energies.kinetic, energies.stretch, energies.bend, energies.spring, energies.gravity};
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
  state.audit.exchanged = start.kinetic;
}

double numerical_loss(const Work& work, const Energies& now) {
  return work.start + work.loads + work.supports + work.solver - work.drag - now.total();
}

std::array<double, kLedgerNames.size()> ledger(const Work& work, const Energies& now) {
  return {work.loads, work.supports, work.drag, numerical_loss(work, now), work.solver};
}

}  // namespace der
