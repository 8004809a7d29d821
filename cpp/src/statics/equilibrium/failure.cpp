#include <array>

#include "der/core/error.hpp"
#include "der/statics/equilibrium_failure.hpp"

namespace der {
namespace {

/// One row of the table of failures. An empty message stands for the detail.
struct FailureInfo {
  EquilibriumFailure cause;
  const char* status;
  const char* message;
  const char* advice;
};

constexpr const char* kSearchFurther =
    "Does an equilibrium exist under this load? A start nearer to it, a finer mesh or a run over "
    "time with damping may show.";
constexpr const char* kHold =
    "Is the structure held against every rigid motion, rotation included?";
constexpr const char* kRefine = "Give the rod more nodes.";

constexpr std::array<FailureInfo, 10> kFailures{{
    {EquilibriumFailure::NewtonFailed, "not_converged", "", kSearchFurther},
    {EquilibriumFailure::StepsUsedUp, "not_converged",
     "the pseudo-time steps ran out before the forces were in balance", kSearchFurther},
    {EquilibriumFailure::OnlySaddles, "not_converged", "only unstable equilibria were found",
     kSearchFurther},
    {EquilibriumFailure::NotHeld, "not_held", "",
     "Add a support that holds it, or balance the loads."},
    {EquilibriumFailure::DriftsAway, "unbounded", "the structure moves away: nothing holds it",
     kHold},
    {EquilibriumFailure::TurnsWithoutEnd, "unbounded", "a moment turns the rod on and on", kHold},
    {EquilibriumFailure::Collapsed, "collapsed",
     "every way that was tried presses a part of a rod together to a point, past which it is no "
     "rod: the load may be too great for its stiffness against shortening, EA",
     "Is the load, or the cross-section, the one that was meant? If so, a start from a bent shape "
     "may find an equilibrium."},
    {EquilibriumFailure::FoldedByLoad, "folded",
     "the rod folds back on itself at one node, where the curvature ends: the mesh is too coarse "
     "for this load",
     kRefine},
    {EquilibriumFailure::FoldedByClamp, "folded",
     "a clamp that turns does not take the rod along: a node folds over on the way, the mesh is "
     "too coarse for the bend there",
     kRefine},
    {EquilibriumFailure::LostInRoundoff, "too_fine",
     "the forces balance to their rounding error, and that hides the shape: the mesh is too fine, "
     "or the rod too stiff against stretching, for double precision",
     "Give the rod fewer nodes (half as many lose sixteen times less to rounding) or a smaller "
     "EA."},
}};

const FailureInfo& info(EquilibriumFailure cause) {
  for (const FailureInfo& row : kFailures) {
    if (row.cause == cause) return row;
  }
  throw Error("internal_error", "a failure of the search for an equilibrium has no description");
}

}  // namespace

const char* status_of(EquilibriumFailure cause) { return info(cause).status; }

std::string message_of(const FailedSearch& failed) {
  const std::string message = info(failed.cause).message;
  return message.empty() ? failed.detail : message;
}

const char* advice_for(EquilibriumFailure cause) { return info(cause).advice; }

}  // namespace der
