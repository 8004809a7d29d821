#include "der/solvers/spatial_joint_rotations.hpp"

#include <array>
#include <cmath>
#include <type_traits>
#include <variant>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/num_joints.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

constexpr double kRotationRounding = 1e-15;  // [rad], and of a rotation

}  // namespace

/// Calls use(list, e) for each element that joints in space have a part in.
template <class Use>
void SpatialJointRotations::for_each_element(const Use& use) const {
  for_each_list(*model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (NumJoints<Kernel>::value >= 3) {
      for (std::size_t e = 0; e < list.size(); ++e) use(list, e);
    }
  });
}

SpatialJointRotations::SpatialJointRotations(const Model& model) : model_(model) {
  const DofMap& dofs = model.dofs;
  for (Index i = 0; i < dofs.num_rotations(); ++i) {
    const bool is_free = dofs.is_free(dofs.rotation(i));
    number_.push_back(is_free ? static_cast<Index>(free_.size()) : -1);
    if (is_free) free_.push_back(dofs.rotation(i));
  }
  const auto& loads = model.elements->circulatory;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    if (std::holds_alternative<JointMoment>(loads[i].kind)) moments_.push_back(i);
  }
  const auto size = static_cast<Index>(free_.size());
  residual_.setZero(size);
  loads_.setZero(size);
  stiffness_.resize(size, size);
  here_ = {Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())};
}

void SpatialJointRotations::find_loads(const Vector& extra_force) {
  for (std::size_t i = 0; i < free_.size(); ++i)
    loads_[static_cast<Index>(i)] = extra_force[free_[i]];
  const Index first = model_.dofs.rotation(0);
  CirculatoryTerm term;
  for (const std::size_t load : moments_) {
    const CirculatoryLoad& moment = model_.elements->circulatory[load];
    moment.evaluate(here_, term);
    for (Index row = 0; row < 3; ++row) {
      const Index a = number_[to_size(moment.coordinates[to_size(row)].front().dof - first)];
      if (a < 0) continue;
      loads_[a] += term.force[row];
      for (Index column = 0; column < 3; ++column) {
        const Index b = number_[to_size(moment.coordinates[to_size(column)].front().dof - first)];
        if (b >= 0) {
          entries_.emplace_back(static_cast<int>(a), static_cast<int>(b),
                                term.tangent(row, column));
        }
      }
    }
  }
}

/// Sets the gradient of the energy less the moments, and the stiffness, by the free coordinates.
void SpatialJointRotations::assemble(const Vector& extra_force) {
  entries_.clear();
  find_loads(extra_force);
  residual_ = -loads_;
  const Index first = model_.dofs.rotation(0);
  for_each_element([&](const auto& list, std::size_t e) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    constexpr Index kFirst = Kernel::kDofs - Kernel::kJoints;
    LocalTerm<Kernel::kDofs> term;
    evaluate_element<Kernel, Derivatives::Hessian>(list.constants[e], here_,
                                                   gather(list.dofs[e], here_.coordinates), term);
    for (Index i = 0; i < Kernel::kJoints; ++i) {
      const Index row = number_[to_size(list.dofs[e][to_size(kFirst + i)] - first)];
      if (row < 0) continue;
      residual_[row] += term.gradient[kFirst + i];
      for (Index j = 0; j < Kernel::kJoints; ++j) {
        const Index column = number_[to_size(list.dofs[e][to_size(kFirst + j)] - first)];
        if (column < 0) continue;
        // Of the Hessian the lower triangle is set.
        entries_.emplace_back(static_cast<int>(row), static_cast<int>(column),
                              term.hessian(kFirst + std::max(i, j), kFirst + std::min(i, j)));
      }
    }
  });
  const bool is_new = stiffness_.nonZeros() == 0;
  stiffness_.setFromTriplets(entries_.begin(), entries_.end());
  if (is_new) solver_.analyzePattern(stiffness_);
}

double SpatialJointRotations::settle(const Vector& controls, const Vector& extra_force,
                                     Vector& coordinates) {
  constexpr int kMost = 30;
  if (free_.empty()) return 0.0;
  here_.controls = controls;
  here_.coordinates = coordinates;
  double work = 0.0;
  for (int iteration = 0; iteration < kMost; ++iteration) {
    assemble(extra_force);
    solver_.factorize(stiffness_);
    if (solver_.info() != Eigen::Success) break;
    const Vector step = solver_.solve(residual_);
    if (!step.allFinite()) break;
    bool settled = true;
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const double change = step[static_cast<Index>(i)];
      double& rotation = here_.coordinates[free_[i]];
      rotation -= change;
      settled = settled && std::abs(change) <= 8.0 * kRotationRounding * (1.0 + std::abs(rotation));
    }
    // The loads at both ends of the way do the work in the mean.
    work -= 0.5 * loads_.dot(step);
    entries_.clear();
    find_loads(extra_force);
    work -= 0.5 * loads_.dot(step);
    if (settled) break;
  }
  coordinates = here_.coordinates;
  return work;
}

}  // namespace der
