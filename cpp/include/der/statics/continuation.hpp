#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "der/assembly/assembler.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/newton.hpp"
#include "der/statics/out_of_plane.hpp"
#include "der/statics/stiffness.hpp"

namespace der {

enum class PathEvent {
  None,
  Fold,         ///< a limit point: the factor turns
  Bifurcation,  ///< another path crosses
  OutOfPlane,   ///< of a planar path: directions out of the plane lose or regain their stability
};

/// One equilibrium on a path.
struct PathPoint {
  double factor = 0.0;  ///< of the loads
  double arc = 0.0;     ///< [-] length of the path so far
  Stability stability;
  Stability out_of_plane;  ///< no directions where that is not tested
  PathEvent event = PathEvent::None;
  Vector positions;  ///< all degrees of freedom [m]
  Vector followed;   ///< as in the state [rad]
};

/// A path of equilibria.
struct PathBranch {
  int parent = -1;     ///< branch that it leaves; -1 for the first
  int side = 0;        ///< +1 or -1: to which side of its parent; 0: on from one that ends there
  std::string ending;  ///< why it ends where it does
  std::vector<PathPoint> points;
};

/// All that was traced, and what it cost.
struct TracedPath {
  std::vector<PathBranch> branches;
  std::int64_t newton_iterations = 0;  ///< those of points included that were not kept
};

struct ContinuationOptions {
  NewtonOptions newton;
  double from = 0.0;           ///< first factor
  double to = 1.0;             ///< last factor
  double largest_step = 0.05;  ///< of arc length
  int max_points = 500;        ///< of a branch
  int branching = 0;           ///< how many bifurcations deep other branches are followed
  CancelCallback beat{};       ///< called at least once an iteration; what it throws ends the path
};

/// Traces the equilibria of a model while its loads change in proportion to a factor, through limit
/// points, by pseudo-arclength continuation (Keller, in Applications of Bifurcation Theory, 1977;
/// Riks, Int. J. Solids Struct. 15, 1979): the next point lies on a plane across the predictor,
/// which is the tangent of the path. Arc length adds (change of factor / (to - from))^2 and the
/// mean square displacement of the nodes, in units in which both are of like size at the start.
///
/// The number of unstable directions comes from the inertia of the stiffness. Where it or the sense
/// of the factor changes between two points, the place is found by bisection and put into the path:
/// a fold where the factor turns, else a bifurcation. From there other branches start along the
/// null vector of the stiffness, to both sides.
///
/// No path is traced twice. A branch ends at a bifurcation of another branch if everything beyond
/// it has been traced or will be. No branch starts where its first point lies on a complete one. An
/// event belongs to the branch that meets it first.
///
/// `out_of_plane`, if there is one, tests the points of a planar path against motion out of the
/// plane; where the number of unstable directions changes, the place is found and put into the
/// path, too.
///
/// A branch ends at the factor `to`, at the opposite limit 2 from - to, at its largest number of
/// points, where it closes on itself or meets another one, where no further point is found, or
/// where rounding hides the stability. `start` is an equilibrium at the factor `from`, and the
/// model has a load variation.
TracedPath follow_path(const Model& model, const Assembler& assembler, LinearSolver& solver,
                       const ContinuationOptions& options, OutOfPlaneTest* out_of_plane,
                       const State& start);

}  // namespace der
