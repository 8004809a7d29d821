#pragma once

#include <string>

namespace der {

/// Why a search for an equilibrium failed.
enum class EquilibriumFailure {
  NewtonFailed,     ///< Newton's method did not converge; the detail is Newton's own message
  StepsUsedUp,      ///< the pseudo-time steps ran out before the forces were in balance
  PathLost,         ///< loads without a potential could not be raised further; the detail says when
  OnlySaddles,      ///< every equilibrium found is unstable
  NotHeld,          ///< a load moves a part as a rigid body; the detail names the part
  HeldTooWeakly,    ///< round-off hides what holds a part; the detail names the part
  DriftsAway,       ///< the structure moves away without end
  TurnsWithoutEnd,  ///< a moment turns the rod without end
  Collapsed,        ///< an edge is compressed to zero length, or a guided edge is turned inside out
  FoldedByLoad,     ///< an edge is folded back on the one before it
  FoldedByClamp,    ///< the rod does not follow a clamp that turns
  LostInRoundoff,   ///< round-off hides the shape
};

/// A cause of failure with the detail that its message quotes, if any.
struct FailedSearch {
  EquilibriumFailure cause = EquilibriumFailure::NewtonFailed;
  std::string detail;
};

/// Name for `summary.json` and programs. Several causes share one: "not_converged", "not_held",
/// "unbounded", "collapsed", "folded" or "too_fine".
const char* status_of(EquilibriumFailure cause);

/// A sentence that says why the search failed, without its full stop.
std::string message_of(const FailedSearch& failed);

/// Advice on what to try next, in whole sentences.
const char* advice_for(EquilibriumFailure cause);

}  // namespace der
