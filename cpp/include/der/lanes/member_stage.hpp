#pragma once

#include <array>

#include "der/lanes/lane_set.hpp"
#include "der/lanes/members.hpp"
#include "der/solvers/member_band.hpp"

namespace der {

/// The equations of one stage of an implicit stepper (Stage) for several members, and Newton's
/// method with full steps for all of them at once. A member whose steps have converged waits for
/// the others. One whose matrix is not positive definite, or whose steps do not get there, is given
/// up: its step is left to its Simulation.
template <class T>
class MemberStage {
 public:
  /// Memory for members with such a model.
  MemberStage(const Model& structure, MemberBand<T> band);
  /// The members whose stages are solved from now on; all of it must outlive that.
  void serve(const Members<T>& members) { members_ = &members; }

  // The equations, to be set before `solve`.
  T inertia = 0.0;                     ///< [1/s^2]
  T velocity_factor = 0.0;             ///< [1/s]
  const MemberVector<T>* origin;       ///< [m]
  const MemberVector<T>* frames;       ///< at the start of the step
  MemberVector<T> inertia_target;      ///< [m] from the origin
  MemberVector<T> velocity_reference;  ///< [m] from the origin
  MemberVector<T> force;               ///< [N]
  /// On entry to `solve` the guess, held degrees of freedom included; on exit the solution.
  MemberVector<T> coordinates;  ///< [m]

  /// Solves for the members in `lanes`; returns those for which it has.
  LaneSet solve(LaneSet lanes);
  /// From the origin [m], and the left side of the equations [N], of the stage solved last.
  [[nodiscard]] const MemberVector<T>& displacement() const { return displacement_; }
  [[nodiscard]] const MemberVector<T>& residual() const { return residual_; }
  /// Iterations of the stage solved last.
  [[nodiscard]] int iterations(int lane) const { return iterations_[to_size(lane)]; }

 private:
  void evaluate_residual();
  void evaluate_system();
  void add_stage_forces();
  void measure();
  LaneSet find_step(LaneSet lanes);
  void move(LaneSet lanes);
  LaneSet find_converged(LaneSet lanes, const T& residual_before, bool& have_system);
  T residual_rounding();

  const Members<T>* members_ = nullptr;
  MemberBand<T> band_;
  std::array<int, to_size(LaneTraits<T>::kCount)> iterations_{};
  MemberVector<T> displacement_;
  MemberVector<T> residual_;
  MemberVector<T> direction_;  // over the free degrees of freedom
  MemberVector<T> step_;
  MemberVector<T> acceleration_;
  T external_ = 0.0;          // largest external force [N]
  T acting_ = 0.0;            // largest force of the last evaluation [N]
  T largest_residual_ = 0.0;  // on free degrees of freedom [N]
  T length_ = 0.0;            // of the step [m]
  T change_ = 0.0;            // StepBound::change
};

}  // namespace der
