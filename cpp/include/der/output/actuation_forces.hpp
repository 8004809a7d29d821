#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// The moment, torque or force that an actuation exerts on the rod: conjugate to what it changes.
///
/// Its value v over time makes the stretch turn, twist or grow by `length` times v where no stress
/// hinders it, and the work [J] of the actuation is the integral of `values` over that: of a moment
/// over a turning angle, or of a force over a length. So they are the means of the rod's moment,
/// torque or tension over the stretch, weighted by the profile, with the opposite sign.
struct ActuationForce {
  std::string name;
  std::string rod;
  double length = 0.0;             ///< of the stretch, weighted by the profile [m]
  std::size_t num_values = 1;      ///< 2 of curvatures in space, towards the two directors
  std::array<double, 2> values{};  ///< [N m], of an elongation [N]
};

/// Reads them off a state.
class ActuationForces {
 public:
  /// Reads all actuations, or the one that is called `only`.
  explicit ActuationForces(const Model& model,
                           const std::optional<std::string>& only = std::nullopt);
  ~ActuationForces();
  ActuationForces(const ActuationForces&) = delete;
  ActuationForces& operator=(const ActuationForces&) = delete;

  /// At a state, in the order of the rods and of their stretches; valid until the next call.
  const std::vector<ActuationForce>& evaluate(const Model& model, const State& state);

 private:
  class Reader;
  std::unique_ptr<Reader> reader_;
};

}  // namespace der
