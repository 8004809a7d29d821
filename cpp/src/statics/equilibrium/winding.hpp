#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der::statics {

/// For each pair of clamps on a rod: the whole turns by which the rod winds between them, besides
/// the difference of the clamps' directions. They stay the same as long as no node folds over.
/// Planar models only.
std::vector<double> planar_whole_turns(const Model& model, const Configuration& here);

}  // namespace der::statics
