#pragma once

#include <memory>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "output/rod_field.hpp"

namespace der {

/// Whether a rod bends against a stiffness, so that it can bear forces across it.
bool bears_forces_across(const RodMesh& rod, const Model& model);

/// The curvature k of a rod, and the force F in it across its tangent. As the tangent turns, it
/// turns F into the tension T: dT/ds = k . F / stretch - f . t, with the force f along the rod for
/// each of its unstretched length.
class ForceAcross {
 public:
  /// The rod `bears_forces_across`.
  ForceAcross(const RodMesh& rod, const Model& model);

  /// Towards the two directors, or in the plane.
  struct Mean {
    Vec2 curvature = Vec2::Zero();  // [1/m]
    Vec2 force = Vec2::Zero();      // [N], times how many times the rod is as long as unstretched
  };
  /// The means between two arc lengths [m], but for jumps of moments.
  [[nodiscard]] Mean mean(double from, double to, const Model& model, const State& state) const;

 private:
  struct Bend {
    std::unique_ptr<RodField> curvature;
    std::unique_ptr<RodField> moment;
  };

  std::vector<Bend> bends_;
  std::unique_ptr<RodField> twist_, torque_;  // of sections
};

}  // namespace der
