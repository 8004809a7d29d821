#include "der/statics/equilibrium_failure.hpp"

namespace der {
namespace {

/// The texts about a failure. An empty message means that the detail of the search is shown.
struct FailureInfo {
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

FailureInfo info(EquilibriumFailure cause) {
  switch (cause) {
    case EquilibriumFailure::NewtonFailed:
      return {"not_converged", "", kSearchFurther};
    case EquilibriumFailure::StepsUsedUp:
      return {"not_converged", "the pseudo-time steps ran out before the forces were in balance",
              kSearchFurther};
    case EquilibriumFailure::PathLost:
      return {"not_converged", "",
              "The path may turn back there, or the shape change fast. A finer mesh or a run over "
              "time with damping may show what the rod does beyond."};
    case EquilibriumFailure::OnlySaddles:
      return {"not_converged", "only unstable equilibria were found", kSearchFurther};
    case EquilibriumFailure::NotHeld:
      return {"not_held", "", "Add a support that holds it, or balance the loads."};
    case EquilibriumFailure::HeldTooWeakly:
      return {"not_held", "", "Make the springs or the foundation stiffer, or add a support."};
    case EquilibriumFailure::DriftsAway:
      return {
          "unbounded",
          "the structure moves away: nothing holds it, or a load is far beyond what it bears",
          "Is the structure held against every rigid motion, rotation included? Is the load the "
          "one that was meant?"};
    case EquilibriumFailure::TurnsWithoutEnd:
      return {"unbounded", "a moment turns the rod without end", kHold};
    case EquilibriumFailure::Collapsed:
      return {"collapsed",
              "every method that was tried compresses a part of a rod to zero length: the load may "
              "be too great for its axial stiffness, EA",
              "Is the load, or the cross-section, the one that was meant? If so, a start from a "
              "bent shape may find an equilibrium."};
    case EquilibriumFailure::FoldedByLoad:
      return {"folded",
              "the rod folds back on itself at one node, where the curvature ends: the mesh is too "
              "coarse for this load",
              kRefine};
    case EquilibriumFailure::FoldedByClamp:
      return {
          "folded",
          "the rod does not follow a clamp that turns: a node folds over on the way, the mesh is "
          "too coarse for the bend there",
          kRefine};
    case EquilibriumFailure::LostInRoundoff:
      return {"too_fine",
              "the forces balance to their rounding error, and that hides the shape: the mesh is "
              "too fine, or the rod too stiff against stretching, for double precision",
              "Give the rod fewer nodes (half as many lose sixteen times less to rounding) or a "
              "smaller EA."};
  }
  return {};  // no value of the enumeration comes here
}

}  // namespace

const char* status_of(EquilibriumFailure cause) { return info(cause).status; }

std::string message_of(const FailedSearch& failed) {
  const std::string message = info(failed.cause).message;
  return message.empty() ? failed.detail : message;
}

const char* advice_for(EquilibriumFailure cause) { return info(cause).advice; }

}  // namespace der
