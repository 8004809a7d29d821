#pragma once

#include <string>

namespace der::scenario {

struct Solver {
  std::string linear = "auto";  ///< a name of the linear-solver registry, or `auto`
  /// Newton stops when the residual is below this fraction of the acting forces ...
  double residual_tolerance = 1e-9;
  /// ... and the step below this fraction of the structure's size.
  double step_tolerance = 1e-9;
  int max_iterations = 50;
};

}  // namespace der::scenario
