#pragma once

#include <array>
#include <vector>

#include "der/lanes/lane_set.hpp"
#include "der/lanes/member_stage.hpp"
#include "der/lanes/member_state.hpp"
#include "der/lanes/members.hpp"
#include "der/steppers/tableau.hpp"

namespace der {

/// The steps of a diagonally implicit Runge-Kutta method for several members: of each, to the last
/// bit, what its stepper does (steppers/runge_kutta.cpp).
template <class T>
class MemberStepper {
 public:
  /// Memory for members with such a model.
  MemberStepper(const Tableau& tableau, const Model& structure, MemberStage<T> stage);
  /// The members that are stepped from now on; they must outlive that.
  void serve(Members<T>& members);

  /// Tries a step of `dt` [s] for the members in `lanes`; returns those that have done it. The
  /// states of the others are as before.
  LaneSet step(LaneSet lanes, const T& dt, MemberState<T>& state);
  /// Iterations of Newton's method in the last step.
  [[nodiscard]] int newton_iterations(int lane) const { return iterations_[to_size(lane)]; }

 private:
  using Work = typename MemberState<T>::Work;

  void begin(const MemberState<T>& state, const T& dt);
  void evaluate_start(const MemberState<T>& state, const T& dt);
  void pose_stage(Index stage, const MemberState<T>& state, const T& dt);
  void set_rates(Index stage, const T& dt);
  void set_displacement(Index stage, const MemberState<T>& state, const T& dt);
  void accumulate_start();
  void accumulate_stage();
  void set_end(const MemberState<T>& state, const T& dt);
  [[nodiscard]] LaneSet folded() const;
  void finish(LaneSet done, const T& dt, MemberState<T>& state);

  const Tableau& tableau_;
  Members<T>* members_ = nullptr;
  MemberStage<T> stage_;
  std::array<int, to_size(LaneTraits<T>::kCount)> iterations_{};
  // Memory of an explicit first stage.
  MemberVector<T> start_force_;
  MemberVector<T> start_gradient_;
  MemberVector<T> couple_;  // gyroscopic forces, where sections count

  MemberVector<T> past_displacement_;
  MemberVector<T> past_velocities_;
  MemberVector<T> end_positions_;  // of held degrees of freedom, then of all
  MemberVector<T> end_velocities_;
  MemberVector<T> displacement_;
  std::vector<MemberVector<T>> velocities_;  // of each stage
  std::vector<MemberVector<T>> accelerations_;
  T driven_gravity_ = 0.0;  // energy at the start [J]
  Work work_;
};

}  // namespace der
