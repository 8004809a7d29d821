#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/followed.hpp"
#include "der/model/model.hpp"
#include "statics/equilibrium/shape.hpp"

namespace der::statics {

/// The loads and support motions under which an equilibrium is sought.
struct StaticLoads {
  Vector controls;  ///< values of the model's tables
  Vector force;     ///< external forces [N], all degrees of freedom

  /// A shape as its elements see it.
  [[nodiscard]] Configuration at(const Model& model, const Shape& shape) const {
    Configuration here{shape.positions, controls};
    enter_followed(model, shape.followed, here.controls);
    return here;
  }
  /// Moves what a shape follows to its positions, which have changed a little.
  void follow(const Model& model, Shape& shape) const {
    der::follow(model, shape.positions, controls, shape.followed);
  }
};

/// Forces and moments times `share`; supports stay where they are.
StaticLoads scaled(const Model& model, const StaticLoads& loads, double share);

/// Whether no force or moment acts. Supports may move all the same.
bool is_unloaded(const Model& model, const StaticLoads& loads);

/// Change of the potential energy [J] between two shapes. The turns are those of `seen_from`.
double energy_change(const Model& model, const StaticLoads& loads, const Shape& seen_from,
                     const Vector& from, const Vector& to);

}  // namespace der::statics
