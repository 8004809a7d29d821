#pragma once

#include <optional>
#include <string>

#include "der/assembly/assembler.hpp"
#include "der/assembly/pattern.hpp"
#include "der/building/out_of_plane_model.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/statics/stiffness.hpp"

namespace der {

/// Whether a planar equilibrium is stable against displacement out of its plane and twist.
struct OutOfPlane {
  std::string not_tested;  ///< why it was not tested, as a clause; empty if it was
  Stability stability;
  [[nodiscard]] bool tested() const { return not_tested.empty(); }
  /// As `Stability::name`, or "not_tested".
  [[nodiscard]] const char* name() const { return tested() ? stability.name() : "not_tested"; }
};

/// Linear buckling of a planar structure out of its plane.
struct OutOfPlaneBuckling {
  std::string not_tested;  ///< why it was not tested, as a clause; empty if it was
  /// The lowest factor of the loads at which it leaves its plane; nothing if no factor does that.
  std::optional<double> load_factor;
};

/// Tests shapes of a planar model against motion out of the plane: by the inertia of the block of
/// the stiffness in space that belongs to z of the nodes and the angles of the sections
/// (OutOfPlaneModel).
class OutOfPlaneTest {
 public:
  /// `planar` is the model of `scene`; as for `build_out_of_plane_model`.
  OutOfPlaneTest(const scenario::Scene& scene, const Model& planar);

  /// `beat` is called in all that follows, again and again; what it throws ends that.
  void set_beat(const CancelCallback& beat) { beat_ = beat; }

  /// Stability of an equilibrium of the planar model.
  Stability stability(const Configuration& planar);
  /// As in Stiffness, of what lies out of the plane.
  bool is_clear(const Configuration& planar);
  Stability stability_by_pivots(const Configuration& planar);
  /// Growth rate [1/s] of the fastest motion out of the plane; 0 if the equilibrium is stable, and
  /// if a section has no inertia against spin.
  /// Throws as `vibration_modes` does.
  double growth_rate(const Configuration& planar);
  /// The lowest factor of the loads at which the structure buckles out of its plane by linear
  /// theory. `unloaded` is its shape without them, stable in its plane, `response` the displacement
  /// (all degrees of freedom of the planar model) that they cause to first order. Motions that
  /// nothing resists, such as the spin of a rod in its clamps, count only where the loads act on
  /// them.
  OutOfPlaneBuckling buckling(const Configuration& unloaded, const Vector& response);

 private:
  const Model& planar_;
  CancelCallback beat_;
  const OutOfPlaneModel twin_;
  const Pattern pattern_;
  LinearSolverChoice solver_;
  Assembler assembler_;
  Stiffness stiffness_;
};

}  // namespace der
