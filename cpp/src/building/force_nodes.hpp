#pragma once

#include "der/model/model.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

/// Sets RodMesh::bears_force and divides_places, which places of supports and loads between nodes
/// need. Spheres are known before.
void find_force_nodes(const scenario::Scene& scene, Model& model);

}  // namespace der
