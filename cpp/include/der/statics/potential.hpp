#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/edge_change.hpp"
#include "der/model/model.hpp"

namespace der {

/// Change of the potential energy [J] from one shape to another, elastic and of the loads. `force`
/// [N] is what acts besides the elements, `to` are coordinates under the same controls.
/// Differences are formed element by element, so that they are exact to rounding of the change and
/// not of the whole. Between the two no edge may turn by more than half a turn: the potential of a
/// moment is known up to whole turns.
double potential_change(const Model& model, const Vector& force, const Configuration& from,
                        const Vector& to);

/// d' K d [J] of the stiffness K here for a displacement `direction` (all degrees of
/// freedom) [m]. Taken element by element relative to the element's first node where a translation
/// costs it no energy, it loses nothing to the rounding of the assembled matrix: rigid motions of
/// unloaded elements give 0.
double second_variation(const Model& model, const Configuration& here, const Vector& direction);

/// The same, with |d|' |K| |d| summed likewise: rounding errors are a few epsilons of that sum.
struct SummedVariation {
  double value = 0.0;
  double terms = 0.0;
};
SummedVariation summed_variation(const Model& model, const Configuration& here,
                                 const Vector& direction);

/// d_i' K d_j likewise, for several displacements at once, one a column.
struct SecondVariations {
  Eigen::MatrixXd values;  ///< d_i' K d_j [J]
  Vector terms;            ///< of each d_i' K d_i the terms as above [J]
};
SecondVariations second_variations(const Model& model, const Configuration& here,
                                   const Eigen::MatrixXd& directions);

/// K d [N] of the same stiffness, element by element as above; all degrees of freedom.
Vector stiffness_product(const Model& model, const Configuration& here, const Vector& direction);

/// The largest turning angle [rad] at a node that bends.
double largest_turning_angle(const Model& model, const Vector& positions);

}  // namespace der
