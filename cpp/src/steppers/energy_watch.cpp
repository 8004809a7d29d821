#include "der/steppers/energy_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace der {
namespace {

// Shares of the energy exchanged.
constexpr double kDoubtful = 0.05;
constexpr double kUnstable = 0.5;
/// Of the energy held: what is less is rounding.
constexpr double kRounding = 1e-10;
/// Strain of all edges whose energy is rounding, in a structure at rest too.
constexpr double kRoundingStrain = 1e-10;

double strain_energy(const Model& model, double strain) {
  double energy = 0.0;
  for (const RodLayout& rod : model.rods) {
    energy += 0.5 * rod.EA * strain * strain * rod.rest_length();
  }
  return energy;
}

std::string times_text(double share) {
  if (share < 1.0) return fmt::format("{:.0f} % of", 100.0 * share);
  if (share < 1.5) return "as much as";
  if (share < 2.5) return "twice";
  return fmt::format("{:.2g} times", share);
}

}  // namespace

EnergyWatch::EnergyWatch(const Model& model)
    : model_(model),
      rounding_(strain_energy(model, kRoundingStrain)),
      controls_(Vector::Zero(model.controls.size())),
      positions_(Vector::Zero(model.num_dofs())),
      velocities_(Vector::Zero(model.num_dofs())) {}

void EnergyWatch::begin(const State& state) { after_step(state); }

void EnergyWatch::before_step(State& state) {
  if (state.positions == positions_ && state.velocities == velocities_) return;
  evaluate_controls(model_, state, state.time, controls_);
  const double before = energies(model_, controls_, positions_, velocities_).total();
  state.audit.written +=
      energies(model_, controls_, state.positions, state.velocities).total() - before;
}

void EnergyWatch::after_step(const State& state) {
  positions_ = state.positions;
  velocities_ = state.velocities;
}

void EnergyWatch::look(State& state) {
  evaluate_controls(model_, state, state.time, controls_);
  const Energies now = energies(model_, controls_, state.positions, state.velocities);
  const Work& work = state.work;
  EnergyAudit& audit = state.audit;
  const double created = -numerical_loss(work, now) - audit.written;
  const double out_of_nothing = std::max(created, 0.0);
  audit.exchanged =
      std::max({audit.exchanged, now.kinetic - out_of_nothing, work.drag - out_of_nothing,
                std::abs(work.loads), std::abs(work.supports)});
  const double held = std::abs(work.start) + now.kinetic + now.elastic() + std::abs(now.gravity);
  if (!(created > std::max(kRounding * held, rounding_))) return;
  audit.created = std::max(audit.created, created);
  if (audit.unreliable_from < 0.0 && is_doubtful(audit)) audit.unreliable_from = state.time;
}

bool is_doubtful(const EnergyAudit& audit) { return audit.created > kDoubtful * audit.exchanged; }

bool is_unstable(const EnergyAudit& audit) { return audit.created > kUnstable * audit.exchanged; }

std::string describe(const EnergyAudit& audit) {
  return fmt::format(
      "the integrator created {:.2g} J, {} the energy exchanged in the run ({:.2g} J)",
      audit.created, times_text(audit.created / audit.exchanged), audit.exchanged);
}

}  // namespace der
