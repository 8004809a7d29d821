#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "model/actuated_turn.hpp"
#include "output/actuated_shape.hpp"
#include "output/force_across.hpp"
#include "output/spread_forces.hpp"

namespace der {

/// The tension [N] that edges have in excess because they lean: an edge next to a clamp, and one at
/// an end that is bent, by a natural curvature or a moment, has the direction that the curve has
/// not in the edge's middle but a distance beyond it (supports/clamp.hpp; docs/mechanics.md). The
/// excess is this distance times k . F, with the curvature k and the force F in the rod across it.
/// The distance is another one for the curvature that a rod has as it is drawn
/// (output/leaning_edge.hpp). What actuations turn an edge against the curve in its middle is known
/// (model/actuated_turn.hpp); on an edge on which their curvature jumps that is all.
class LeanExcess {
 public:
  LeanExcess(const RodMesh& rod, const SpreadForces& forces, const Model& model);

  /// Whether no edge leans.
  [[nodiscard]] bool none() const { return leans_.empty(); }
  /// Whether an edge does not.
  [[nodiscard]] bool none(Index edge) const { return find(edge) == nullptr; }
  /// The excess of an edge that leans and is `stretch` times as long as drawn.
  [[nodiscard]] double tension(Index edge, double stretch, const ForceAcross& across,
                               const Model& model, const State& state) const;

 private:
  struct Lean {
    Index edge = 0;
    double beyond = 0.0;          // [m] for the curvature, but for an actuated one
    Vec2 natural = Vec2::Zero();  // [rad] that the natural curvature adds
    ActuatedTurn actuated;        // from the edge's direction to the curve's in its middle
    double from = 0.0, to = 0.0;  // [m] where the force in the rod is that in the edge's middle
  };

  [[nodiscard]] const Lean* find(Index edge) const;
  [[nodiscard]] Vec2 reference_curvature(Index edge, const Model& model) const;
  void add_free_end(bool last, const Model& model);
  [[nodiscard]] bool bears_moment(double s) const;
  void add(const Lean& lean);
  void bound_by(const SpreadForces& forces, Lean& lean) const;

  RodMesh rod_;
  ActuatedShape actuated_;
  std::vector<Lean> leans_;
};

}  // namespace der
