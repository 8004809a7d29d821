#pragma once

#include <vector>

#include "der/core/types.hpp"

namespace der {

/// How far actuations turn the section of a rod at a place beyond a weighted sum of the edges and
/// clamps beside it (model/actuated_turn.hpp). It is linear in the values of the actuations.
struct ActuatedTurn {
  struct Term {
    Index strain = 0;     ///< towards the first director, the second, or about the tangent
    Index control = 0;    ///< value of the actuation
    double weight = 0.0;  ///< [m]
  };
  std::vector<Term> terms;

  [[nodiscard]] bool is_zero() const { return terms.empty(); }
  /// Turns [rad] towards the two directors and about the tangent; in a plane the first is that
  /// about z. `value_of` gives the value of a control.
  template <class ValueOf>
  [[nodiscard]] Vec3 value(const ValueOf& value_of) const {
    Vec3 sum = Vec3::Zero();
    for (const auto& [strain, control, weight] : terms) sum[strain] += weight * value_of(control);
    return sum;
  }
  [[nodiscard]] Vec3 at(const Vector& controls) const {
    return value([&](Index control) { return controls[control]; });
  }
};

}  // namespace der
