#include "der/lanes/member_stage.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "der/solvers/newton_step.hpp"
#include "solvers/stage_kernels.hpp"

namespace der {

template <class T>
MemberStage<T>::MemberStage(const Model& structure, MemberBand<T> band)
    : inertia_target(structure.num_dofs()),
      velocity_reference(structure.num_dofs()),
      force(structure.num_dofs()),
      coordinates(structure.num_dofs()),
      band_(std::move(band)),
      displacement_(structure.num_dofs()),
      residual_(structure.num_dofs()),
      direction_(structure.num_free()),
      step_(structure.num_dofs()),
      acceleration_(structure.num_dofs()) {}

template <class T>
LaneSet MemberStage<T>::solve(LaneSet lanes) {
  LaneSet solved;
  iterations_.fill(0);
  run_member_loop<T>([&] {
    for (Index i = 0; i < displacement_.size(); ++i) {
      displacement_[i] = coordinates[i] - (*origin)[i];
    }
  });
  external_ = members_->model.largest_force(force);
  evaluate_system();
  measure();
  while (true) {
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      const int limit =
          std::min(kFullStepIterations, members_->newton[to_size(lane)].max_iterations);
      if (iterations_[to_size(lane)] >= limit || !std::isfinite(largest_residual_.lane(lane))) {
        lanes.remove(lane);
      }
    }
    if (!lanes.empty()) lanes = find_step(lanes);
    if (lanes.empty()) return solved;
    const T residual_before = largest_residual_;
    move(lanes);
    bool have_system = false;
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      if (!lanes.has(lane)) continue;
      ++iterations_[to_size(lane)];
      have_system |= length_.lane(lane) > kNearSolution * members_->model.size.lane(lane);
    }
    if (have_system) {
      evaluate_system();
    } else {
      evaluate_residual();
    }
    measure();

    const LaneSet converged = find_converged(lanes, residual_before, have_system);
    solved.add(converged);
    lanes = lanes.without(converged);
    if (lanes.empty()) return solved;
    if (!have_system) evaluate_system();
    members_->assembler.use_predicted_tension(coordinates, step_, band_.values());
  }
}

/// The lanes in which the last step was the last one. Where the residual is compared with that of
/// rounding, the values are no longer those of the `system`.
template <class T>
LaneSet MemberStage<T>::find_converged(LaneSet lanes, const T& residual_before, bool& have_system) {
  std::optional<T> largest_coordinate;
  std::optional<T> rounding;
  LaneSet converged;
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    if (!lanes.has(lane)) continue;
    const NewtonStep step{length_.lane(lane), change_.lane(lane), residual_before.lane(lane),
                          largest_residual_.lane(lane)};
    const NewtonOptions& options = members_->newton[to_size(lane)];
    const auto [is_short, is_stalled] =
        progress_of(step, options.step_tolerance, members_->model.size.lane(lane), [&] {
          if (!largest_coordinate) {
            largest_coordinate = members_->model.largest_motion(coordinates);
          }
          return rounding_of(largest_coordinate->lane(lane));
        });
    if (!is_short && !is_stalled) continue;
    if (is_short && step.residual <= options.residual_tolerance * acting_.lane(lane)) {
      converged.add(lane);
      continue;
    }
    if (!rounding) rounding = residual_rounding();
    have_system = false;
    if (step.residual <= rounding_of(rounding->lane(lane))) converged.add(lane);
  }
  return converged;
}

/// The forces whose rounding errors are those of the residual (StageProblem::residual_rounding).
template <class T>
T MemberStage<T>::residual_rounding() {
  const MemberModel<T>& model = members_->model;
  const auto largest_term = [&](const MemberVector<T>& diagonal) {
    run_member_loop<T>([&] {
      for (Index i = 0; i < acceleration_.size(); ++i) {
        acceleration_[i] = diagonal[i] * displacement_[i];
      }
    });
    return model.largest_force(acceleration_);
  };
  members_->assembler.system(T(0.0), coordinates, *frames, acceleration_, band_.values());
  const T elastic = members_->assembler.largest_elastic_force(coordinates, band_.values());
  return elastic + inertia * largest_term(model.lumped) +
         velocity_factor * largest_term(model.damping);
}

template <class T>
void MemberStage<T>::evaluate_residual() {
  members_->assembler.gradient(coordinates, *frames, residual_);
  add_stage_forces();
}

template <class T>
void MemberStage<T>::evaluate_system() {
  members_->assembler.system(inertia, coordinates, *frames, residual_, band_.values());
  add_stage_forces();
  if (members_->model.structure().damped)
    members_->assembler.add_damping(velocity_factor, band_.values());
}

template <class T>
void MemberStage<T>::add_stage_forces() {
  const auto larger = [](const T& a, const T& b) { return T::larger_magnitude(a, b); };
  run_member_loop<T>([&] {
    const auto velocity = [&](Index dof) {
      return velocity_factor * (displacement_[dof] - velocity_reference[dof]);
    };
    members_->frames.take_spin_forces(coordinates, *frames, velocity, residual_);
    acting_ = external_;
    const auto add_diagonal = [&](const auto& block, const T& factor,
                                  const MemberVector<T>& diagonal, const MemberVector<T>& target) {
      const Index i = block.first;
      const T largest =
          add_lumped_inertia(block.count, factor, diagonal.data() + i, displacement_.data() + i,
                             target.data() + i, acceleration_.data() + i, residual_.data() + i);
      acting_ = larger(acting_, largest / block.length);
    };
    for (const auto& block : members_->model.blocks) {
      const T largest =
          subtract_force(block.count, force.data() + block.first, residual_.data() + block.first);
      acting_ = larger(acting_, largest / block.length);
    }
    for (const auto& block : members_->model.blocks) {
      add_diagonal(block, inertia, members_->model.lumped, inertia_target);
    }
    const auto& couplings = members_->model.structure().mass.coupling;
    for (std::size_t i = 0; i < couplings.size(); ++i) {
      const auto& [a, b, mass] = couplings[i];
      const T inertial =
          members_->model.coupling[static_cast<Index>(i)] * (acceleration_[a] - acceleration_[b]);
      residual_[a] -= inertial;
      residual_[b] += inertial;
    }
    if (!members_->model.structure().damped) return;
    for (const auto& block : members_->model.blocks) {
      add_diagonal(block, velocity_factor, members_->model.damping, velocity_reference);
    }
  });
}

template <class T>
void MemberStage<T>::measure() {
  largest_residual_ = members_->model.largest_free_force(residual_);
}

/// Sets the step; returns the lanes in which there is one.
template <class T>
LaneSet MemberStage<T>::find_step(LaneSet lanes) {
  const std::vector<Index>& free = members_->model.structure().dofs.free();
  run_member_loop<T>([&] {
    for (std::size_t i = 0; i < free.size(); ++i) {
      direction_[static_cast<Index>(i)] = -residual_[free[i]];
    }
  });
  const T positive = band_.factorize_and_solve(direction_);
  run_member_loop<T>([&] {
    for (std::size_t i = 0; i < free.size(); ++i) {
      step_[free[i]] = direction_[static_cast<Index>(i)];
    }
  });
  length_ = members_->model.largest_motion(step_);
  const T change = members_->model.largest_edge_change(step_);
  T share = 1.0;
  bool is_shortened = false;
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    if (positive.lane(lane) == 0.0 || !std::isfinite(length_.lane(lane))) lanes.remove(lane);
    const StepBound bound = bound_of_change(change.lane(lane));
    share.set_lane(lane, bound.share);
    change_.set_lane(lane, bound.change);
    is_shortened |= bound.share < 1.0;
  }
  if (!is_shortened) return lanes;
  run_member_loop<T>([&] {
    for (Index i = 0; i < step_.size(); ++i) step_[i] *= share;
    length_ *= share;
  });
  return lanes;
}

template <class T>
void MemberStage<T>::move(LaneSet lanes) {
  const T goes_on = lanes.mask<T>();
  run_member_loop<T>([&] {
    for (Index i = 0; i < displacement_.size(); ++i) {
      displacement_[i] = T::select(goes_on, displacement_[i] + step_[i], displacement_[i]);
    }
    for (const Index dof : members_->model.structure().dofs.free()) {
      coordinates[dof] = (*origin)[dof] + displacement_[dof];
    }
  });
}

#define DER_INSTANTIATE(T) template class MemberStage<T>;
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
