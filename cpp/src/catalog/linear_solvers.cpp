#include "der/catalog/linear_solvers.hpp"

namespace der {

const std::vector<std::string>& linear_solver_names() {
  static const std::vector<std::string> names{"auto", "banded", "simplicial_ldlt", "cholmod"};
  return names;
}

}  // namespace der
