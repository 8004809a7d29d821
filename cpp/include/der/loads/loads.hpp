#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/load.hpp"

namespace der {

namespace scenario {
struct Scene;
}

// Adds a load to a model whose rods and masses are already there. One overload and one file for
// each kind of `scenario::AnyLoad`; `scene` gives what a load needs of the others (buoyancy needs
// gravity). A constant force goes to `Model::dead_force`, one that follows a table to
// `Model::controlled_forces` (class DeadForce does both), one proportional to velocity to
// `Model::damping`. A force with a potential in the positions is an energy: elements of a kernel in
// `Model::elements`. docs/extending.md has every step to a new kind.
void add_load(const scenario::Gravity& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::Fluid& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::Damping& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::PointForce& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::Moment& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::DistributedForce& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::Foundation& load, const scenario::Scene& scene, Model& model);

/// Sum of all gravity entries [m/s^2]; zero without one.
Vector total_gravity(const scenario::Scene& scene);

}  // namespace der
