#include "der/solvers/linear_solver.hpp"

#include "der/core/error.hpp"
#include "der/solvers/banded_ldlt.hpp"
#include "der/solvers/bordered_ldlt.hpp"
#include "der/solvers/sparse_ldlt.hpp"
#include "der/solvers/twisted_ldlt.hpp"

namespace der {
namespace {

/// Up to this half-bandwidth the band solver beats a general sparse one on rod networks; a chain
/// has 5 in the plane.
constexpr Index kNarrowBand = 32;

std::unique_ptr<LinearSolver> make_banded(const Pattern& pattern, Elimination order) {
  if (!pattern.borders.empty()) return std::make_unique<BorderedLdlt>(pattern);
  if (order == Elimination::FromBothEnds && TwistedLdlt::suits(pattern)) {
    return std::make_unique<TwistedLdlt>(pattern);
  }
  return std::make_unique<BandedLdlt>(pattern);
}

/// A solver that finds an order of its own.
template <std::unique_ptr<LinearSolver> (*make)(const Pattern&)>
std::unique_ptr<LinearSolver> make_sparse(const Pattern& pattern, Elimination /*order*/) {
  return make(pattern);
}

struct LinearSolverInfo {
  const char* name;
  std::unique_ptr<LinearSolver> (*make)(const Pattern&, Elimination);
};

/// Every linear solver of the catalog. A new one is one file, one line here and one there.
constexpr LinearSolverInfo kSolvers[] = {
    {"banded", make_banded},
    {"simplicial_ldlt", make_sparse<make_simplicial_ldlt>},
    {"cholmod", make_sparse<make_cholmod>},
};

}  // namespace

LinearSolverChoice make_linear_solver(const std::string& name, const Pattern& pattern,
                                      Elimination order) {
  if (name == "auto") {
    const std::string width = "half-bandwidth " + std::to_string(pattern.half_bandwidth);
    return pattern.half_bandwidth <= kNarrowBand
               ? LinearSolverChoice{make_banded(pattern, order), width + " is narrow"}
               : LinearSolverChoice{make_simplicial_ldlt(pattern), width + " is wide"};
  }
  for (const auto& info : kSolvers) {
    if (name == info.name) return {info.make(pattern, order), "asked for by the scene"};
  }
  throw Error("model_error", "unknown linear solver '" + name + "'");
}

}  // namespace der
