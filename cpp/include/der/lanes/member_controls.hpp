#pragma once

#include <array>
#include <vector>

#include "der/kinematics/configuration.hpp"
#include "der/lanes/member_model.hpp"
#include "der/model/state.hpp"
#include "der/steppers/stage_controls.hpp"

namespace der {

/// The states of members, of which times and ramps are read.
template <class T>
using MemberStates = std::array<const State*, to_size(LaneTraits<T>::kCount)>;

/// What several members follow besides their coordinates, at one time of each: the values of their
/// tables, one member after the other, and forces and places of supports that come from them. A
/// model without tables pays nothing for it.
template <class T>
class MemberControls {
 public:
  MemberControls(const MemberModel<T>& model, const MemberStates<T>& states);

  /// The controls of the members, in their lanes; their coordinates are not used.
  using Configurations = std::array<Configuration, to_size(LaneTraits<T>::kCount)>;
  [[nodiscard]] const Configurations& here() const { return here_; }

  /// Begins a step from the members' states.
  void begin_step(const T& dt);
  /// Sets the controls to those at a share of the step.
  void evaluate(const T& dt, double share);
  /// Sets `force` to the external forces [N] with the extra ones.
  void set_force(const MemberVector<T>& extra_force, MemberVector<T>& force) const;
  /// Puts held degrees of freedom where the tables have them.
  void hold(MemberVector<T>& positions) const;
  /// Energy [J] of weights that follow a table (driven_gravity_energy).
  [[nodiscard]] T driven_gravity_energy(const MemberVector<T>& positions) const;

 private:
  const MemberModel<T>& model_;
  MemberStates<T> states_;
  bool has_tables_;
  Configurations here_;
  std::vector<StageControls> stages_;  // one for each lane
};

}  // namespace der
