#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "output/acting_elements.hpp"

namespace der {

/// The torque that the spin of sections takes up in the edges beside clamps that hold the section.
///
/// The chain gives the inertia of a whole edge to its angle, so that the torque in a clamp's cell
/// is the one at the clamp. The cell twists in the middle of its length, and the rod's torque there
/// is another one if the edge's spin changes.
class SpinTorque {
 public:
  SpinTorque(const RodMesh& rod, const Model& model);

  /// By how much the torque grows along an edge [N m], from its start to its end: what the forces
  /// on its angle leave for the inertia. 0 of edges without such a clamp.
  [[nodiscard]] double along(Index edge, const Model& model, const State& state) const;

 private:
  struct Spun {
    Index edge = 0;
    Index theta = 0;  // its angle
    ActingElements elements;
  };
  std::vector<Spun> spun_;
};

}  // namespace der
