#include "der/steppers/stable_step.hpp"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "der/assembly/element_energy.hpp"
#include "der/core/index.hpp"

namespace der {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// D^-1/2 K D^-1/2 over the free degrees of freedom, from the elements booked under `term`; D is a
/// diagonal that the mass is nowhere below.
Matrix scaled_stiffness(const Model& model, const Vector& positions, const Vector& controls,
                        EnergyTerm term) {
  const Vector mass = model.mass.lower_bound();
  std::vector<Eigen::Triplet<double>> entries;
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
          const Index a = model.free_index[at(dofs[at(i)])];
          const Index b = model.free_index[at(dofs[at(j)])];
          if (a < 0 || b < 0) continue;
          const double entry = i >= j ? local.hessian(i, j) : local.hessian(j, i);
          entries.emplace_back(a, b, entry / std::sqrt(mass[dofs[at(i)]] * mass[dofs[at(j)]]));
        }
      }
    }
  });
  Matrix matrix(model.num_free(), model.num_free());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Gershgorin: no eigenvalue is larger than the largest of these.
Vector row_sums(const Matrix& matrix) {
  Vector sums = Vector::Zero(matrix.rows());
  for (Index column = 0; column < matrix.outerSize(); ++column) {
    for (Matrix::InnerIterator it(matrix, column); it; ++it) sums[it.row()] += std::abs(it.value());
  }
  return sums;
}

/// Damping rate [1/s] of each free degree of freedom.
Vector damping_rates(const Model& model) {
  const Vector rates = model.damping.cwiseQuotient(model.mass.lower_bound());
  Vector free(model.num_free());
  for (Index i = 0; i < free.size(); ++i) free[i] = rates[model.free_dofs[at(i)]];
  return free;
}

}  // namespace

StableStep stable_step(const Model& model, const Vector& positions, bool drag_limits_step) {
  Vector controls;
  model.controls.evaluate(0.0, controls);
  const Matrix stretch = scaled_stiffness(model, positions, controls, EnergyTerm::Stretch);
  const Matrix bend = scaled_stiffness(model, positions, controls, EnergyTerm::Bend);
  const Matrix spring = scaled_stiffness(model, positions, controls, EnergyTerm::Spring);
  const Vector rates = drag_limits_step ? damping_rates(model) : Vector::Zero(model.num_free());

  Index fastest = 0;
  Index most_damped = 0;
  const double w2 = row_sums(stretch + bend + spring).maxCoeff(&fastest);
  const double g = rates.maxCoeff(&most_damped);
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
    result.worst_dof = model.free_dofs[at(most_damped)];
  } else {
    const double of_stretch = row_sums(stretch)[fastest];
    const double of_bend = row_sums(bend)[fastest];
    result.limited_by = of_stretch >= of_bend ? "stretch" : "bend";
    if (row_sums(spring)[fastest] > std::max(of_stretch, of_bend)) result.limited_by = "spring";
    result.worst_dof = model.free_dofs[at(fastest)];
  }
  return result;
}

}  // namespace der
