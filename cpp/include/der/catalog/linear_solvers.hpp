#pragma once

#include <string>
#include <vector>

namespace der {

/// The names that a scene can give as `solver.linear`, `auto` first.
const std::vector<std::string>& linear_solver_names();

}  // namespace der
