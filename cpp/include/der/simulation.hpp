#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "der/assembly/assembler.hpp"
#include "der/assembly/pattern.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/model/elongation_limits.hpp"
#include "der/model/fields.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/model/turning_limits.hpp"
#include "der/scenario/reader.hpp"
#include "der/solvers/joint_rotations.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/solvers/newton.hpp"
#include "der/statics/continuation.hpp"
#include "der/statics/equilibrium.hpp"
#include "der/statics/modes.hpp"
#include "der/statics/out_of_plane.hpp"
#include "der/steppers/adaptive_stepper.hpp"
#include "der/steppers/energy_monitor.hpp"
#include "der/steppers/stability_monitor.hpp"
#include "der/steppers/step_plan.hpp"
#include "der/steppers/stepper.hpp"
#include "der/steppers/support_motion.hpp"

namespace der {

/// The cost of a run so far.
struct Counters {
  std::int64_t steps = 0;
  std::int64_t newton_iterations = 0;
  std::int64_t retried_steps = 0;   ///< equal steps that had to be done in smaller pieces
  std::int64_t rejected_steps = 0;  ///< adaptive steps that were too long for the tolerance
  std::int64_t most_pieces = 1;     ///< that `step: auto` would have done a step in

  static constexpr auto fields() {
    return std::make_tuple(field("steps", "", &Counters::steps),
                           field("newton_iterations", "", &Counters::newton_iterations),
                           field("retried_steps", "", &Counters::retried_steps),
                           field("rejected_steps", "", &Counters::rejected_steps),
                           field("most_pieces", "", &Counters::most_pieces));
  }
};
static_assert(lists_all_members<Counters>());

/// The lower triangle of a symmetric matrix over the free degrees of freedom, in compressed
/// columns.
struct SymmetricMatrix {
  const Pattern& pattern;
  Vector values;  ///< as many as `pattern` has nonzeros
};

/// One simulation: a scenario's model, its state, and the stepper that advances it. This is the
/// engine that der_run and Python both drive. Whatever throws leaves the state as it was.
class Simulation {
 public:
  /// Throws SceneError or Error where the scene cannot be simulated. A scene with `start_from` is
  /// still at its drawn shape (`apply_start`).
  explicit Simulation(Scenario scenario);
  /// One that shares with `like` what stays constant and is the same in both: of one scenario the
  /// whole model, of another one of the same structure the places of matrix entries. What `like`
  /// does meanwhile does not matter. Throws Error besides where the structures differ.
  Simulation(Scenario scenario, const Simulation& like);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Sets what messages advise where a program has written a number that is not finite.
  void set_recovery_hint(const char* advice) { way_out_ = advice; }

  /// Advances by one time step: of the scene's length, or, with a tolerance, of the length that the
  /// error allows. A step that fails is retried in smaller pieces, and one in which supports move
  /// far is done in such. Throws NotConvergedError or DivergedError; the state is then as before.
  /// Where the integrator creates too much energy that is a DivergedError ("unstable_motion") after
  /// the step, unless the scene allows it.
  void step();
  // Steps that are done for several simulations at once (lanes/member_groups.hpp).
  /// The time [s] at the end of the next step if it is a plain one: of equal steps, in one piece,
  /// from a state that no program has written into.
  [[nodiscard]] std::optional<double> end_of_plain_step() const;
  /// Enters such a step, which began at the present time. Its positions, velocities, accelerations
  /// and works may come later. True: `watch_energy` is due, for which the works have to be there.
  [[nodiscard]] bool enter_step(double end, int newton_iterations);
  /// Looks at the energies `now`. Throws DivergedError ("unstable_motion") as `step`.
  void watch_energy(const Energies& now);
  /// Says that the positions and velocities of the state are those of steps entered.
  void keep_steps() { energy_monitor_.begin(state_); }
  /// Whether a program has written positions or velocities since the last step, or numbers that are
  /// not finite.
  [[nodiscard]] bool has_external_writes() const;
  /// To be called before joints are read that a program may have moved: their rotations follow the
  /// positions that it has written.
  void follow_writes();

  /// Takes the present state as the start of a motion: of a new ledger, with no steps before it.
  void start_anew();
  /// Where a program, or the start of a run, has put the nodes.
  /// Nodes alone do not tell rotations that lag behind.
  void settle_rotations(JointRotations::Which which = JointRotations::Which::All);
  /// Enters the energy that the integrator has created by now into the state's audit; steps do so
  /// now and then.
  void audit_energy() { energy_monitor_.look(state_); }
  /// Advice where the time stepping is not good enough.
  [[nodiscard]] std::string advice_on_steps() const;
  /// Throws Error ("unstable_step") if the scene's step is too long for an explicit integrator at
  /// the present state, the start of a run.
  void check_first_step();
  /// Sets the time [s] that adaptive steps do not go beyond; at first the scene's duration.
  void set_horizon(double time) { horizon_ = time; }
  /// Sets `result` to the state at a time within the last adaptive step.
  void interpolate(double time, State& result) { adaptive_->interpolate(time, state_, result); }
  /// Replaces the state by the static equilibrium near it under the loads at the present time,
  /// velocities zero. One that is unstable is left for a stable one, unless `leave_saddles` is
  /// false. Throws NotConvergedError; Error if a position or an extra force is not finite.
  /// One of a planar model is tested against motion out of its plane. `beat` is called at least
  /// once an iteration of the search, here and below; what it throws ends the search, and the state
  /// is then as before.
  EquilibriumReport equilibrium(bool leave_saddles = true, const CancelCallback& beat = {});
  /// The same without that test, as the start of something else.
  EquilibriumReport settle(bool leave_saddles = true, const CancelCallback& beat = {});

  /// Sets what has a name in the scene, in place of its table: each component comes to its value
  /// evenly and stays there until it is set again. `name` is that of a load or support, or of one
  /// component, as "wall.x"; `values` are as many as it has components (`settable`), in their unit.
  /// They are reached at the end of the next step, or after the time `over` [s]; `equilibrium` and
  /// static scenes take them at once. Throws Error where nothing of that name can be set, where
  /// the load factor of an analysis scales it, and for values that do not fit.
  /// Curvatures that the mesh hardly resolves are a warning (`take_warnings`).
  void set(std::string_view name, const std::vector<double>& values,
           std::optional<double> over = std::nullopt);
  [[nodiscard]] bool has_warnings() const { return !warnings_.empty(); }
  /// Doubts found since the last call, in sentences: of `set`, one for each rod, once; of a shape
  /// that a program has written.
  [[nodiscard]] std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }
  /// Present values of what has a name, one for each component. Throws Error as `set`.
  [[nodiscard]] std::vector<double> value(std::string_view name) const;
  /// The thing that a name stands for. Throws Error as `set`.
  struct Settable {
    const NamedControl* whole = nullptr;
    /// The components that are meant: all of them, or one.
    const ControlComponent* begin = nullptr;
    const ControlComponent* end = nullptr;
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(end - begin); }
  };
  [[nodiscard]] const Settable& settable(std::string_view name) const;

  /// Sets what support number `support` prescribes, named or not: `component` is "x", "y", "z" [m]
  /// from the initial place, "angle" or "twist" [rad]. Otherwise as `set`.
  void prescribe(std::size_t support, const std::string& component, double value);
  /// The components that a support prescribes, one for each of its places. Throws Error if there is
  /// no such support.
  [[nodiscard]] std::vector<std::string> prescribed_components(std::size_t support) const;
  /// Present value of a component that a support prescribes. Throws Error if it does not.
  [[nodiscard]] double prescribed(std::size_t support, const std::string& component) const;

  /// The `count` modes of lowest frequency about the present state, which has to be an equilibrium
  /// (Error if not).
  [[nodiscard]] std::vector<Mode> modes(int count, const CancelCallback& beat = {});
  /// Growth rate [1/s] of the fastest motion of the present equilibrium out of the plane of a
  /// planar model; 0 if there is none, or if that is not tested.
  [[nodiscard]] double growth_rate_out_of_plane(const CancelCallback& beat = {});
  /// Linear buckling of the structure of a planar model out of its plane; nothing in space.
  /// `in_plane` is what `buckling` returned last.
  OutOfPlaneBuckling buckling_out_of_plane(const LinearBuckling& in_plane,
                                           const CancelCallback& beat = {});
  /// Why equilibria of the scene are not tested against motion out of their plane, as a clause;
  /// empty if they are, and where the model is one in space.
  [[nodiscard]] const std::string& not_tested_out_of_plane() const {
    return constants_->not_tested;
  }
  /// Replaces the state by the equilibrium without loads, and returns its linear buckling modes
  /// under the scene's loads. Throws NotConvergedError, and Error where that is not the scene's
  /// analysis.
  LinearBuckling buckling(int count, const CancelCallback& beat = {});
  /// Follows the equilibria of the scene along its load factor, from the equilibrium at the first
  /// value. Leaves the state there. Throws NotConvergedError, and Error where the scene's analysis
  /// is no continuation.
  std::vector<PathBranch> follow(const CancelCallback& beat = {});
  /// Shows a point of a path that `follow` has found, number `index` of all: the state is that of
  /// the point, at its load factor.
  void show(const PathPoint& point, std::int64_t index);

  /// Gradient [N] of the potential of elements and loads at the present state, over the free
  /// degrees of freedom: zero in an equilibrium.
  [[nodiscard]] Vector gradient() const;
  /// Hessian [N/m] of the same potential.
  [[nodiscard]] SymmetricMatrix hessian() const;
  /// The mass matrix [kg] over the free degrees of freedom.
  [[nodiscard]] SymmetricMatrix mass() const;

  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const Model& model() const { return model_; }
  /// Its vectors keep their memory for the life of the simulation, so views of them stay valid.
  [[nodiscard]] State& state() { return state_; }
  [[nodiscard]] const State& state() const { return state_; }
  /// A copy of the state to go back to. What a program has written is entered first, as by the next
  /// step, so that a simulation with the copy goes on as this one.
  [[nodiscard]] State save();
  /// Goes back (or forward) to a state copied earlier, without moving the vectors' memory. Throws
  /// Error if it is not one of such a model.
  void restore(const State& saved);
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] bool adaptive() const { return adaptive_.has_value(); }
  /// The longest adaptive step that this simulation has done [s]; 0 for equal ones.
  [[nodiscard]] double longest_step() const { return adaptive_ ? adaptive_->longest_step() : 0.0; }
  [[nodiscard]] const StepPlan& plan() const { return plan_; }
  /// Whether the scene's duration is reached; a static scene always is there.
  [[nodiscard]] bool finished() const;
  [[nodiscard]] const StepperInfo& integrator() const { return stepper_info_; }
  [[nodiscard]] const Assembler& assembler() const { return *assembler_; }
  [[nodiscard]] const Pattern& pattern() const { return *pattern_; }
  [[nodiscard]] std::string_view linear_solver() const { return solver_.solver->name(); }
  [[nodiscard]] const std::string& linear_solver_reason() const { return solver_.reason; }

 private:
  /// The scene, and all that follows from it alone.
  struct Constants {
    explicit Constants(Scenario scene);
    const Scenario scenario;
    const Model model;
    const std::map<std::string, Settable, std::less<>> settable;  // parts of `model`, by name
    const std::string not_tested;                                 // out of the plane
  };
  Simulation(std::shared_ptr<const Constants> constants, const Simulation* like);
  static std::shared_ptr<const Constants> constants_like(Scenario scenario, const Simulation& like);
  [[nodiscard]] std::shared_ptr<const Assembler> assembler_like(const Simulation* like) const;

  void check_values(const Settable& found, const std::vector<double>& values, double end);
  /// Why a control cannot come to a value at the time `end` [s], as the end of a sentence; empty if
  /// it can.
  [[nodiscard]] std::string why_not(Index control, double value, double end);
  /// The same of the sum of elongations.
  [[nodiscard]] std::string why_too_short(const Ramp& ramp);
  /// Throws Error if curvatures would turn edges by half a turn; enters a warning of a coarse mesh.
  void check_turns(const Settable& found, const std::vector<double>& values, double end);
  /// Throws Error if what programs have set and tables leave an edge without length at the end of
  /// the next step, or turn edges by half a turn.
  void check_rest_shape();
  /// Time [s] at which a value that is set now is reached.
  [[nodiscard]] double end_of_ramp(std::optional<double> over) const;
  /// Lets a control come to `value` at the time `end` [s].
  void drive(Index control, double value, double end);
  /// Time [s] at the end of the next step of equal ones.
  [[nodiscard]] double next_time() const;
  void advance_to(double target);
  double stable_piece(double left, double whole, double dt);
  void advance_adaptively();
  [[nodiscard]] std::int64_t audit_stride() const;
  [[nodiscard]] bool is_audit_due(bool was_finished) const;
  [[noreturn]] void fail(const StepReport& report, double dt);
  /// The first position, velocity or extra force that is not a finite number, as a program may have
  /// written it, in words; empty if there is none.
  [[nodiscard]] std::string find_nonfinite() const;
  void check_finite_state() const;
  /// Enters what a program has written since the last step in the frames and the audit.
  void enter_writes();
  /// Warns, once, of a held node that a program has written away from its support.
  void warn_of_held_nodes();
  /// Moves what a state follows to the shape that a program has written into it.
  void follow_written_shape(State& state, const CancelCallback& beat);
  /// The forces at the present state.
  struct Forces {
    Configuration here;
    Vector external;  ///< [N]
    Vector gradient;  ///< [N] of the elements' energies
    /// Over the free degrees of freedom [N].
    [[nodiscard]] Vector unbalanced(const Model& model) const;
  };
  [[nodiscard]] Forces forces() const;
  /// Moves `found` to the equilibrium of legs of order 2, if there is one: edges that know their
  /// arcs take Newton's method from less far. Does nothing where the legs are of order 2. Returns
  /// how many saddles the search has left.
  int approach(const EquilibriumOptions& options, State& found);
  /// Made when it is first asked for; null where there is none. It calls `beat` from now on.
  OutOfPlaneTest* out_of_plane_test(const CancelCallback& beat);
  [[nodiscard]] std::string describe_failure(const StepReport& report, double dt) const;
  [[nodiscard]] std::string describe_inaccuracy(const AdaptiveReport& report) const;
  [[nodiscard]] std::string describe_unstable_motion() const;
  [[nodiscard]] std::string describe_divergence(const StepReport& report, double dt);

  std::shared_ptr<const Constants> constants_;
  const Scenario& scenario_;
  const Model& model_;
  ElongationLimits elongation_limits_;
  TurningLimits turning_limits_;
  std::vector<std::string> warnings_;  // not taken yet
  bool told_of_held_nodes_ = false;
  std::set<std::string> coarse_rods_;  // that there was a warning of
  std::shared_ptr<const Pattern> pattern_;
  LinearSolverChoice solver_;
  std::shared_ptr<const Assembler> assembler_;
  std::unique_ptr<OutOfPlaneTest> out_of_plane_;
  struct SecondOrder;
  std::shared_ptr<SecondOrder> second_order_;  // made when it is first asked for
  const StepperInfo& stepper_info_;
  std::unique_ptr<Stepper> stepper_;
  std::optional<StabilityMonitor> stability_;  // of explicit steppers
  EnergyMonitor energy_monitor_;
  StepPlan plan_;
  std::optional<AdaptiveStepper> adaptive_;
  SupportMotion support_motion_;
  double horizon_ = 0.0;
  const char* way_out_ = "write one there, or begin again with a new simulation";
  State state_;
  State before_step_;  // to go back to from a step that fails
  Counters counters_;
};

}  // namespace der
