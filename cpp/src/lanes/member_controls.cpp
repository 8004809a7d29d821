#include "der/lanes/member_controls.hpp"

#include "der/model/prescribed_motion.hpp"

namespace der {

template <class T>
MemberControls<T>::MemberControls(const MemberModel<T>& model, const MemberStates<T>& states)
    : model_(model),
      states_(states),
      num_frames_(static_cast<Index>(model.structure().initial_frames.size())),
      has_tables_(model.structure().tables.size() > num_frames_) {
  for (std::size_t lane = 0; lane < states.size(); ++lane) {
    here_[lane].controls.setZero(model.structure().tables.size());
    stages_.emplace_back(*model.models[lane]);
  }
}

template <class T>
void MemberControls<T>::begin_step(const T& dt, const Tableau& tableau) {
  if (!has_tables_) return enter_frames();
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    stages_[to_size(lane)].begin_step(*states_[to_size(lane)], dt.lane(lane), tableau);
  }
}

template <class T>
void MemberControls<T>::enter_stage(Index stage) {
  for (StageControls& controls : stages_) controls.enter_stage(stage);
}

template <class T>
void MemberControls<T>::evaluate_at_states() {
  if (!has_tables_) return enter_frames();
  evaluate(0.0, 0.0);
}

/// They stay as they are to the end of a step.
template <class T>
void MemberControls<T>::enter_frames() {
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    here_[to_size(lane)].controls.head(num_frames_) = states_[to_size(lane)]->followed;
  }
}

template <class T>
void MemberControls<T>::evaluate(const T& dt, double share) {
  if (!has_tables_) return;
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    const State& state = *states_[to_size(lane)];
    stages_[to_size(lane)].evaluate(state, state.time + share * dt.lane(lane),
                                    here_[to_size(lane)].controls);
  }
}

template <class T>
void MemberControls<T>::set_force(const MemberVector<T>& extra_force,
                                  MemberVector<T>& force) const {
  run_member_loop<T>([&] {
    for (Index i = 0; i < force.size(); ++i) {
      force[i] = model_.gravity_force[i] + model_.dead_force[i] + extra_force[i];
    }
  });
  // They may act on other nodes in each member.
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    for (const ControlledForce& each : model_.models[to_size(lane)]->controlled_forces) {
      T& sum = force[each.dof];
      const double value = here_[to_size(lane)].controls[each.control];
      sum.set_lane(lane, sum.lane(lane) + each.weight * value);
    }
  }
}

template <class T>
void MemberControls<T>::hold(MemberVector<T>& positions) const {
  const std::vector<HeldDof>& held = model_.structure().held;
  for (std::size_t i = 0; i < held.size(); ++i) {
    const Index control = held[i].displacement;
    T displacement = 0.0;
    if (control >= 0) {
      displacement = in_lanes<T>([&](int lane) { return here_[to_size(lane)].controls[control]; });
    }
    positions[held[i].dof] = model_.held_places[static_cast<Index>(i)] + displacement;
  }
}

template <class T>
T MemberControls<T>::stage_velocity(const HeldDof& held, const T& mean) const {
  if (held.displacement < 0) return mean;
  return in_lanes<T>(
      [&](int lane) { return stages_[to_size(lane)].velocity(held, mean.lane(lane)); });
}

template <class T>
T MemberControls<T>::held_velocity(const HeldDof& held, const T& dt, double share,
                                   const T& mean) const {
  if (held.displacement < 0) return mean;
  return in_lanes<T>([&](int lane) {
    const State& state = *states_[to_size(lane)];
    return der::held_velocity(*model_.models[to_size(lane)], state, held,
                              state.time + share * dt.lane(lane), mean.lane(lane));
  });
}

template <class T>
T MemberControls<T>::driven_gravity_energy(const MemberVector<T>& positions) const {
  const Model& structure = model_.structure();
  T energy = 0.0;
  if (structure.gravity_controls[0] < 0) return energy;
  for (Index dof = 0; dof < structure.dofs.num_positions(); ++dof) {
    const Index control = structure.gravity_controls[to_size(structure.dofs[dof].component)];
    const T gravity = in_lanes<T>([&](int lane) { return here_[to_size(lane)].controls[control]; });
    energy -= model_.lumped[dof] * gravity * positions[dof];
  }
  return energy;
}

#define DER_INSTANTIATE(T) template class MemberControls<T>;
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
