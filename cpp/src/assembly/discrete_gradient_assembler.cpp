#include "der/assembly/discrete_gradient_assembler.hpp"

#include <type_traits>

#include "der/energies/discrete_gradient.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

template <class Kernel>
struct IsFromPivot : std::false_type {};
template <class Kernel>
struct IsFromPivot<FromPivot<Kernel>> : std::true_type {};

/// Between what the tables have at `start` and at `end`: the mean of both.
template <class Kernel, class Constants>
Local<Kernel::kDofs> mean_of_tables(const Constants& constants, const Configuration& start,
                                    const Configuration& end, const Local<Kernel::kDofs>& before,
                                    const Local<Kernel::kDofs>& after) {
  Local<Kernel::kDofs> at_start;
  Local<Kernel::kDofs> at_end;
  discrete_gradient(KernelTag<Kernel>{}, constants, start, before, after, at_start);
  discrete_gradient(KernelTag<Kernel>{}, constants, end, before, after, at_end);
  return 0.5 * (at_start + at_end);
}

}  // namespace

DiscreteGradientAssembler::DiscreteGradientAssembler(const Model& model, const Assembler& assembler)
    : start{Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())},
      end(start),
      model_(model),
      assembler_(assembler),
      at_middle_(Vector::Zero(model.num_dofs())),
      excess_(Vector::Zero(assembler.num_plain_edges())) {}

template <class Kernel>
void DiscreteGradientAssembler::evaluate(const ElementList<Kernel>& list, std::size_t element,
                                         Eigen::Matrix<double, Kernel::kDofs, 1>& gradient) const {
  const auto& constants = list.constants[element];
  const auto before = gather(list.dofs[element], start.coordinates);
  const auto after = gather(list.dofs[element], end.coordinates);
  if (!tables_change_) {
    discrete_gradient(KernelTag<Kernel>{}, constants, start, before, after, gradient);
  } else if constexpr (IsFromPivot<Kernel>::value) {
    using Element = typename Kernel::Element;
    gradient = mean_of_tables<Element>(constants.element, start, end,
                                       Kernel::from_pivots(constants, start.controls, before),
                                       Kernel::from_pivots(constants, end.controls, after));
  } else {
    gradient = mean_of_tables<Kernel>(constants, start, end, before, after);
  }
}

double DiscreteGradientAssembler::work_at_pivots(const Configuration& middle) {
  reach_end(middle);
  double work = 0.0;
  if (!tables_change_) return work;
  for_each_list(*model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    // The work of moments at pivots is among that of loads (control_work).
    if constexpr (IsFromPivot<Kernel>::value && Kernel::kTerm != EnergyTerm::Load) {
      Local<Kernel::kDofs> moving;
      for (std::size_t e = 0; e < list.size(); ++e) {
        const auto before = gather(list.dofs[e], start.coordinates);
        const auto after = gather(list.dofs[e], end.coordinates);
        evaluate(list, e, moving);
        const auto at_rest = mean_of_tables<Kernel>(list.constants[e], start, end, before, after);
        work += (at_rest - moving).dot(after - before);
      }
    }
  });
  return work;
}

void DiscreteGradientAssembler::reach_end(const Configuration& middle) {
  end.coordinates = 2.0 * middle.coordinates - start.coordinates;
  tables_change_ = start.controls != end.controls;
}

void DiscreteGradientAssembler::gradient(const Configuration& middle, Vector& gradient) {
  reach_end(middle);
  gradient.setZero();
  for_each_list(*model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    Eigen::Matrix<double, Kernel::kDofs, 1> local;
    for (std::size_t e = 0; e < list.size(); ++e) {
      evaluate(list, e, local);
      for (std::size_t i = 0; i < Kernel::kDofs; ++i) {
        gradient[list.dofs[e][i]] += local[static_cast<Index>(i)];
      }
    }
  });
  add_circulatory_forces(circulatory_loads(*model_.elements), middle, -1.0, gradient);
}

void DiscreteGradientAssembler::add_hessian(const Configuration& middle, Vector& gradient,
                                            Vector& values) {
  this->gradient(middle, gradient);
  assembler_.add_hessian(middle, at_middle_, values);
  // The force over the mean edge vector is EA/l (1 - 2 l/(l0 + l1)), at the middle
  // EA/l (1 - l/l_middle).
  const auto& edges = elements_of<Stretch<2>>(*model_.elements);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto length = [&dofs = edges.dofs[i]](const Configuration& there) {
      return Stretch<2>::edge(gather(dofs, there.coordinates)).norm();
    };
    const double over_mean = 2.0 * length(middle) / (length(start) + length(end));
    excess_[static_cast<Index>(i)] = edges.constants[i].EA * (1.0 - over_mean);
  }
  assembler_.add_tension_stiffness(middle, excess_, values);
}

double DiscreteGradientAssembler::moment_work(const Configuration& middle,
                                              const Vector& displacement) {
  reach_end(middle);
  double work = circulatory_work(circulatory_loads(*model_.elements), middle, displacement);
  for_each_list(*model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm == EnergyTerm::Load) {
      Eigen::Matrix<double, Kernel::kDofs, 1> local;
      for (std::size_t e = 0; e < list.size(); ++e) {
        evaluate(list, e, local);
        work -= local.dot(gather(list.dofs[e], displacement));
      }
    }
  });
  return work;
}

}  // namespace der
