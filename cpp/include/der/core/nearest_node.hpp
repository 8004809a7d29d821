#pragma once

#include <vector>

#include "der/core/types.hpp"

namespace der {

/// Number of the node that is nearest to arc length `s` [m]; the later one of two that are equally
/// near. `arc_length` [m] are those of the nodes in ascending order, at least one.
Index nearest_node(const std::vector<double>& arc_length, double s);

}  // namespace der
