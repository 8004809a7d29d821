#pragma once

#include <vector>

#include "der/scenario/rod.hpp"

namespace der::scenario {

/// Where a node of a new mesh stands among those of the old one: a share of the way from one to the
/// next.
struct OldPlace {
  int before = 0;
  double share = 0.0;
};

/// The nodes of an even, planar rod at which its list of natural curvatures jumps, as of
/// RodMesh::natural_jumps (model/curvature_jump.hpp); `cell`: the length of an edge [m].
std::vector<int> natural_jumps(const Rod& rod, double cell);

/// Gives a rod's lists with a value for each node those of a new mesh, linear between the old ones:
/// initial velocities, natural curvatures and twists. At `jumps`, old nodes, the natural curvature
/// of a planar rod has two values, to which its sides are continued.
void resample_lists(const std::vector<OldPlace>& nodes, const std::vector<int>& jumps, Rod& rod);

}  // namespace der::scenario
