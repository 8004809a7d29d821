#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// The rotations of joints have no inertia: where the nodes are, and the moments that act, determine
/// them. Schemes that integrate over time would let them ring; each step and each start of a run
/// settles them.
class JointRotations {
 public:
  explicit JointRotations(const Model& model);

  /// Sets the free rotations in `coordinates` so that the moments on each add up to nothing, at
  /// these controls and forces from outside. Does nothing in a model without joints.
  void settle(const Vector& controls, const Vector& extra_force, Vector& coordinates);

 private:
  void assemble(const Configuration& here);

  const Model& model_;
  std::vector<Index> free_;                // degrees of freedom
  std::vector<Index> number_;              // of each rotation among the free ones; -1: held
  std::vector<ControlledForce> moments_;   // on these
  Configuration here_;
  Vector gradient_;                        // of the energy, then less the moments [N m]
  Eigen::SparseMatrix<double> stiffness_;  // lower triangle [N m]
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace der
