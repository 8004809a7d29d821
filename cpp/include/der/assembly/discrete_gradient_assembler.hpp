#pragma once

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// Sums the discrete gradients of a model's elements over a step (energies/discrete_gradient.hpp),
/// and sets the matrix that Newton's method takes with them. Tables change evenly during the step:
/// an element takes the mean of its discrete gradients under their values at both ends, so that
/// along the step it gives the change of its energy but for the work of turning its clamp
/// (steppers/work.hpp). Evaluations allocate nothing.
class DiscreteGradientAssembler {
 public:
  DiscreteGradientAssembler(const Model& model, const Assembler& assembler);

  /// Values of the tables at both ends of the step, to be set before it.
  Vector controls_start;
  Vector controls_end;

  /// Sets `gradient` (all degrees of freedom) [N] to the discrete gradient over the step from
  /// `start` whose middle is `middle` [m].
  void gradient(const Vector& start, const Vector& middle, Vector& gradient);
  /// As above, and sets `values` to the Hessian [N/m] at the middle, with the tensions of the
  /// discrete gradient: the derivative of it by the middle, but for terms that fall with the step.
  void gradient_and_hessian(const Vector& start, const Vector& middle, const Vector& controls,
                            Vector& gradient, Vector& values);
  /// Work [J] of the moments along `displacement` [m], in the step from `start` whose middle is
  /// `middle`.
  double moment_work(const Vector& start, const Vector& middle, const Vector& displacement);

 private:
  template <class Kernel>
  void evaluate(const ElementList<Kernel>& list, std::size_t element, const Vector& start,
                Eigen::Matrix<double, Kernel::kDofs, 1>& gradient) const;

  const Model& model_;
  const Assembler& assembler_;
  bool tables_change_ = false;
  Vector end_;        // positions [m]
  Vector at_middle_;  // gradient [N]
  Vector excess_;     // of each plain edge's tension over that at the middle [N]
};

}  // namespace der
