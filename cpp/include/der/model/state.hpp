#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/energies.hpp"
#include "der/model/fields.hpp"
#include "der/model/ramp.hpp"
#include "der/model/stepper_memory.hpp"

namespace der {

struct Model;

/// The energy at the start of a run, and the works done since [J] (docs/energy.md).
struct Work {
  double start = 0.0;      ///< energy at the start, of all kinds
  double loads = 0.0;      ///< done by forces and moments but for weight
  double supports = 0.0;   ///< done by supports that move
  double actuation = 0.0;  ///< done by changes of the rest shape
  double drag = 0.0;       ///< taken by drag and linear damping
  double solver = 0.0;     ///< done by the residual forces that the solver leaves

  static constexpr auto fields() {
    return std::make_tuple(field("start", "J", &Work::start), field("loads", "J", &Work::loads),
                           field("supports", "J", &Work::supports),
                           field("actuation", "J", &Work::actuation),
                           field("drag", "J", &Work::drag), field("solver", "J", &Work::solver));
  }
};
static_assert(lists_all_members<Work>());

/// Energy that the time integrator has created, and energy that the run has exchanged, as far as
/// `EnergyMonitor` has checked.
struct EnergyAudit {
  double exchanged = 0.0;     ///< [J] largest value so far
  double created = 0.0;       ///< [J] largest value so far
  double written = 0.0;       ///< [J] put in by a program that wrote positions or velocities
  double folded_from = -1.0;  ///< [s] when a node first turned through half a turn; negative: never
  double folded_node = -1.0;  ///< its number
  double unreliable_from = -1.0;  ///< [s] when one of these first was too much; negative: never

  static constexpr auto fields() {
    return std::make_tuple(field("exchanged", "J", &EnergyAudit::exchanged),
                           field("created", "J", &EnergyAudit::created),
                           field("written", "J", &EnergyAudit::written),
                           field("folded_from", "s", &EnergyAudit::folded_from),
                           field("folded_node", "", &EnergyAudit::folded_node),
                           field("unreliable_from", "s", &EnergyAudit::unreliable_from));
  }
};
static_assert(lists_all_members<EnergyAudit>());

/// Version of saved states, in checkpoints and pickles; states of another version are refused.
/// Increase it when a field keeps its name but changes its meaning.
constexpr std::int64_t kStateVersion = 4;

/// Everything that changes in a run. A plain value: copy it to save it, assign it to go back, bit
/// for bit. Vectors have one entry a degree of freedom. A new member is written here and in
/// `fields`, and nowhere else.
struct State {
  double time = 0.0;      ///< [s]
  std::int64_t step = 0;  ///< steps of the scene done
  /// Factor of the loads and motions that the scene varies, if any (Model::load_variation); 1: as
  /// written.
  double load_factor = 1.0;
  Vector positions;    ///< [m]
  Vector velocities;   ///< [m/s]
  Vector extra_force;  ///< [N] set from outside (a controller); constant during a step
  /// [m/s^2] as the stepper knows it: part of the method for some, a better first guess for others.
  Vector accelerations;
  double last_step = 0.0;  ///< [s] length of the last step; 0: no step yet, `accelerations` not set
  StepperMemory memory;    ///< what the stepper remembers besides
  /// [s] proposed length of the next step, or of the pieces of explicit steps: by the error
  /// control, or by the stability limit; 0: not known.
  double next_step = 0.0;
  double last_error = 0.0;  ///< of the last adaptive step, over what it was allowed
  Work work;
  EnergyAudit audit;
  std::vector<Ramp> ramps;  ///< controls that a program has set, in place of their tables
  /// Whole turns and frames of edges at the last step or equilibrium (model/followed.hpp).
  Vector followed;

  static constexpr auto fields() {
    return std::make_tuple(
        field("time", "s", &State::time, Values::NotNegative),
        field("step", "", &State::step, Values::NotNegative),
        field("load_factor", "", &State::load_factor, Values::Finite),
        field("positions", "m", &State::positions, Values::Any, Extent::Dofs),
        field("velocities", "m/s", &State::velocities, Values::Any, Extent::Dofs),
        field("extra_force", "N", &State::extra_force, Values::Any, Extent::Dofs),
        field("accelerations", "m/s^2", &State::accelerations, Values::Finite, Extent::Dofs),
        field("last_step", "s", &State::last_step, Values::NotNegative),
        field("memory", "", &State::memory),
        field("next_step", "s", &State::next_step, Values::NotNegative),
        field("last_error", "", &State::last_error, Values::NotNegative),
        field("work", "J", &State::work), field("audit", "", &State::audit),
        field("ramps", "", &State::ramps),
        field("followed", "", &State::followed, Values::Finite, Extent::Followed));
  }
};
static_assert(lists_all_members<State>());

/// The state at time 0.
State initial_state(const Model& model);

/// Throws Error if `state` cannot be one of the model: sizes, times, or supports that it moves.
/// Positions, velocities and forces may be any numbers, as a program may have written them.
void check_state(const Model& model, const State& state);

/// Describes the first number that is invalid in any state, whatever the model; empty if there is
/// none.
std::string find_wrong_value(const State& state);

/// Sets `controls` to what elements and supports follow besides the positions, at `time` [s] of a
/// step that begins at `state`: the tables, or their values at the load factor, the ramps in place
/// of them, and the turns.
void evaluate_controls(const Model& model, const State& state, double time, Vector& controls);
/// The ramp that a program has set in place of a control's table; null: none.
const Ramp* find_ramp(const State& state, Index control);
/// Moves what a state follows to its positions, which a program may have written.
void follow(const Model& model, State& state);
/// Value of a control that is not a turn, at the time of `state` or at another one [s].
double control_value(const Model& model, const State& state, Index control);
double control_value(const Model& model, const State& state, Index control, double time);
/// Sets `here` to the configuration of a state at its own time; allocates nothing if the sizes of
/// `here` are right already.
void configuration_of(const Model& model, const State& state, Configuration& here);
Configuration configuration_of(const Model& model, const State& state);

/// Energies of a state.
Energies energies(const Model& model, const State& state);
/// Energies at a configuration with these velocities; allocates nothing.
Energies energies(const Model& model, const Configuration& here, const Vector& velocities);

/// Discards what steppers remember of the steps so far; for a new motion.
void forget_steps(State& state);

/// Starts a new ledger and audit: nothing has gone in or out yet.
void start_ledger(const Model& model, State& state);

/// Energy [J] that the time integrator has dissipated since the start: the energy at the start and
/// the works done on the system, less the present energy. Negative if the integrator created
/// energy.
double numerical_loss(const Work& work, const Energies& now);

/// One row of the ledger as it is recorded.
struct LedgerEntry {
  const char* name;
  double (*value)(const Work& work, const Energies& now);  ///< [J] since the start
};
/// The ledger as it is recorded: the works, with the numerical loss. Run files, summaries, exports
/// and Python follow this table.
inline constexpr std::array kLedger{
    LedgerEntry{"loads", [](const Work& work, const Energies&) { return work.loads; }},
    LedgerEntry{"supports", [](const Work& work, const Energies&) { return work.supports; }},
    LedgerEntry{"actuation", [](const Work& work, const Energies&) { return work.actuation; }},
    LedgerEntry{"drag", [](const Work& work, const Energies&) { return work.drag; }},
    LedgerEntry{"numerical", &numerical_loss},
    LedgerEntry{"solver", [](const Work& work, const Energies&) { return work.solver; }},
};
std::array<double, kLedger.size()> ledger(const Work& work, const Energies& now);

}  // namespace der
