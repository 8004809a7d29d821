#pragma once

#include <array>

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/energies/element_list.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// Sums the discrete gradients of a model's elements over a step (energies/discrete_gradient.hpp),
/// and sets the matrix that Newton's method takes with them. Tables change evenly during the step:
/// an element takes the mean of its discrete gradients under their values at both ends, so that
/// along the step it gives the change of its energy but for the work of turning its clamp
/// (steppers/work.hpp). Pivots of clamps are at each end where the tables have them there: in both
/// places at rest, a short edge beside the clamp would resist their way, d dphi, by
/// EI (d dphi/l^2)^2. Evaluations allocate nothing.
class DiscreteGradientAssembler {
 public:
  DiscreteGradientAssembler(const Model& model, const Assembler& assembler);

  /// The ends of the step: to be set before it, but for the coordinates of `end`, which follow from
  /// those of the middle.
  Configuration start;
  Configuration end;

  /// Sets `gradient` (all degrees of freedom) [N] to the discrete gradient over the step whose
  /// middle is `middle`.
  void gradient(const Configuration& middle, Vector& gradient);
  /// Sets `gradient` likewise, and adds to `values` the Hessian [N/m] at the middle with the
  /// tensions of the discrete gradient. It is the derivative of the discrete gradient with respect
  /// to the middle, but for terms that vanish with the step.
  void add_hessian(const Configuration& middle, Vector& gradient, Vector& values);
  /// Work [J] of the moments along `displacement` [m], in the step whose middle is `middle`.
  double moment_work(const Configuration& middle, const Vector& displacement);
  /// Work [J] in the step whose middle is `middle` of what moves the pivots of clamps, beyond that
  /// of `control_work`, which has them at rest at either of their places.
  double work_at_pivots(const Configuration& middle);

 private:
  template <class Kernel>
  void evaluate(const ElementList<Kernel>& list, std::size_t element,
                Eigen::Matrix<double, Kernel::kDofs, 1>& gradient) const;
  void reach_end(const Configuration& middle);

  const Model& model_;
  const Assembler& assembler_;
  bool tables_change_ = false;
  Vector at_middle_;  // gradient [N]
  Vector excess_;     // of each plain edge's tension over that at the middle [N]
};

}  // namespace der
