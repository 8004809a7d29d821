#include "der/statics/equilibrium.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/loads/external_force.hpp"
#include "der/model/edge_change.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/statics/potential.hpp"
#include "der/statics/rigid_motion.hpp"
#include "der/supports/clamp.hpp"
#include "statics/equilibrium/dynamic_relaxation.hpp"
#include "statics/equilibrium/free_spin.hpp"
#include "statics/equilibrium/load_raising.hpp"
#include "statics/equilibrium/load_steps.hpp"
#include "statics/equilibrium/moving_supports.hpp"
#include "statics/equilibrium/polishing.hpp"
#include "statics/equilibrium/pseudo_transient.hpp"
#include "statics/equilibrium/restarts.hpp"
#include "statics/equilibrium/saddles.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"
#include "statics/equilibrium/static_newton.hpp"
#include "statics/equilibrium/winding.hpp"

namespace der::statics {
namespace {

/// Saddles left in a row before the search gives up; each has a lower potential than the one
/// before.
constexpr int kMaxSaddles = 30;
/// Fraction of the acting forces that a neutral equilibrium may leave unbalanced.
constexpr double kUnbalanced = 1e-3;

StaticLoads loads_of(const Model& model, const State& state) {
  const Configuration here = configuration_of(model, state);
  StaticLoads loads{here.controls, {}};
  external_force(model, here, state.extra_force, loads.force);
  return loads;
}

/// The controls at which the shape of a state was found: those of its clamps in space that a
/// program has set since are where they were. A planar shape tells them itself.
Vector controls_of_shape(const Model& model, const State& state, Vector controls) {
  if (model.dimension != 3) return controls;
  for_each_turning_control(model, [&](Index control) {
    if (const Ramp* ramp = find_ramp(state, control)) controls[control] = ramp->from;
  });
  return controls;
}

/// An equilibrium that changes no edge by more than this [rad] is near the shape that the search
/// began with: nothing nearer is looked for.
constexpr double kNear = 0.25;

/// The forces of all loads in a shape [N].
Vector acting_forces(const Model& model, const StaticLoads& loads, const Shape& shape) {
  Vector forces = loads.force;
  add_circulatory_forces(circulatory_loads(*model.elements), loads.at(model, shape), 1.0, forces);
  return forces;
}

/// Whether the structure moved or turned without end: other methods then would, too.
bool is_unbounded(const FailedSearch& failed) {
  return failed.cause == EquilibriumFailure::DriftsAway ||
         failed.cause == EquilibriumFailure::TurnsWithoutEnd;
}

bool may_come_from_rounding(EquilibriumFailure cause) {
  return cause == EquilibriumFailure::LostInRoundoff || cause == EquilibriumFailure::NewtonFailed ||
         cause == EquilibriumFailure::StepsUsedUp;
}

/// What a planar rod turns by less or more than the clamps and springs along it that count whole
/// turns, if that is more than half a turn [rad]: at a node or clamp of a coarse mesh it has been
/// lost. Joints have rotations of their own.
double lost_turn(const Model& model, const Shape& shape) {
  if (model.dimension != 2) return 0.0;
  double largest = 0.0;
  const auto turn_to = [](const Vec2& from, const Vec2& to) { return angle_between(from, to); };
  for (const RodMesh& rod : model.rods) {
    std::vector<double> turned{0.0};  // each edge against the first one, from the drawn shape on
    for (Index edge = 1; edge < rod.num_edges(); ++edge) {
      const Edge before = rod.edge(edge - 1, model);
      const Edge after = rod.edge(edge, model);
      turned.push_back(
          turned.back() +
          turn_to(along_edge(before, shape.positions), along_edge(after, shape.positions)) -
          turn_to(along_edge(before, model.initial_positions),
                  along_edge(after, model.initial_positions)));
    }
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    const auto count = [&](Index edge, double turn) {  // what the first edge has turned by then
      least = std::min(least, turn - turned[to_size(edge)]);
      most = std::max(most, turn - turned[to_size(edge)]);
    };
    for (const Clamp& clamp : rod.clamps) {
      const Index beside = edge_beside(rod, clamp.place);
      const Edge edge = rod.edge(beside, model);
      count(beside, clamp.followed >= 0 ? shape.followed[clamp.followed]
                                        : turn_to(along_edge(edge, model.initial_positions),
                                                  along_edge(edge, shape.positions)));
    }
    for (const MomentPlace& place : rod.moment_places) {
      if (place.followed >= 0) count(place.first_edge, shape.followed[place.followed]);
    }
    if (most - least > kPi) largest = std::max(largest, most - least);
  }
  return largest;
}

/// Tries the methods in their order, and keeps count of what they did.
class EquilibriumSearch {
 public:
  EquilibriumSearch(const Model& model, const Assembler& assembler, LinearSolver& solver,
                    const EquilibriumOptions& options, const State& state)
      : EquilibriumSearch(model, assembler, solver, options, state, loads_of(model, state),
                          has_potential(*model.elements)) {
    if (has_potential_) return;
    const StaticLoads none = scaled(model, loads_, 0.0);
    unloaded_.reset(new EquilibriumSearch(model, assembler, solver, options, state, none, true));
  }

  EquilibriumReport run(State& state) {
    Shape shape{state.positions, state.followed};
    if (unloaded_ && (leave_saddles_ || !move_nearby(shape))) start_without_loads(shape);
    report_.failed = search(shape);
    if (report_.failed) blame_weak_holding(state, *report_.failed);
    if (report_.failed) blame_free_spin(*report_.failed);
    report_.newton_iterations += newton_.iterations();
    report_.relaxations += continuation_.steps() + relaxation_steps_;
    report_.force_scale = newton_.force_scale();
    if (!report_.failed) {
      state.positions = std::move(shape.positions);
      state.followed = std::move(shape.followed);
    }
    return report_;
  }

 private:
  EquilibriumSearch(const Model& model, const Assembler& assembler, LinearSolver& solver,
                    const EquilibriumOptions& options, const State& state, StaticLoads loads,
                    bool have_potential)
      : model_(model),
        leave_saddles_(options.leave_saddles),
        has_potential_(have_potential),
        loads_(std::move(loads)),
        start_(controls_of_shape(model, state, loads_.controls)),
        newton_(model, assembler, solver, options.newton,
                Admissibility(model, loads_.force, state.positions), options.beat),
        stiffness_(model, assembler, solver, options.beat),
        continuation_(model, newton_) {}

  /// For loads without a potential: moves to the equilibrium near the shape, if there is one.
  bool move_nearby(Shape& shape) {
    Shape nearby = shape;
    apply_prescribed_motion(model_, loads_.controls, nearby.positions);
    if (newton_.balance(loads_, nearby, StaticNewton::LineSearch::Never) ||
        largest_edge_change(model_, nearby.positions - shape.positions) > kNear) {
      return false;
    }
    shape = std::move(nearby);
    return true;
  }

  /// For loads without a potential: moves to the equilibrium without loads, from which they are
  /// raised. It is the one that a scene without these loads has, if there are several. Without one,
  /// as of a rod that the loads hold, the search begins at the shape as it is.
  void start_without_loads(Shape& shape) {
    Shape found = shape;
    if (!unloaded_->search(found)) {
      shape = std::move(found);
      start_ = loads_.controls;
    }
    report_.newton_iterations = unloaded_->newton_.iterations();
    report_.relaxations = unloaded_->continuation_.steps() + unloaded_->relaxation_steps_;
  }

  std::optional<FailedSearch> search(Shape& shape) {
    const Vector forces = acting_forces(model_, loads_, shape);
    if (std::string unheld = find_unheld_part(model_, forces); !unheld.empty()) {
      return FailedSearch{EquilibriumFailure::NotHeld, std::move(unheld)};
    }
    const std::vector<double> whole_turns = move_supports(
        model_, loads_, start_,
        [this](const auto& loads, Shape& moved) { equilibrate(loads, moved); }, shape);
    newton_.measure_drift_from(shape.positions);
    if (auto failed = find_any(shape)) return failed;
    if (auto failed = find_stable(shape)) return failed;
    if (!whole_turns.empty() &&
        planar_whole_turns(model_, loads_.at(model_, shape)) != whole_turns) {
      return FailedSearch{EquilibriumFailure::FoldedByClamp, {}};
    }
    return std::nullopt;
  }

  /// Replaces the cause of a failure where a part is hardly held against a rigid motion.
  void blame_weak_holding(const State& state, FailedSearch& failed) {
    if (!may_come_from_rounding(failed.cause)) return;
    const Configuration start = configuration_of(model_, state);
    stiffness_.evaluate(start);
    std::string found = find_weakly_held_part(model_, start, stiffness_.rounding());
    if (!found.empty()) failed = {EquilibriumFailure::HeldTooWeakly, std::move(found)};
  }

  /// Replaces the cause of a failure to follow a path on which a rod turns about itself.
  void blame_free_spin(FailedSearch& failed) {
    if (failed.cause != EquilibriumFailure::PathLost) return;
    std::string found = find_free_spin(model_);
    if (!found.empty()) failed = {EquilibriumFailure::NotHeld, std::move(found)};
  }

  /// Inverse of the first pseudo-time step [N/m].
  [[nodiscard]] double inverse_step() const { return newton_.force_scale() / model_.size(); }

  /// Newton's method, then pseudo-transient continuation from where it started.
  std::optional<FailedSearch> find_near(const StaticLoads& loads, Shape& shape) {
    if (!has_potential_) return raise_loads(model_, loads, newton_, continuation_, shape);
    return leave_saddles_ ? find_downhill(loads, shape) : find_nearest(loads, shape);
  }

  std::optional<FailedSearch> find_downhill(const StaticLoads& loads, Shape& shape) {
    if (!newton_.balance(loads, shape)) return std::nullopt;
    return continuation_.run(loads, inverse_step(), shape).failed;
  }

  /// A way downhill leaves an unstable equilibrium, however near it is. So plain Newton steps
  /// come first, and the nearer one of both answers counts.
  std::optional<FailedSearch> find_nearest(const StaticLoads& loads, Shape& shape) {
    const auto change = [&](const Shape& to) {
      return largest_edge_change(model_, to.positions - shape.positions);
    };
    Shape plain = shape;
    const bool found = !newton_.balance(loads, plain, StaticNewton::LineSearch::Never);
    Shape lower = shape;
    std::optional<FailedSearch> failed;
    if (!found || change(plain) > kNear) {
      failed = find_downhill(loads, lower);
      if (!found || (!failed && change(lower) <= change(plain))) {
        shape = std::move(lower);
        return failed;
      }
    }
    shape = std::move(plain);
    stiffness_.evaluate(loads.at(model_, shape));
    const Stability stability = stiffness_.stability();
    if (stability.neutral_directions > 0 && stability.unstable_directions == 0) {
      // Plain steps wander along neutral directions, and steps downhill do not.
      lower = shape;
      if (!newton_.balance(loads, lower) && change(lower) <= kNear) shape = std::move(lower);
    }
    return std::nullopt;
  }

  /// Moves a shape on the way of the supports to the stable equilibrium near it, if there is one.
  void equilibrate(const StaticLoads& loads, Shape& shape) {
    if (find_near(loads, shape) || !has_potential_) return;
    stiffness_.evaluate(loads.at(model_, shape));
    if (leave_saddles_ && stiffness_.stability().unstable_directions > 0) {
      go_down(loads, shape);
    }
  }

  bool go_down(const StaticLoads& loads, Shape& shape) {
    if (!leave_saddle(model_, loads, newton_, continuation_, stiffness_, shape)) return false;
    ++report_.saddles_left;
    return true;
  }

  /// Finds an equilibrium, stable or not, by the first method that succeeds. The failure of the
  /// first two says more than that of the others.
  std::optional<FailedSearch> find_any(Shape& shape) {
    const Shape start = shape;
    auto failed = find_near(loads_, shape);
    if (!failed || !has_potential_ || is_unbounded(*failed)) return failed;
    shape = start;
    if (step_loads(model_, loads_, newton_.force_scale(), continuation_, shape) ||
        relax_dynamically(model_, loads_, newton_, stiffness_, shape, relaxation_steps_) ||
        start_elsewhere(shape)) {
      return std::nullopt;
    }
    return failed;
  }

  bool start_elsewhere(Shape& shape) {
    for (Shape& restart : restarts(model_, loads_, stiffness_, shape)) {
      if (!continuation_.run(loads_, inverse_step(), restart).failed) {
        shape = std::move(restart);
        return true;
      }
    }
    return false;
  }

  /// Assesses an equilibrium, and leaves it for a lower one as long as it is a saddle.
  std::optional<FailedSearch> find_stable(Shape& shape) {
    int left = 0;
    for (;;) {
      if (auto failed = assess(shape)) return failed;
      if (!leave_saddles_ || report_.stability.unstable_directions == 0) return std::nullopt;
      if (left == kMaxSaddles || !go_down(loads_, shape)) {
        return FailedSearch{EquilibriumFailure::OnlySaddles, {}};
      }
      ++left;
    }
  }

  /// At nodes, or what a coarse mesh has lost between them [rad].
  [[nodiscard]] double sharpest_turn(const Shape& shape) const {
    return std::max(largest_turning_angle(model_, shape.positions), lost_turn(model_, shape));
  }

  /// Enters stability, residual and largest turning angle of an equilibrium into the report, and
  /// polishes the equilibrium. Fails if round-off hides it. Without a potential there is no verdict
  /// on stability, and Newton's method had the exact tangent.
  std::optional<FailedSearch> assess(Shape& shape) {
    Configuration here = loads_.at(model_, shape);
    stiffness_.evaluate(here);
    if (!has_potential_) {
      report_.stability.judged = false;
      report_.residual = model_.dofs.largest_free_force(loads_.force - stiffness_.gradient());
      report_.largest_turning_angle = sharpest_turn(shape);
      return std::nullopt;
    }
    report_.stability = stiffness_.stability();
    const bool neutral = report_.stability.neutral_directions > 0;
    bool resolved = neutral || polish(model_, loads_.force, report_.stability, stiffness_, here);
    shape.positions = std::move(here.coordinates);
    report_.residual = model_.dofs.largest_free_force(loads_.force - stiffness_.gradient());
    // A Newton step is meaningless in a neutral equilibrium, so the forces must be in balance.
    // Those of a structure without loads may be no more than the rounding errors of its elements.
    double unbalanced = kUnbalanced * newton_.force_scale();
    if (is_unloaded(model_, loads_)) {
      unbalanced = std::max(unbalanced, stiffness_.rounding() * model_.size());
    }
    if (neutral && report_.residual > unbalanced) resolved = false;
    report_.largest_turning_angle = sharpest_turn(shape);
    if (resolved) return std::nullopt;
    return FailedSearch{EquilibriumFailure::LostInRoundoff, {}};
  }

  const Model& model_;
  const bool leave_saddles_;
  const bool has_potential_;  // of the loads: what goes downhill, and stability, needs one
  const StaticLoads loads_;
  Vector start_;  // controls at which the shape was found
  StaticNewton newton_;
  Stiffness stiffness_;
  PseudoTransient continuation_;
  int relaxation_steps_ = 0;  // of the dynamic relaxation
  std::unique_ptr<EquilibriumSearch>
      unloaded_;  // the same without loads, if they have no potential
  EquilibriumReport report_;
};

}  // namespace
}  // namespace der::statics

namespace der {

EquilibriumReport find_equilibrium(const Model& model, const Assembler& assembler,
                                   LinearSolver& solver, const EquilibriumOptions& options,
                                   State& state) {
  return statics::EquilibriumSearch(model, assembler, solver, options, state).run(state);
}

}  // namespace der
