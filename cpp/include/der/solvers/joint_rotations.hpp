#pragma once

#include <memory>
#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/solvers/spatial_joint_rotations.hpp"

namespace der {

/// The rotations of joints have no inertia: where the nodes are, and the moments that act,
/// determine them. Schemes that integrate over time would let them ring; each step and each start
/// of a run settles them. Allocates nothing once it is made.
class JointRotations {
 public:
  explicit JointRotations(const Model& model);

  /// Sets the free rotations in `coordinates` so that the moments on each add up to nothing, at
  /// these controls and forces from outside. Does nothing in a model without joints. Returns the
  /// work [J] that the moments do on the way.
  double settle(const Vector& controls, const Vector& extra_force, Vector& coordinates);

 private:
  /// An entry of the stiffness between two rotations, which a leg of one or two cells makes [N m].
  struct Coupling {
    std::size_t a = 0, b = 0;  ///< numbers among the free ones
    double value = 0.0;
  };

  template <class Use>
  void for_each_element(const Use& use) const;
  [[nodiscard]] Index number_of(Index dof) const;
  void assemble();
  void solve();

  const Model& model_;
  std::unique_ptr<SpatialJointRotations> in_space_;  // null: in a plane
  std::vector<Index> free_;                          // degrees of freedom
  std::vector<Index> number_;                        // of each rotation among these; -1: held
  std::vector<ControlledForce> moments_;             // on these
  std::vector<Coupling> couplings_;                  // in the order of the elements
  std::vector<std::vector<std::size_t>> beside_;     // numbers of the couplings of each rotation
  Configuration here_;
  Vector residual_;   // the gradient of the energy less the moments [N m]
  Vector stiffness_;  // on the diagonal [N m]
  Vector step_;       // [rad]
};

}  // namespace der
