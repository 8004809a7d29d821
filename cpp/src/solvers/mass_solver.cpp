#include "der/solvers/mass_solver.hpp"

#include <algorithm>

#include "der/core/index.hpp"

namespace der {

MassSolver::MassSolver(const Model& model)
    : model_(model), diagonal_(model.num_dofs()), free_(model.num_free()) {
  if (model.mass.coupling.empty()) return;
  pattern_ = std::make_unique<Pattern>(build_mass_pattern(model));
  solver_ = make_linear_solver("auto", *pattern_).solver;
  values_.setZero(solver_->layout().num_values());
}

void MassSolver::prepare(double t) {
  diagonal_ = model_.mass.lumped + t * model_.damping;
  // Nothing acts on rotations of joints that are settled.
  diagonal_.tail(model_.dofs.num_rotations()).setOnes();
  prepared_for_ = t;
  if (!solver_) return;
  const MatrixLayout& layout = solver_->layout();
  const auto free = [&](Index dof) { return model_.dofs.free_index(dof); };
  values_.setZero();
  for (const Index dof : model_.dofs.free()) {
    values_[layout.slot(free(dof), free(dof))] = diagonal_[dof];
  }
  for (const auto& [a, b, mass] : model_.mass.coupling) {
    values_[layout.slot(free(a), free(a))] -= mass;
    values_[layout.slot(free(b), free(b))] -= mass;
    values_[layout.slot(std::max(free(a), free(b)), std::min(free(a), free(b)))] += mass;
  }
  solver_->factorize(values_);
}

void MassSolver::solve(double t, Vector& b) {
  // Steps of one length differ in the last bits.
  const bool depends_on_t = prepared_for_ < 0.0 || (model_.damping.array() != 0.0).any();
  if (depends_on_t && t != prepared_for_) prepare(t);
  if (solver_) {
    for (Index i = 0; i < free_.size(); ++i) free_[i] = b[model_.dofs.free()[to_size(i)]];
    solver_->solve(free_);
    for (Index i = 0; i < free_.size(); ++i) b[model_.dofs.free()[to_size(i)]] = free_[i];
  } else {
    b.array() /= diagonal_.array();
  }
  for (const HeldDof& held : model_.held) b[held.dof] = 0.0;
}

}  // namespace der
