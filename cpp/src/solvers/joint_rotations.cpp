#include "der/solvers/joint_rotations.hpp"

#include <algorithm>
#include <type_traits>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/num_joints.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

/// Calls use(list) for each kind of element that rotations of joints have a part in.
template <class Use>
void for_each_jointed_list(const Model& model, const Use& use) {
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (NumJoints<Kernel>::value > 0) use(list);
  });
}

}  // namespace

JointRotations::JointRotations(const Model& model) : model_(model) {
  const DofMap& dofs = model.dofs;
  for (Index i = 0; i < dofs.num_rotations(); ++i) {
    const bool is_free = dofs.is_free(dofs.rotation(i));
    number_.push_back(is_free ? static_cast<Index>(free_.size()) : -1);
    if (is_free) free_.push_back(dofs.rotation(i));
  }
  if (free_.empty()) return;
  const auto is_free_rotation = [&](const ControlledForce& force) {
    return force.dof >= dofs.rotation(0) && dofs.is_free(force.dof);
  };
  std::copy_if(model.controlled_forces.begin(), model.controlled_forces.end(),
               std::back_inserter(moments_), is_free_rotation);
  const auto size = static_cast<Index>(free_.size());
  gradient_.setZero(size);
  stiffness_.resize(size, size);
  for (Index i = 0; i < size; ++i) stiffness_.coeffRef(i, i) = 1.0;
  here_ = {model.initial_positions, Vector::Zero(model.tables.size())};
  assemble(here_);
  stiffness_.makeCompressed();
  solver_.analyzePattern(stiffness_);
}

/// Sets the gradient, and the stiffness, of the energy by the free rotations.
void JointRotations::assemble(const Configuration& here) {
  gradient_.setZero();
  stiffness_ *= 0.0;
  for_each_jointed_list(model_, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    constexpr int kNodes = Kernel::kDofs - Kernel::kJoints;  // coordinates of nodes
    LocalTerm<Kernel::kDofs> term;
    for (std::size_t e = 0; e < list.size(); ++e) {
      const auto& dofs = list.dofs[e];
      evaluate_element<Kernel, Derivatives::Hessian>(list.constants[e], here,
                                                     gather(dofs, here.coordinates), term);
      for (Index a = kNodes; a < Kernel::kDofs; ++a) {
        const Index row = number_[to_size(dofs[to_size(a)] - model_.dofs.rotation(0))];
        if (row < 0) continue;
        gradient_[row] += term.gradient[a];
        for (Index b = kNodes; b < Kernel::kDofs; ++b) {
          const Index column = number_[to_size(dofs[to_size(b)] - model_.dofs.rotation(0))];
          if (column < 0 || column > row) continue;
          stiffness_.coeffRef(row, column) += term.hessian(std::max(a, b), std::min(a, b));
        }
      }
    }
  });
}

void JointRotations::settle(const Vector& controls, const Vector& extra_force,
                            Vector& coordinates) {
  constexpr int kMost = 20;
  constexpr double kRounding = 1e-14;  // [rad], and of a rotation
  if (free_.empty()) return;
  here_.controls = controls;
  for (int iteration = 0; iteration < kMost; ++iteration) {
    here_.coordinates = coordinates;
    assemble(here_);
    for (const auto& [dof, control, weight] : moments_) {
      gradient_[number_[to_size(dof - model_.dofs.rotation(0))]] -= weight * controls[control];
    }
    for (std::size_t i = 0; i < free_.size(); ++i) {
      gradient_[static_cast<Index>(i)] -= extra_force[free_[i]];
    }
    solver_.factorize(stiffness_);
    if (solver_.info() != Eigen::Success) return;
    gradient_ = solver_.solve(gradient_).eval();
    bool settled = true;
    for (std::size_t i = 0; i < free_.size(); ++i) {
      double& rotation = coordinates[free_[i]];
      const double step = gradient_[static_cast<Index>(i)];
      rotation -= step;
      settled = settled && std::abs(step) <= kRounding * (1.0 + std::abs(rotation));
    }
    if (settled) return;
  }
}

}  // namespace der
