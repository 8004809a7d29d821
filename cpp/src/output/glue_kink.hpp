#pragma once

#include <memory>
#include <optional>

#include "der/core/types.hpp"
#include "output/rod_field.hpp"

namespace der {

/// The jump of the curvature at the start of a ring that is glued turned: there the axes of unequal
/// stiffnesses change, and the directions of given natural curvatures. Moments that act at the very
/// place are in it.
class GlueKink {
 public:
  /// None where the rod bends alike on both sides.
  static std::optional<GlueKink> make(const RodMesh& rod, const Model& model);

  /// By how much the derivative of the tangent is larger at the start than at the end [1/m].
  [[nodiscard]] Vec3 jump(const Model& model, const State& state) const;

 private:
  GlueKink(const RodMesh& rod, const Model& model);

  Index first_edge_, last_edge_;                         // in the model
  std::unique_ptr<RodField> curvature_1_, curvature_2_;  // from the start all around to it
};

}  // namespace der
