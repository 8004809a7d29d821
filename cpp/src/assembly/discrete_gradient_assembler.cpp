#include "der/assembly/discrete_gradient_assembler.hpp"

#include <cmath>

#include "der/core/index.hpp"
#include "der/energies/discrete_gradient.hpp"
#include "der/energies/element_energy.hpp"

namespace der {

DiscreteGradientAssembler::DiscreteGradientAssembler(const Model& model, const Assembler& assembler)
    : controls_start(Vector::Zero(model.controls.size())),
      controls_end(Vector::Zero(model.controls.size())),
      model_(model),
      assembler_(assembler),
      end_(Vector::Zero(model.num_dofs())),
      at_middle_(Vector::Zero(model.num_dofs())),
      excess_(Vector::Zero(
          static_cast<Index>(std::get<ElementList<Stretch<2>>>(model.elements).size()))) {}

template <class Kernel>
void DiscreteGradientAssembler::evaluate(const ElementList<Kernel>& list, std::size_t element,
                                         const Vector& start,
                                         Eigen::Matrix<double, Kernel::kDofs, 1>& gradient) const {
  const auto& constants = list.constants[element];
  const auto before = gather(list.dofs[element], start);
  const auto after = gather(list.dofs[element], end_);
  discrete_gradient(KernelTag<Kernel>{}, constants, controls_start, before, after, gradient);
  if (!tables_change_) return;
  Eigen::Matrix<double, Kernel::kDofs, 1> at_end;
  discrete_gradient(KernelTag<Kernel>{}, constants, controls_end, before, after, at_end);
  gradient = 0.5 * (gradient + at_end);
}

void DiscreteGradientAssembler::gradient(const Vector& start, const Vector& middle,
                                         Vector& gradient) {
  end_ = 2.0 * middle - start;
  tables_change_ = controls_start != controls_end;
  gradient.setZero();
  for_each_list(model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    Eigen::Matrix<double, Kernel::kDofs, 1> local;
    for (std::size_t e = 0; e < list.size(); ++e) {
      evaluate(list, e, start, local);
      for (std::size_t i = 0; i < Kernel::kDofs; ++i) {
        gradient[list.dofs[e][i]] += local[static_cast<Index>(i)];
      }
    }
  });
}

void DiscreteGradientAssembler::gradient_and_hessian(const Vector& start, const Vector& middle,
                                                     const Vector& controls, Vector& gradient,
                                                     Vector& values) {
  this->gradient(start, middle, gradient);
  assembler_.gradient_and_hessian(middle, controls, at_middle_, values);
  // The force over the mean edge vector is EA/l (1 - 2 l/(l0 + l1)), at the middle
  // EA/l (1 - l/l_middle).
  const auto& edges = std::get<ElementList<Stretch<2>>>(model_.elements);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto length = [&dofs = edges.dofs[i]](const Vector& x) {
      return std::hypot(x[dofs[2]] - x[dofs[0]], x[dofs[3]] - x[dofs[1]]);
    };
    const double over_mean = 2.0 * length(middle) / (length(start) + length(end_));
    excess_[static_cast<Index>(i)] = edges.constants[i].EA * (1.0 - over_mean);
  }
  assembler_.add_tension_stiffness(middle, excess_, values);
}

double DiscreteGradientAssembler::moment_work(const Vector& start, const Vector& middle,
                                              const Vector& displacement) {
  end_ = 2.0 * middle - start;
  tables_change_ = controls_start != controls_end;
  double work = 0.0;
  for_each_list(model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm == EnergyTerm::Load) {
      Eigen::Matrix<double, Kernel::kDofs, 1> local;
      for (std::size_t e = 0; e < list.size(); ++e) {
        evaluate(list, e, start, local);
        work -= local.dot(gather(list.dofs[e], displacement));
      }
    }
  });
  return work;
}

}  // namespace der
