#include "der/solvers/joint_rotations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <type_traits>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/num_joints.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

constexpr double kRounding = 1e-15;  // [rad], and of a rotation

}  // namespace

/// Calls use(list, e, rotations) for each element that rotations have a part in; `rotations` are
/// their numbers among the free ones, -1 of a held one and of none.
template <class Use>
void JointRotations::for_each_element(const Use& use) const {
  for_each_list(*model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (NumJoints<Kernel>::value > 0 && NumJoints<Kernel>::value < 3) {
      for (std::size_t e = 0; e < list.size(); ++e) {
        std::array<Index, 2> rotations{-1, -1};
        for (int i = 0; i < Kernel::kJoints; ++i) {
          const auto place = static_cast<std::size_t>(Kernel::kDofs - Kernel::kJoints + i);
          rotations[to_size(i)] = number_of(list.dofs[e][place]);
        }
        use(list, e, rotations);
      }
    }
  });
}

Index JointRotations::number_of(Index dof) const {
  return number_[to_size(dof - model_.dofs.rotation(0))];
}

JointRotations::JointRotations(const Model& model) : model_(model) {
  const DofMap& dofs = model.dofs;
  if (model.dimension == 3 && model.has_rotations()) {
    in_space_ = std::make_unique<SpatialJointRotations>(model);
    return;
  }
  for (Index i = 0; i < dofs.num_rotations(); ++i) {
    const bool is_free = dofs.is_free(dofs.rotation(i));
    number_.push_back(is_free ? static_cast<Index>(free_.size()) : -1);
    if (is_free) free_.push_back(dofs.rotation(i));
  }
  const auto acts_here = [&](const ControlledForce& force) {
    return force.dof >= dofs.rotation(0) && dofs.is_free(force.dof);
  };
  std::copy_if(model.controlled_forces.begin(), model.controlled_forces.end(),
               std::back_inserter(moments_), acts_here);
  beside_.resize(free_.size());
  for_each_element([&](const auto& /*list*/, std::size_t /*e*/, const auto& rotations) {
    if (rotations[0] < 0 || rotations[1] < 0) return;
    for (const Index rotation : rotations) beside_[to_size(rotation)].push_back(couplings_.size());
    couplings_.push_back({to_size(rotations[0]), to_size(rotations[1]), 0.0});
  });
  const auto size = static_cast<Index>(free_.size());
  for (Vector* each : {&residual_, &stiffness_, &step_}) each->setZero(size);
  here_ = {Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())};
}

/// Sets the gradient of the energy, and the stiffness, by the free rotations.
void JointRotations::assemble() {
  residual_.setZero();
  stiffness_.setZero();
  auto coupling = couplings_.begin();
  for_each_element([&](const auto& list, std::size_t e, const auto& rotations) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    constexpr Index kFirst = Kernel::kDofs - Kernel::kJoints;
    LocalTerm<Kernel::kDofs> term;
    evaluate_element<Kernel, Derivatives::Hessian>(list.constants[e], here_,
                                                   gather(list.dofs[e], here_.coordinates), term);
    for (Index i = 0; i < Kernel::kJoints; ++i) {
      const Index number = rotations[to_size(i)];
      if (number < 0) continue;
      residual_[number] += term.gradient[kFirst + i];
      stiffness_[number] += term.hessian(kFirst + i, kFirst + i);
    }
    if constexpr (Kernel::kJoints == 2) {
      if (rotations[0] >= 0 && rotations[1] >= 0) {
        (coupling++)->value = term.hessian(kFirst + 1, kFirst);
      }
    }
  });
}

/// Gauss-Seidel's method: a leg of one cell couples its two rotations by half the stiffness that it
/// has on the diagonal at most, so that each sweep divides the error by 4.
void JointRotations::solve() {
  constexpr int kMostSweeps = 100;
  step_.setZero();
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double change = 0.0;
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const auto k = static_cast<Index>(i);
      double moment = residual_[k];
      for (const std::size_t number : beside_[i]) {
        const Coupling& coupling = couplings_[number];
        moment -=
            coupling.value * step_[static_cast<Index>(coupling.a == i ? coupling.b : coupling.a)];
      }
      const double before = step_[k];
      step_[k] = moment / stiffness_[k];
      change = std::max(change, std::abs(step_[k] - before));
    }
    if (couplings_.empty() || change <= kRounding) return;
  }
}

double JointRotations::settle(const Vector& controls, const Vector& extra_force,
                              Vector& coordinates) {
  constexpr int kMost = 20;
  if (in_space_) return in_space_->settle(controls, extra_force, coordinates);
  double work = 0.0;
  if (free_.empty()) return work;
  here_.controls = controls;
  const auto add_work = [&](double sign) {
    for (const auto& [dof, control, weight] : moments_) {
      work += sign * weight * controls[control] * coordinates[dof];
    }
    for (const Index dof : free_) work += sign * extra_force[dof] * coordinates[dof];
  };
  add_work(-1.0);
  bool settled = false;
  for (int iteration = 0; iteration < kMost && !settled; ++iteration) {
    here_.coordinates = coordinates;
    assemble();
    for (const auto& [dof, control, weight] : moments_) {
      residual_[number_of(dof)] -= weight * controls[control];
    }
    for (std::size_t i = 0; i < free_.size(); ++i) {
      residual_[static_cast<Index>(i)] -= extra_force[free_[i]];
    }
    solve();
    settled = true;
    for (std::size_t i = 0; i < free_.size(); ++i) {
      double& rotation = coordinates[free_[i]];
      const double step = step_[static_cast<Index>(i)];
      rotation -= step;
      settled = settled && std::abs(step) <= 8.0 * kRounding * (1.0 + std::abs(rotation));
    }
  }
  add_work(1.0);
  return work;
}

}  // namespace der
