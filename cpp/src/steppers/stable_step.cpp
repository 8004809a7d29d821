#include "der/steppers/stable_step.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;

/// Largest singular value of the matrix [a b; c d].
double spectral_norm(double a, double b, double c, double d) {
  const double squares = a * a + b * b + c * c + d * d;
  const double determinant = a * d - b * c;
  const double split = squares * squares - 4.0 * determinant * determinant;
  return std::sqrt(0.5 * (squares + std::sqrt(std::max(0.0, split))));
}

/// Largest singular value.
double spectral_norm(const SmallMatrix& m) {
  if (m.rows() == 2) return spectral_norm(m(0, 0), m(0, 1), m(1, 0), m(1, 1));
  if (!m.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  return Eigen::JacobiSVD<SmallMatrix>(m).singularValues()[0];
}

}  // namespace

StableStepBound::StableStepBound(const Model& model, bool drag_limits_step)
    : model_(model),
      pattern_(build_pattern(model)),
      layout_(MatrixLayout::compressed(pattern_)),
      assembler_(model, layout_),
      inverse_root_mass_(model.mass.lower_bound().cwiseSqrt().cwiseInverse()),
      gradient_(model.num_dofs()),
      values_(assembler_.num_values()),
      sums_(model.num_nodes) {
  // Rotations of joints follow the positions: without them the stiffness is not less.
  inverse_root_mass_.tail(model.dofs.num_rotations()).setZero();
  block_size_ = model.dimension + (model.framed_edges.empty() ? 0 : 1);
  find_blocks();
  if (!drag_limits_step) return;
  for (const Index dof : model.dofs.free()) {
    const double rate = model.damping[dof] * inverse_root_mass_[dof] * inverse_root_mass_[dof];
    if (rate <= damping_rate_) continue;
    damping_rate_ = rate;
    most_damped_ = dof;
  }
}

Index StableStepBound::place_in_block(Index dof) const {
  const Dof what = model_.dofs[dof];
  return what.kind == DofKind::Angle ? model_.dimension : what.component;
}

void StableStepBound::find_blocks() {
  std::map<std::pair<Index, Index>, Block> blocks;
  const auto add = [&](Index row_dof, Index column_dof, Index slot) {
    const Index row = model_.dofs.node_of(row_dof);
    const Index column = model_.dofs.node_of(column_dof);
    const auto [found, is_new] = blocks.try_emplace({row, column});
    Block& block = found->second;
    if (is_new) {
      block.row = row;
      block.column = column;
      block.slots.fill(layout_.num_values());  // the spare one, for entries that are not there
    }
    const Index place = block_size_ * place_in_block(row_dof) + place_in_block(column_dof);
    block.slots[to_size(place)] = slot;
    block.scale[to_size(place)] = inverse_root_mass_[row_dof] * inverse_root_mass_[column_dof];
  };
  for (Index column = 0; column < pattern_.size; ++column) {
    for (Index k = pattern_.outer[to_size(column)]; k < pattern_.outer[to_size(column + 1)]; ++k) {
      const Index row_dof = model_.dofs.free()[to_size(pattern_.inner[to_size(k)])];
      const Index column_dof = model_.dofs.free()[to_size(column)];
      const Index first_rotation = model_.dofs.rotation(0);
      if (row_dof >= first_rotation || column_dof >= first_rotation) continue;
      add(row_dof, column_dof, k);
      // The pattern has only the lower half of a block on the diagonal.
      if (model_.dofs.node_of(row_dof) == model_.dofs.node_of(column_dof))
        add(column_dof, row_dof, k);
    }
  }
  for (const auto& [nodes, block] : blocks) blocks_.push_back(block);
}

double StableStepBound::evaluate(const Configuration& here) {
  viscous_rate_ = 0.0;
  if (model_.viscous) {
    values_.setZero();
    assembler_.add_internal_damping(here, 1.0, values_);
    viscous_rate_ = largest_sum();
    sums_.maxCoeff(&most_viscous_);
  }
  assembler_.gradient_and_hessian(here, gradient_, values_);
  const double w2 = largest_sum();
  const double g = damping_rate_ + viscous_rate_;
  // Positive root of dt^2 w2 + 2 dt g = 4, in the form that is stable for small w2 and small g.
  const double step = 4.0 / (g + std::sqrt(g * g + 4.0 * w2));
  return std::isnan(step) ? 0.0 : step;
}

/// Sets the sums over each node's blocks of the values; returns the largest.
double StableStepBound::largest_sum() {
  values_[layout_.num_values()] = 0.0;
  sums_.setZero();
  for (const Block& block : blocks_) {
    SmallMatrix matrix(block_size_, block_size_);
    for (Index i = 0; i < block_size_ * block_size_; ++i) {
      matrix(i / block_size_, i % block_size_) =
          block.scale[to_size(i)] * values_[block.slots[to_size(i)]];
    }
    const double norm = spectral_norm(matrix);
    sums_[block.row] += norm;
    if (block.row != block.column) sums_[block.column] += norm;
  }
  return sums_.size() > 0 ? sums_.maxCoeff<Eigen::PropagateNaN>() : 0.0;
}

StableStep StableStepBound::explain(const Configuration& here) {
  StableStep result;
  result.step = evaluate(here);
  result.limited_by = "nothing";
  if (std::isinf(result.step)) return result;

  Index node = 0;
  const double w2 = sums_.maxCoeff<Eigen::PropagateNaN>(&node);
  if (damping_rate_ * damping_rate_ >= w2) {
    result.limited_by = "drag";
    result.worst_dof = most_damped_;
    return result;
  }
  if (viscous_rate_ * viscous_rate_ >= w2) {
    result.limited_by = "internal damping";
    result.worst_dof = model_.dofs.position(most_viscous_, 0);
    return result;
  }
  double largest = 0.0;
  for (const EnergyTermInfo& row : kEnergyTerms) {
    const double bound = row.elastic ? term_bound(row.term, node, here) : 0.0;
    if (bound <= largest) continue;
    largest = bound;
    result.limited_by = row.name;
  }
  double stiffest = -1.0;
  for (Index i = 0; i < pattern_.size; ++i) {
    const Index dof = model_.dofs.free()[to_size(i)];
    if (model_.dofs.node_of(dof) != node) continue;
    const double stiffness = std::abs(values_[layout_.slot(i, i)]);
    if (stiffness <= stiffest) continue;
    stiffest = stiffness;
    result.worst_dof = dof;
  }
  return result;
}

/// The sum over a node's blocks from the elements counted under one term [1/s^2].
double StableStepBound::term_bound(EnergyTerm term, Index node, const Configuration& here) const {
  std::map<Index, SmallMatrix> blocks;  // by the other node
  const DofMap& map = model_.dofs;
  for_each_list(*model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if (Kernel::kTerm != term) return;
    LocalTerm<Kernel::kDofs> local;
    for (std::size_t e = 0; e < list.size(); ++e) {
      const auto& dofs = list.dofs[e];
      const auto is_here = [&](Index dof) { return map.node_of(dof) == node && map.is_free(dof); };
      if (std::none_of(dofs.begin(), dofs.end(), is_here)) continue;
      evaluate_element<Kernel, Derivatives::Hessian>(list.constants[e], here,
                                                     gather(dofs, here.coordinates), local);
      for (int i = 0; i < Kernel::kDofs; ++i) {
        for (int j = 0; j < Kernel::kDofs; ++j) {
          const Index row = dofs[to_size(i)];
          const Index column = dofs[to_size(j)];
          if (!is_here(row) || !map.is_free(column)) continue;
          const SmallMatrix none = SmallMatrix::Zero(block_size_, block_size_);
          SmallMatrix& block = blocks.try_emplace(map.node_of(column), none).first->second;
          block(place_in_block(row), place_in_block(column)) +=
              local.hessian(std::max(i, j), std::min(i, j)) * inverse_root_mass_[row] *
              inverse_root_mass_[column];
        }
      }
    }
  });
  double sum = 0.0;
  for (const auto& [other, block] : blocks) {
    sum += spectral_norm(block);
  }
  return sum;
}

StableStep stable_step(const Model& model, const Vector& positions, bool drag_limits_step) {
  Configuration here{positions, {}};
  model.tables.evaluate(0.0, here.controls);
  return StableStepBound(model, drag_limits_step).explain(here);
}

std::string describe_stable_step(const StableStep& stable, const std::string& integrator,
                                 const Model& model) {
  return fmt::format("the stable step of {}, {:.3g} s, which {} at {} sets", integrator,
                     stable.step, stable.limited_by, describe_dof(model, stable.worst_dof));
}

}  // namespace der
