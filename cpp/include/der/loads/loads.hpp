#pragma once

#include <array>
#include <string>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/load.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// The facts of the scene and of a load that it needs besides its own keys.
struct LoadContext {
  const scenario::Scene& scene;
  const std::string& name;  ///< of the load; empty: it has none
};

// Adds a load to a model whose rods and masses are already there. One overload and one file for
// each kind of `scenario::AnyLoad`. A constant force goes to `Model::dead_force`; one that follows
// a table or has a name to `Model::controlled_forces` (class DeadForce does both), and its name to
// `Model::named`; one proportional to velocity to
// `Model::damping`. A force with a potential in the positions is an energy: elements of a kernel in
// `Model::elements`. docs/extending.md has every step to a new kind.
void add_load(const scenario::Gravity& load, const LoadContext& context, Model& model);
void add_load(const scenario::Fluid& load, const LoadContext& context, Model& model);
void add_load(const scenario::Damping& load, const LoadContext& context, Model& model);
void add_load(const scenario::PointForce& load, const LoadContext& context, Model& model);
void add_load(const scenario::Moment& load, const LoadContext& context, Model& model);
void add_load(const scenario::DistributedForce& load, const LoadContext& context, Model& model);
void add_load(const scenario::Foundation& load, const LoadContext& context, Model& model);

/// The scene's gravity, which weight and buoyancy follow.
struct PresentGravity {
  Vector constant;                            ///< [m/s^2]; zero where it follows controls
  std::array<Index, 3> controls{-1, -1, -1};  ///< Model::gravity_controls
};
/// Enters the tables of a gravity that follows any into the model, where nobody has before.
PresentGravity present_gravity(const scenario::Scene& scene, Model& model);

}  // namespace der
