#pragma once

#include <array>
#include <vector>

#include "der/kinematics/configuration.hpp"
#include "der/lanes/member_model.hpp"
#include "der/model/state.hpp"
#include "der/steppers/stage_controls.hpp"

namespace der {

/// The states of members, of which times, ramps and frames are read.
template <class T>
using MemberStates = std::array<const State*, to_size(LaneTraits<T>::kCount)>;

/// The controls of several members (Configuration), at one time of each: frames of edges, the
/// values of tables, and the forces and places of supports that come from them. A model without
/// frames and tables pays nothing for it.
template <class T>
class MemberControls {
 public:
  MemberControls(const MemberModel<T>& model, const MemberStates<T>& states);

  /// The controls of the members, in their lanes; their coordinates are not used.
  [[nodiscard]] const MemberConfigurations<T>& here() const { return here_; }

  /// Sets the controls to those at the members' states.
  void evaluate_at_states();
  /// Begins a step from the members' states.
  void begin_step(const T& dt, const Tableau& tableau);
  /// StageControls::enter_stage.
  void enter_stage(Index stage);
  /// Sets the controls to those at a share of the step.
  void evaluate(const T& dt, double share);
  /// Sets `force` to the external forces [N] with the extra ones.
  void set_force(const MemberVector<T>& extra_force, MemberVector<T>& force) const;
  /// Puts held degrees of freedom where the tables have them.
  void hold(MemberVector<T>& positions) const;
  /// StageControls::velocity.
  [[nodiscard]] T stage_velocity(const HeldDof& held, const T& mean) const;
  /// held_velocity at a share of the step.
  [[nodiscard]] T held_velocity(const HeldDof& held, const T& dt, double share,
                                const T& mean) const;
  /// Energy [J] of weights that follow a table (driven_gravity_energy).
  [[nodiscard]] T driven_gravity_energy(const MemberVector<T>& positions) const;

 private:
  void enter_frames();

  const MemberModel<T>& model_;
  MemberStates<T> states_;
  Index num_frames_;  // entries of the controls that are blocks of frames
  bool has_tables_;
  MemberConfigurations<T> here_;
  std::vector<StageControls> stages_;  // one for each lane
};

}  // namespace der
