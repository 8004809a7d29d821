#pragma once

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// JointRotations in space: Newton's method for the three coordinates of each joint that is free.
class SpatialJointRotations {
 public:
  explicit SpatialJointRotations(const Model& model);

  /// JointRotations::settle.
  double settle(const Vector& controls, const Vector& extra_force, Vector& coordinates);

 private:
  template <class Use>
  void for_each_element(const Use& use) const;
  void assemble(const Vector& extra_force);
  /// Moments of loads and of programs, on all degrees of freedom.
  void find_loads(const Vector& extra_force);

  const Model& model_;
  std::vector<Index> free_;           // degrees of freedom
  std::vector<Index> number_;         // of each coordinate among these; -1: held
  std::vector<std::size_t> moments_;  // numbers of circulatory loads
  Configuration here_;
  Vector residual_;  // the gradient of the energy less the moments [N m]
  Vector loads_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::SparseMatrix<double> stiffness_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace der
