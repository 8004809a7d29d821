#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// The force and the moment that a support exerts on the rod at one of its places. In a plane the
/// force has no z component, and the moment is along z.
struct Reaction {
  std::size_t support = 0;     ///< its number in the scene
  std::string rod;             ///< name of the rod
  double arc_length = 0.0;     ///< rest arc length of the place [m]
  Vec3 point = Vec3::Zero();   ///< where the force acts [m]
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 moment = Vec3::Zero();  ///< of clamps and springs against turning [N m]
};

/// Reads the reactions of supports off a state, at each place of each support: a support `at: all`
/// has as many places as its rod has nodes.
///
/// On a held degree of freedom the force is what the discrete equation of motion leaves there, M a
/// + C v + dE/dx - f. The moment of a clamp is conjugate to a rotation of what it holds. So forces
/// and moments of loads, supports and inertia balance about any point, to the residual that the
/// solver leaves (docs/mechanics.md, "Reactions").
class Reactions {
 public:
  /// Reads all supports, or number `only`.
  Reactions(const scenario::Scene& scene, const Model& model,
            std::optional<std::size_t> only = std::nullopt);
  ~Reactions();
  Reactions(const Reactions&) = delete;
  Reactions& operator=(const Reactions&) = delete;

  /// At a state, in the order of the supports and of their places; valid until the next call.
  const std::vector<Reaction>& evaluate(const Model& model, const State& state);

 private:
  class Reader;
  std::unique_ptr<Reader> reader_;
};

}  // namespace der
