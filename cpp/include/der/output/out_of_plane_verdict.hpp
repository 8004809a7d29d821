#pragma once

#include <optional>
#include <string>

#include "der/output/run.hpp"
#include "der/simulation.hpp"

namespace der {

/// The verdict of the analysis of a planar model on motion out of the plane
/// (statics/out_of_plane.hpp).
struct OutOfPlaneVerdict {
  std::string not_tested;              ///< why it was not tested, as a clause; empty if it was
  std::optional<Stability> stability;  ///< of an equilibrium
  double growth_rate = 0.0;            ///< [1/s] of the fastest motion, of modes
  /// First load factor at which the first branch of a path loses its stability out of the plane, or
  /// the lowest one at which the structure buckles out of it by linear theory.
  std::optional<double> load_factor;
  std::string warning;  ///< a sentence with advice; empty if the structure stays in its plane
};

/// Nothing in space, in a run over time, and of an analysis that failed.
std::optional<OutOfPlaneVerdict> out_of_plane_verdict(const Simulation& simulation,
                                                      const RunOutcome& outcome);

/// "stable in its plane, unstable out of it: 1 direction"
std::string in_and_out_of_plane(const Stability& in_plane, const Stability& out_of_plane);

}  // namespace der
