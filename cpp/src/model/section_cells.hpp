#pragma once

#include "der/kinematics/configuration.hpp"
#include "der/model/energies.hpp"
#include "der/model/model.hpp"

namespace der {

/// Energies [J] of the cells of a rod in space, in which it bends and twists on from where its
/// edges are known to the places of moments and springs against turning. What moments store there
/// is added; springs and their cells are elements in series, whose energy is divided.
Energies section_cell_energies(const RodMesh& rod, const Model& model, const Configuration& here);

/// Elastic energy [J] of the cells under the moments of loads alone.
double stored_by_section_moments(const Model& model, const Configuration& here);

}  // namespace der
