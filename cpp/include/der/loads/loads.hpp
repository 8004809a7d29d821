#pragma once

#include <array>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

/// Adds a load to a model whose rods and masses are already there. One overload and one file for
/// each kind; `scene` gives what a load needs of the others (buoyancy needs gravity, drag the
/// spheres). A new load is one struct in scenario.hpp's variant and one file with its overload.
void add_load(const scenario::Gravity& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::Fluid& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::Damping& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::PointForce& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::Moment& load, const scenario::Scene& scene, Model& model);
void add_load(const scenario::DistributedForce& load, const scenario::Scene& scene, Model& model);

/// Sum of all gravity entries [m/s^2]; zero without one.
Vector total_gravity(const scenario::Scene& scene);

/// A force that keeps its direction and may follow a table over time. Its tables are entered into
/// the model once, however many nodes share it.
class DeadForce {
 public:
  DeadForce(const scenario::VectorSeries& force, Model& model);
  /// Adds `weight` times the force to a node.
  void act_on(Index node, double weight, Model& model) const;
  /// The controls that hold its components in the plane [N], for what reads it off the model: of a
  /// constant force the tables of one value that a path of loads scales with it.
  [[nodiscard]] std::array<Index, 2> as_controls(Model& model) const;

 private:
  scenario::Components constant_;  // empty: it follows tables
  std::vector<Index> controls_;    // one a component
};

/// Sets `force` [N] to everything that does not depend on the motion: weight and dead loads at a
/// load factor, tables at the time of `controls`, and `extra` set from outside.
void external_force(const Model& model, double load_factor, const Vector& controls,
                    const Vector& extra, Vector& force);

}  // namespace der
