#pragma once

#include <memory>

#include "der/solvers/linear_solver.hpp"

namespace der {

/// Eigen's SimplicialLDLT with its fill-reducing ordering (AMD), for graphs with a wide band.
std::unique_ptr<LinearSolver> make_simplicial_ldlt(const Pattern& pattern);

/// CHOLMOD's simplicial L D L^T (LGPL; its supernodal module, which is GPL, is not used). Throws
/// Error if der was built without CHOLMOD.
std::unique_ptr<LinearSolver> make_cholmod(const Pattern& pattern);

}  // namespace der
