#include "der/solvers/linear_solver.hpp"

#include "der/core/error.hpp"
#include "der/solvers/banded_ldlt.hpp"
#include "der/solvers/names.hpp"
#include "der/solvers/sparse_ldlt.hpp"

namespace der {
namespace {

/// Up to this half-bandwidth the band solver beats a general sparse one on rod networks; a chain
/// has 5 in the plane.
constexpr Index kNarrowBand = 32;

std::unique_ptr<LinearSolver> make_banded(const Pattern& pattern) {
  return std::make_unique<BandedLdlt>(pattern);
}

struct LinearSolverInfo {
  const char* name;
  std::unique_ptr<LinearSolver> (*make)(const Pattern&);
};

/// Every linear solver. A new one is one file and one line here.
constexpr LinearSolverInfo kSolvers[] = {
    {"banded", make_banded},
    {"simplicial_ldlt", make_simplicial_ldlt},
    {"cholmod", make_cholmod},
};

}  // namespace

const std::vector<std::string>& linear_solver_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"auto"};
    for (const auto& info : kSolvers) all.emplace_back(info.name);
    return all;
  }();
  return names;
}

LinearSolverChoice make_linear_solver(const std::string& name, const Pattern& pattern) {
  if (name == "auto") {
    const std::string width = "half-bandwidth " + std::to_string(pattern.half_bandwidth);
    return pattern.half_bandwidth <= kNarrowBand
               ? LinearSolverChoice{make_banded(pattern), width + " is narrow"}
               : LinearSolverChoice{make_simplicial_ldlt(pattern), width + " is wide"};
  }
  for (const auto& info : kSolvers) {
    if (name == info.name) return {info.make(pattern), "asked for by the scene"};
  }
  throw Error("model_error", "unknown linear solver '" + name + "'");
}

}  // namespace der
