#include "der/lanes/member_stepper.hpp"

#include <algorithm>
#include <utility>

#include "der/core/sum_of.hpp"
#include "der/model/dimension.hpp"

namespace der {

template <class T>
MemberStepper<T>::MemberStepper(const Tableau& tableau, const Model& structure,
                                MemberStage<T> stage)
    : tableau_(tableau),
      stage_(std::move(stage)),
      start_force_(tableau.explicit_first ? structure.num_dofs() : 0),
      start_gradient_(tableau.explicit_first ? structure.num_dofs() : 0),
      couple_(tableau.explicit_first && structure.has_sections() ? structure.num_dofs() : 0),
      past_displacement_(structure.num_dofs()),
      past_velocities_(structure.num_dofs()),
      end_positions_(structure.num_dofs()),
      end_velocities_(structure.num_dofs()),
      displacement_(structure.num_dofs()) {
  for (Index i = 0; i < tableau.stages; ++i) {
    velocities_.emplace_back(structure.num_dofs());
    accelerations_.emplace_back(structure.num_dofs());
  }
}

template <class T>
void MemberStepper<T>::serve(Members<T>& members) {
  members_ = &members;
  stage_.serve(members);
}

template <class T>
LaneSet MemberStepper<T>::step(LaneSet lanes, const T& dt, MemberState<T>& state) {
  iterations_.fill(0);
  begin(state, dt);
  for (Index i = 0; i < tableau_.stages; ++i) {
    if (!tableau_.is_implicit(i)) {
      evaluate_start(state, dt);
      set_displacement(i, state, dt);
      accumulate_start();
      continue;
    }
    pose_stage(i, state, dt);
    lanes = stage_.solve(lanes);
    lanes = lanes.without(members_->frames.turned_too_far(stage_.coordinates, state.frames));
    if (lanes.empty()) return lanes;
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      iterations_[to_size(lane)] += stage_.iterations(lane);
    }
    set_rates(i, dt);
    set_displacement(i, state, dt);
    accumulate_stage();
  }
  set_end(state, dt);
  lanes = lanes.without(folded());
  finish(lanes, dt, state);
  return lanes;
}

template <class T>
void MemberStepper<T>::begin(const MemberState<T>& state, const T& dt) {
  work_ = state.work;
  stage_.origin = &state.positions;
  stage_.frames = &state.frames;
  members_->controls.begin_step(dt, tableau_);
  members_->controls.evaluate(dt, 0.0);
  if (!members_->frames.empty()) members_->assembler.follow_frames();
  driven_gravity_ = members_->controls.driven_gravity_energy(state.positions);
  run_member_loop<T>(
      [&] { std::copy_n(state.positions.data(), end_positions_.size(), end_positions_.data()); });
  members_->controls.evaluate(dt, 1.0);
  members_->controls.hold(end_positions_);
}

/// The first stage of a method that begins with an explicit one (ExplicitForce).
template <class T>
void MemberStepper<T>::evaluate_start(const MemberState<T>& state, const T& dt) {
  MemberVector<T>& acceleration = accelerations_[0];
  members_->controls.evaluate(dt, 0.0);
  members_->controls.set_force(state.extra_force, start_force_);
  members_->assembler.gradient(state.positions, state.frames, start_gradient_);
  const bool has_sections = couple_.size() > 0;
  MemberVector<T>& velocities = velocities_[0];
  run_member_loop<T>([&] {
    for (Index i = 0; i < velocities.size(); ++i) velocities[i] = state.velocities[i];
    for (const HeldDof& held : members_->model.structure().held) {
      const Index i = held.dof;
      const T mean = (end_positions_[i] - state.positions[i]) / dt;
      velocities[i] = members_->controls.held_velocity(held, dt, 0.0, mean);
    }
    if (has_sections) {
      std::fill_n(couple_.data(), couple_.size(), T(0.0));
      members_->frames.take_transport(state.positions, state.frames, start_gradient_);
      members_->frames.add_gyroscopic(
          state.positions, [&](Index dof) { return velocities[dof]; }, couple_);
    }
    for (Index i = 0; i < acceleration.size(); ++i) {
      acceleration[i] =
          start_force_[i] - start_gradient_[i] - members_->model.damping[i] * velocities[i];
    }
    if (!has_sections) return;
    for (Index i = 0; i < acceleration.size(); ++i) {
      acceleration[i] += couple_[i];
      start_gradient_[i] -= couple_[i];
    }
  });
  members_->mass->solve(acceleration);
}

template <class T>
void MemberStepper<T>::pose_stage(Index stage, const MemberState<T>& state, const T& dt) {
  const T g = tableau_.diagonal * dt;
  stage_.inertia = 1.0 / (g * g);
  stage_.velocity_factor = 1.0 / g;
  const MemberVector<T>& guess =
      stage == 0 ? state.accelerations : accelerations_[to_size(stage - 1)];
  members_->controls.enter_stage(stage);
  members_->controls.evaluate(dt, tableau_.time(stage));
  members_->controls.set_force(state.extra_force, stage_.force);
  std::array<T, to_size(Tableau::kMaxStages)> weights;
  for (Index j = 0; j < stage; ++j) {
    weights[to_size(j)] = dt * tableau_.below[to_size(stage)][to_size(j)];
  }
  run_member_loop<T>([&] {
    for (Index i = 0; i < past_displacement_.size(); ++i) {
      T displacement = 0.0;
      T velocity = state.velocities[i];
      for (Index j = 0; j < stage; ++j) {
        displacement += weights[to_size(j)] * velocities_[to_size(j)][i];
        velocity += weights[to_size(j)] * accelerations_[to_size(j)][i];
      }
      past_displacement_[i] = displacement;
      past_velocities_[i] = velocity;
      stage_.coordinates[i] = state.positions[i] + displacement + g * velocity + g * g * guess[i];
    }
  });
  members_->controls.hold(stage_.coordinates);
  run_member_loop<T>([&] {
    for (const HeldDof& held : members_->model.structure().held) {
      const Index i = held.dof;
      const T mean = (end_positions_[i] - state.positions[i]) / dt;
      past_displacement_[i] = stage_.coordinates[i] - state.positions[i] -
                              g * members_->controls.stage_velocity(held, mean);
    }
    for (Index i = 0; i < past_displacement_.size(); ++i) {
      stage_.inertia_target[i] = past_displacement_[i] + g * past_velocities_[i];
      stage_.velocity_reference[i] = past_displacement_[i];
    }
  });
}

/// The velocities and accelerations of the stage solved last.
template <class T>
void MemberStepper<T>::set_rates(Index stage, const T& dt) {
  const T g = tableau_.diagonal * dt;
  const T rate = 1.0 / g;
  run_member_loop<T>([&] {
    for (Index i = 0; i < past_displacement_.size(); ++i) {
      const T velocity = (stage_.displacement()[i] - past_displacement_[i]) * rate;
      velocities_[to_size(stage)][i] = velocity;
      accelerations_[to_size(stage)][i] = (velocity - past_velocities_[i]) * rate;
    }
  });
}

/// The contribution of a stage to the motion of the step (stage_displacement).
template <class T>
void MemberStepper<T>::set_displacement(Index stage, const MemberState<T>& state, const T& dt) {
  const double share = tableau_.weights[to_size(stage)];
  const MemberVector<T>& velocities = velocities_[to_size(stage)];
  run_member_loop<T>([&] {
    const T weight = share * dt;
    for (Index i = 0; i < displacement_.size(); ++i) displacement_[i] = weight * velocities[i];
    for (const HeldDof& held : members_->model.structure().held) {
      displacement_[held.dof] = share * (end_positions_[held.dof] - state.positions[held.dof]);
    }
  });
}

template <class T>
void MemberStepper<T>::accumulate_start() {
  const MemberVector<T>& velocities = velocities_[0];
  run_member_loop<T>([&] {
    work_.loads += sum_of<T>(displacement_.size(), [&](Index i) {
      return displacement_[i] * (start_force_[i] - members_->model.gravity_force[i]);
    });
    work_.drag += sum_of<T>(displacement_.size(), [&](Index i) {
      return displacement_[i] * (members_->model.damping[i] * velocities[i]);
    });
    for (const HeldDof& held : members_->model.structure().held) {
      const Index i = held.dof;
      work_.drag -= displacement_[i] * members_->model.damping[i] * velocities[i];
      work_.supports += displacement_[i] * (start_gradient_[i] - start_force_[i]);
    }
  });
}

/// ImplicitStage::accumulate.
template <class T>
void MemberStepper<T>::accumulate_stage() {
  const MemberVector<T>& moved = stage_.displacement();
  const MemberVector<T>& residual = stage_.residual();
  const Model& structure = members_->model.structure();
  run_member_loop<T>([&] {
    work_.loads += sum_of<T>(displacement_.size(), [&](Index i) {
      return displacement_[i] * (stage_.force[i] - members_->model.gravity_force[i]);
    });
    if (structure.damped) {
      work_.drag += stage_.velocity_factor * sum_of<T>(displacement_.size(), [&](Index i) {
                      return displacement_[i] * (members_->model.damping[i] *
                                                 (moved[i] - stage_.velocity_reference[i]));
                    });
    }
    for (const HeldDof& held : structure.held) {
      const Index i = held.dof;
      const T inertial =
          stage_.inertia * members_->model.lumped[i] * (moved[i] - stage_.inertia_target[i]);
      const T drag = stage_.velocity_factor * members_->model.damping[i] *
                     (moved[i] - stage_.velocity_reference[i]);
      work_.drag -= displacement_[i] * drag;
      work_.supports += displacement_[i] * (residual[i] - inertial - drag);
    }
    const std::vector<Index>& free = structure.dofs.free();
    work_.solver += sum_of<T>(structure.num_free(), [&](Index i) {
      const Index dof = free[to_size(i)];
      return displacement_[dof] * residual[dof];
    });
  });
}

template <class T>
void MemberStepper<T>::set_end(const MemberState<T>& state, const T& dt) {
  const Index last = tableau_.stages - 1;
  run_member_loop<T>([&] {
    if (tableau_.stiffly_accurate()) {
      for (Index i = 0; i < end_positions_.size(); ++i) {
        end_positions_[i] = stage_.coordinates[i];
        end_velocities_[i] = velocities_[to_size(last)][i];
      }
      return;
    }
    for (Index i = 0; i < end_velocities_.size(); ++i) {
      displacement_[i] = T(0.0);
      end_velocities_[i] = state.velocities[i];
    }
    for (Index j = 0; j <= last; ++j) {
      const T weight = dt * tableau_.weights[to_size(j)];
      for (Index i = 0; i < end_velocities_.size(); ++i) {
        displacement_[i] += weight * velocities_[to_size(j)][i];
        end_velocities_[i] += weight * accelerations_[to_size(j)][i];
      }
    }
    for (const Index dof : members_->model.structure().dofs.free()) {
      end_positions_[dof] = state.positions[dof] + displacement_[dof];
    }
  });
}

/// The members in which two neighbouring edges are at more than a right angle: whether one has
/// folded over (EnergyMonitor) is for its simulation to see.
template <class T>
LaneSet MemberStepper<T>::folded() const {
  const std::vector<Edge>& edges = members_->model.structure().edges;
  T folded = 0.0;
  run_member_loop<T>([&] {
    with_dimension(members_->model.structure(), [&](auto dim) {
      for (std::size_t i = 1; i < edges.size(); ++i) {
        if (edges[i - 1].last != edges[i].first) continue;
        const T cosine = along_edge<dim>(edges[i - 1], end_positions_)
                             .dot(along_edge<dim>(edges[i], end_positions_));
        folded += 1.0 - T::is_positive(cosine);
      }
    });
  });
  return LaneSet::where(folded);
}

/// StepCommit::finish.
template <class T>
void MemberStepper<T>::finish(LaneSet done, const T& dt, MemberState<T>& state) {
  const T is_done = done.mask<T>();
  const auto take = [&](T& here, const T& there) { here = T::select(is_done, there, here); };
  const MemberVector<T>& last = accelerations_[to_size(tableau_.stages - 1)];
  members_->controls.enter_stage(-1);
  members_->controls.evaluate(dt, 1.0);
  const T driven_gravity = members_->controls.driven_gravity_energy(end_positions_);
  run_member_loop<T>([&] {
    work_.loads += driven_gravity - driven_gravity_;
    for (const HeldDof& held : members_->model.structure().held) {
      const Index i = held.dof;
      const T before = state.velocities[i];
      const T mean = (end_positions_[i] - state.positions[i]) / dt;
      const T after = members_->controls.held_velocity(held, dt, 1.0, mean);
      const T drag = members_->model.damping[i] * mean * mean * dt;
      work_.drag += drag;
      work_.supports += drag + 0.5 * members_->model.lumped[i] * (after * after - before * before);
      end_velocities_[i] = after;
    }
    for (Index i = 0; i < end_positions_.size(); ++i) {
      take(state.positions[i], end_positions_[i]);
      take(state.velocities[i], end_velocities_[i]);
      take(state.accelerations[i], last[i]);
    }
    take(state.work.loads, work_.loads);
    take(state.work.supports, work_.supports);
    take(state.work.drag, work_.drag);
    take(state.work.solver, work_.solver);
  });
  members_->frames.follow(done, state.positions, state.frames);
}

#define DER_INSTANTIATE(T) template class MemberStepper<T>;
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
