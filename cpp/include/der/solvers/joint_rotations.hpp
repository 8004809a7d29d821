#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "der/core/index.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/spatial_joint_rotations.hpp"

namespace der {

/// The rotations of joints have no inertia: where the nodes are, and the moments that act,
/// determine them. Schemes that integrate over time would let them ring; each step and each start
/// of a run settles them. Beside a rod whose bending is damped a rotation lags behind: the moments
/// on it, with those of its rate, add up to nothing, an equation of first order in time. Allocates
/// nothing once it is made.
class JointRotations {
 public:
  /// Which rotations to settle: all, or those that do not lag behind.
  enum class Which { All, Undamped };
  explicit JointRotations(const Model& model);

  [[nodiscard]] bool any_lags() const { return num_lagging_ > 0; }
  /// Whether a rotation, if it is not held, lags behind.
  [[nodiscard]] bool lags(Index rotation) const { return lags_[to_size(rotation)]; }

  /// Sets the free rotations in `coordinates`, or some of them, so that the elastic moments on each
  /// add up to nothing, at these controls and forces from outside. Does nothing in a model without
  /// joints. Returns the work [J] that the moments do on the way.
  double settle(const Vector& controls, const Vector& extra_force, Vector& coordinates,
                Which which = Which::All);

  /// Sets the rates [rad/s] of those that lag behind at `here`, where the nodes have the others of
  /// `velocities`. What damping does not determine, as the common rate of the two sides of a damped
  /// hinge, stays.
  void set_rates(const Configuration& here, const Vector& extra_force, Vector& velocities);

  /// The motion of the nodes over a step: each coordinate follows a cubic.
  struct Motion {
    const State& state;        ///< tables are read with it; its time is that of the start
    const Vector& start;       ///< coordinates
    const Vector& start_rate;  ///< [m/s]
    double dt = 0.0;           ///< [s]
  };
  struct Works {
    double loads = 0.0;  ///< [J]
    double drag = 0.0;   ///< taken by internal damping [J]
  };
  /// Moves all free rotations over a step at whose end the nodes have `coordinates` and
  /// `velocities`, to which their rates are added. By the L-stable method of order 2 of Alexander
  /// (SIAM J. Numer. Anal. 14, 1977). Returns the works on the way from the rotations that
  /// `coordinates` have on entry.
  Works advance(const Motion& motion, Vector& coordinates, Vector& velocities);

 private:
  /// An entry of the matrix between two rotations, which a leg of one or two cells makes, or what
  /// acts between the sides of a hinge [N m].
  struct Coupling {
    Index a = 0, b = 0;  ///< numbers among the free ones
    double value = 0.0;
  };

  template <class Use>
  void for_each_element(const Use& use) const;
  template <class Use>
  void for_each_damped(const Use& use) const;
  template <class Use>
  void for_each_free(const Use& use) const;
  template <class Kernel>
  [[nodiscard]] std::array<Index, 2> rotations_of(
      const std::array<Index, to_size(Kernel::kDofs)>& dofs) const;
  [[nodiscard]] Index number_of(Index dof) const;
  void find_lagging(const Model& model);
  void begin_system();
  void clear_matrix();
  void keep(bool lagging);
  void add_elastic();
  void add_viscous(double rate_factor);
  void subtract_moments(const Vector& extra_force);
  void solve();
  bool take(Vector& coordinates) const;
  void solve_stage(double rate_factor, const Vector& extra_force);

  const Model& model_;
  std::unique_ptr<SpatialJointRotations> in_space_;  // null: in a plane
  std::vector<bool> lags_;                           // of each rotation
  std::size_t num_lagging_ = 0;                      // free ones
  std::vector<Index> free_;                          // degrees of freedom
  std::vector<Index> number_;                        // of each rotation among these; -1: held
  std::vector<ControlledForce> moments_;             // on these
  std::vector<Coupling> couplings_;  // in the order of the elements, then the damped
  Configuration here_;
  Vector velocities_;
  Vector reference_;  // of rotations, from which their rates in a stage count [rad]
  Vector residual_;   // the gradient of the energy less the moments [N m]
  Vector stiffness_;  // on the diagonal [N m]
  Vector step_;       // [rad]
  Vector direction_;  // of `solve`, with the three below
  Vector along_;      // the matrix times the direction
  Vector remains_;
  Vector scaled_;  // what remains over the diagonal
};

}  // namespace der
