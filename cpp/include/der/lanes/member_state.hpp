#pragma once

#include "der/assembly/member_lanes.hpp"
#include "der/model/followed.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// The parts of several members' states that a step reads and changes (State).
template <class T>
struct MemberState {
  explicit MemberState(const Model& model)
      : positions(model.num_dofs()),
        velocities(model.num_dofs()),
        accelerations(model.num_dofs()),
        extra_force(model.num_dofs()),
        frames(num_followed(model)) {}

  MemberVector<T> positions;      ///< [m]
  MemberVector<T> velocities;     ///< [m/s]
  MemberVector<T> accelerations;  ///< [m/s^2]
  MemberVector<T> extra_force;    ///< [N]
  MemberVector<T> frames;         ///< State::followed: the blocks of all edges (FrameBlock)
  /// Works [J] that a step adds to.
  struct Work {
    T loads = 0.0;
    T supports = 0.0;
    T drag = 0.0;
    T solver = 0.0;
  };
  Work work;

  void load(int lane, const State& state) {
    positions.set_lane(lane, state.positions);
    velocities.set_lane(lane, state.velocities);
    accelerations.set_lane(lane, state.accelerations);
    extra_force.set_lane(lane, state.extra_force);
    frames.set_lane(lane, state.followed);
    work.loads.set_lane(lane, state.work.loads);
    work.supports.set_lane(lane, state.work.supports);
    work.drag.set_lane(lane, state.work.drag);
    work.solver.set_lane(lane, state.work.solver);
  }
  /// Extra forces do not change in a step.
  void store(int lane, State& state) const {
    positions.get_lane(lane, state.positions);
    velocities.get_lane(lane, state.velocities);
    accelerations.get_lane(lane, state.accelerations);
    store_frames(lane, state);
    store_works(lane, state);
  }
  void store_frames(int lane, State& state) const { frames.get_lane(lane, state.followed); }
  void store_works(int lane, State& state) const {
    state.work.loads = work.loads.lane(lane);
    state.work.supports = work.supports.lane(lane);
    state.work.drag = work.drag.lane(lane);
    state.work.solver = work.solver.lane(lane);
  }
};

}  // namespace der
