#pragma once

#include <optional>
#include <utility>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/statics/equilibrium_failure.hpp"

namespace der::statics {

/// Rejects shapes that solve the equations but that no rod can have, or that nothing holds.
class Admissibility {
 public:
  /// `force` [N] is the whole external force. Drift is measured from `origin` [m].
  Admissibility(const Model& model, const Vector& force, Vector origin);

  void measure_drift_from(Vector origin) { origin_ = std::move(origin); }

  /// The reason why the shape is not admissible: it has drifted away, or collapsed. None if it is.
  [[nodiscard]] std::optional<FailedSearch> check(const Configuration& here) const;

 private:
  const Model& model_;
  Vector origin_;
  double largest_drift_;  // [m]
};

/// Whether an edge is folded back on the one before it, so that the curvature has no sign.
bool is_folded(const Model& model, const Vector& positions);

}  // namespace der::statics
