#include "der/steppers/stable_step.hpp"

#include <cmath>
#include <limits>

#include "der/assembly/element_energy.hpp"

namespace der {
namespace {

/// The largest rate of one kind over the free degrees of freedom, and where.
struct Fastest {
  double rate = 0.0;  // squared frequency [1/s^2], or damping rate [1/s]
  Index dof = -1;
};

Fastest largest(const Model& model, const Vector& rates) {
  Fastest fastest;
  for (const Index dof : model.free_dofs) {
    if (rates[dof] > fastest.rate) fastest = {rates[dof], dof};
  }
  return fastest;
}

/// Row sums of |D^-1/2 K D^-1/2|, D a diagonal below the mass, over the elements booked under
/// `term`, element by element: an upper bound even where entries of neighbours cancel.
Vector scaled_row_sums(const Model& model, const Vector& positions, const Vector& controls,
                       EnergyTerm term) {
  Vector sums = Vector::Zero(model.num_dofs());
  const Vector mass = model.mass.lower_bound();
  const auto weight = [&](Index dof) {
    const bool free = model.free_index[static_cast<std::size_t>(dof)] >= 0;
    return free ? 1.0 / std::sqrt(mass[dof]) : 0.0;
  };
  for_each_list(model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if (Kernel::kTerm != term) return;
    LocalTerm<Kernel::kDofs> local;
    for (std::size_t e = 0; e < list.size(); ++e) {
      const auto& dofs = list.dofs[e];
      Kernel::template evaluate<Derivatives::Hessian>(list.constants[e], controls,
                                                      gather(dofs, positions), local);
      for (int i = 0; i < Kernel::kDofs; ++i) {
        for (int j = 0; j < Kernel::kDofs; ++j) {
          const double entry = i >= j ? local.hessian(i, j) : local.hessian(j, i);
          const Index a = dofs[static_cast<std::size_t>(i)];
          const Index b = dofs[static_cast<std::size_t>(j)];
          sums[a] += weight(a) * weight(b) * std::abs(entry);
        }
      }
    }
  });
  return sums;
}

}  // namespace

StableStep stable_step(const Model& model, const Vector& positions, bool drag_limits_step) {
  Vector controls;
  model.controls.evaluate(0.0, controls);
  const Fastest stretch =
      largest(model, scaled_row_sums(model, positions, controls, EnergyTerm::Stretch));
  const Fastest bend =
      largest(model, scaled_row_sums(model, positions, controls, EnergyTerm::Bend));
  const Fastest drag = drag_limits_step
                           ? largest(model, model.damping.cwiseQuotient(model.mass.lower_bound()))
                           : Fastest{};

  const double w2 = stretch.rate + bend.rate;
  const double g = drag.rate;
  StableStep result;
  if (w2 == 0.0 && g == 0.0) {
    result.step = std::numeric_limits<double>::infinity();
    result.limited_by = "nothing";
    return result;
  }
  // Positive root of dt^2 w2 + 2 dt g = 4, in the form that is stable for small w2 and small g.
  result.step = 4.0 / (g + std::sqrt(g * g + 4.0 * w2));
  if (g * g >= w2) {
    result.limited_by = "drag";
    result.worst_dof = drag.dof;
  } else if (stretch.rate >= bend.rate) {
    result.limited_by = "stretch";
    result.worst_dof = stretch.dof;
  } else {
    result.limited_by = "bend";
    result.worst_dof = bend.dof;
  }
  return result;
}

}  // namespace der
