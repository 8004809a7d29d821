#pragma once

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// Lets a Newton step take the stiffness across the edges from the tension that the step before
/// predicted to first order, in place of the current tension. The latter holds what the
/// second-order stretch of a turning step has falsely put into the edges, EA theta^2/2, which
/// freezes the next step or makes its matrix indefinite; at the solution the two are the same (the
/// mixed-integration-point Newton of Magisano, Leonetti and Garcea, Comput. Methods Appl. Mech.
/// Engrg. 313, 2017).
class PredictedTension {
 public:
  PredictedTension(const Model& model, const Assembler& assembler);

  /// Puts the tensions predicted by a `step` [m] (all degrees of freedom), of which the share
  /// `taken` led `here`, into a matrix just assembled here, in place of the tensions here.
  void use(const Configuration& here, const Vector& step, double taken, Vector& values);
  /// Takes the stiffness that the tensions give to the edges out of a matrix just assembled `here`.
  void remove(const Configuration& here, Vector& values);

 private:
  template <int Dim>
  void set_excess(const Configuration& here, const Vector& step, double taken);
  template <int Dim>
  void set_release(const Configuration& here);

  const Model& model_;
  const Assembler& assembler_;
  Vector excess_;  // of each edge's tension in the matrix over the current one [N]
};

}  // namespace der
