#include "der/solvers/stage.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/assembly/discrete_gradient_assembler.hpp"
#include "der/core/index.hpp"
#include "der/core/loops.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/model/edge_change.hpp"
#include "der/model/internal_damping.hpp"
#include "der/model/spin.hpp"
#include "der/solvers/newton_step.hpp"
#include "solvers/stage_kernels.hpp"

namespace der {
namespace {

/// B of the tangents of all circulatory loads side by side, with N = 0.
LowRank circulatory_rank(const Model& model) {
  LowRank result;
  for (const CirculatoryLoad& load : circulatory_loads(*model.elements)) {
    for (const auto& coordinate : load.coordinates) {
      auto& column = result.columns.emplace_back();
      for (const auto& [dof, weight] : coordinate) {
        if (model.dofs.is_free(dof)) column.push_back({model.dofs.free_index(dof), weight});
      }
    }
  }
  result.core.setZero(result.rank(), result.rank());
  return result;
}

}  // namespace

Stage::Stage(const Model& model)
    : origin(Vector::Zero(model.num_dofs())),
      inertia_target(Vector::Zero(model.num_dofs())),
      velocity_reference(Vector::Zero(model.num_dofs())),
      force(Vector::Zero(model.num_dofs())) {}

StageProblem::StageProblem(const Model& model, const Assembler& assembler, Mass mass)
    : model_(model),
      assembler_(assembler),
      mass_(std::move(mass)),
      mass_values_(Vector::Zero(assembler.num_values())),
      tension_(model, assembler),
      circulatory_(circulatory_rank(model)),
      guess_(Vector::Zero(model.num_dofs())),
      displacement_(Vector::Zero(model.num_dofs())),
      term_(Vector::Zero(model.num_dofs())),
      velocities_(Vector::Zero(model.viscous ? model.num_dofs() : 0)) {
  assembler_.add_mass(mass_, 1.0, mass_values_);
}

void StageProblem::pose(const Stage& stage, Configuration& here) {
  stage_ = &stage;
  here_ = &here;
}

void StageProblem::begin(Vector& displacement) {
  guess_ = here_->coordinates;
  external_ = model_.dofs.largest_force(stage_->force);
  displacement_ = guess_ - stage_->origin;
  displacement = displacement_;
}

void StageProblem::begin_again(Vector& displacement) {
  here_->coordinates = guess_;
  displacement_ = guess_ - stage_->origin;
  displacement = displacement_;
}

void StageProblem::solution_changed(const Vector& displacement) {
  displacement_ = displacement;
  for (const Index dof : model_.dofs.free()) {
    here_->coordinates[dof] = stage_->origin[dof] + displacement[dof];
  }
}

void StageProblem::residual(Vector& residual) {
  if (stage_->discrete_gradient != nullptr) {
    stage_->discrete_gradient->gradient(*here_, residual);
  } else {
    assembler_.gradient(*here_, residual);
  }
  add_stage_forces(residual);
}

void StageProblem::system(Vector& residual, Vector& values) {
  values = stage_->inertia * mass_values_;
  if (stage_->discrete_gradient != nullptr) {
    stage_->discrete_gradient->add_hessian(*here_, residual, values);
  } else {
    assembler_.add_hessian(*here_, residual, values);
  }
  add_stage_forces(residual);
  set_circulatory_tangent();
  if (stage_->velocity_factor != 0.0 && model_.damped) {
    assembler_.add_diagonal(model_.damping, stage_->velocity_factor, values);
  }
  if (has_viscous_forces()) {
    assembler_.add_internal_damping(*here_, stage_->velocity_factor, values);
  }
}

/// The tensions of a discrete gradient are those over the whole step, not those that a step of
/// Newton's method has put in.
void StageProblem::mixed_point_update(const Vector& step, double taken, Vector& values) {
  if (stage_->discrete_gradient == nullptr) tension_.use(*here_, step, taken, values);
}

void StageProblem::remove_mixed_point_part(Vector& values) {
  if (stage_->discrete_gradient == nullptr) tension_.remove(*here_, values);
}

/// Rigid translation does not count.
StepBound StageProblem::largest_step(const Vector& step) {
  return bound_of_change(largest_edge_change(model_, step));
}

double StageProblem::position_rounding() const {
  return rounding_of(model_.dofs.largest_motion(here_->coordinates));
}

/// Positions and angles are known to their rounding, displacements to their own.
double StageProblem::residual_rounding(Vector& values) {
  assembler_.gradient_and_hessian(*here_, term_, values);
  const auto of_matrix = [&](const Vector& known) {
    double largest = 0.0;
    for (const DofBlock& block : model_.dofs.blocks()) {
      const double value = largest_magnitude(block.count, known.data() + block.first);
      largest += assembler_.largest_diagonal(block, values) * value / block.length;
    }
    return largest;
  };
  double internal = of_matrix(here_->coordinates);
  if (has_viscous_forces()) {
    values.setZero();
    assembler_.add_internal_damping(*here_, stage_->velocity_factor, values);
    internal += of_matrix(displacement_);
  }
  const auto largest_term = [&](const Vector& diagonal) {
    term_ = diagonal.cwiseProduct(displacement_);
    return model_.dofs.largest_force(term_);
  };
  return rounding_of(internal + stage_->inertia * largest_term(mass_.lumped) +
                     stage_->velocity_factor * largest_term(model_.damping));
}

/// One block of N for each load.
void StageProblem::set_circulatory_tangent() {
  if (stage_->is_conservative) return;
  Index first = 0;
  for (const CirculatoryLoad& load : circulatory_loads(*model_.elements)) {
    load.evaluate(*here_, term_of_load_);
    const Index size = static_cast<Index>(term_of_load_.force.size());
    circulatory_.core.block(first, first, size, size) = term_of_load_.tangent;
    first += size;
  }
}

/// The forces on nodes by which spinning sections enter a motion, `residual` being the elastic
/// ones. Newton's matrix leaves the gyroscopic ones out: their derivative is skew.
void StageProblem::add_spin_forces(Vector& residual) const {
  const auto rate = [&](Index dof) { return velocity(dof); };
  const auto force = [&](const SpatialEdge& edge, Index number, const Vec3& vector) -> Vec3 {
    return transport_force(vector, number, residual[edge.theta], here_->controls) +
           gyroscopic_force(edge, vector, mass_, rate);
  };
  take_pairs(model_, *here_, force, residual);
}

double StageProblem::gyroscopic_share() const {
  double largest = 0.0;
  const Vector& lumped = mass_.lumped;
  for (const SpatialEdge& edge : model_.framed_edges) {
    const double spin = lumped[edge.theta] * std::abs(velocity(edge.theta));
    const double squared = edge.vector(here_->coordinates, here_->controls).squaredNorm();
    const double inertia = stage_->inertia * std::min(lumped[edge.start], lumped[edge.end]);
    largest = std::max(largest, stage_->velocity_factor * spin / (squared * inertia));
  }
  return largest;
}

/// Takes the external forces from `residual`; returns the largest force [N] that was there.
double StageProblem::subtract_external(Vector& residual) const {
  return largest_over(model_.dofs.blocks(), [&](const DofBlock& block) {
    const Index i = block.first;
    const double largest = dispatch_simd(
        [&] { return subtract_force(block.count, stage_->force.data() + i, residual.data() + i); });
    return largest / block.length;
  });
}

/// Adds factor * diagonal (displacement - target), and sets `term_` to that without the diagonal;
/// returns the largest of these forces [N].
double StageProblem::add_diagonal_forces(double factor, const Vector& diagonal,
                                         const Vector& target, Vector& residual) {
  return largest_over(model_.dofs.blocks(), [&](const DofBlock& block) {
    const Index i = block.first;
    const double largest = dispatch_simd([&] {
      return add_lumped_inertia(block.count, factor, diagonal.data() + i, displacement_.data() + i,
                                target.data() + i, term_.data() + i, residual.data() + i);
    });
    return largest / block.length;
  });
}

/// Returns the largest of these forces [N].
double StageProblem::add_viscous_forces(Vector& residual) {
  velocities_ = stage_->velocity_factor * (displacement_ - stage_->velocity_reference);
  term_.setZero();
  der::add_viscous_forces(model_, {*here_, velocities_, stage_->turn_rates}, term_);
  residual += term_;
  return model_.dofs.largest_force(term_);
}

void StageProblem::add_stage_forces(Vector& residual) {
  if (stage_->is_motion) add_spin_forces(residual);
  acting_ = std::max(subtract_external(residual), external_);
  if (stage_->inertia != 0.0) {
    acting_ = std::max(acting_, add_diagonal_forces(stage_->inertia, mass_.lumped,
                                                    stage_->inertia_target, residual));
    const Vector& acceleration = term_;  // minus it
    for (const auto& [a, b, mass] : mass_.coupling) {
      const double inertial = mass * (acceleration[a] - acceleration[b]);
      residual[a] -= inertial;
      residual[b] += inertial;
    }
  }
  if (stage_->velocity_factor != 0.0 && model_.damped) {
    acting_ = std::max(acting_, add_diagonal_forces(stage_->velocity_factor, model_.damping,
                                                    stage_->velocity_reference, residual));
  }
  if (has_viscous_forces()) acting_ = std::max(acting_, add_viscous_forces(residual));
}

}  // namespace der
