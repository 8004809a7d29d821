#pragma once

#include <Eigen/Core>
#include <string>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/statics/initial_stress.hpp"

namespace der {

/// What the stresses of linear buckling do to motions that nothing resists without loads, such as
/// the spin of a rod in its clamps.
struct NeutralMotions {
  enum class Stresses {
    LeaveThem,     ///< the motions have no part in the factors
    UpsetThem,     ///< any load makes one of them unstable: the factor is 0
    ActOtherwise,  ///< terms of second order in the loads decide, of which K1 does not have all
  };
  Stresses stresses = Stresses::LeaveThem;
  std::string rod;  ///< that moves in them, unless they are left alone
};

/// `neutral` has a basis of the motions, one a column over the free degrees of freedom.
NeutralMotions judge_neutral_motions(const Model& model, const Eigen::MatrixXd& neutral,
                                     const InitialStress& stress);

/// Whether a force [N] over the free degrees of freedom does work in one of the motions.
bool does_work(const Model& model, const Vector& force, const Eigen::MatrixXd& neutral);

}  // namespace der
