#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

/// Number of entries of the controls that the actuations of a scene need for the rest shape, in a
/// model of `dimension` 2 or 3.
Index num_rest_entries(const scenario::Scene& scene, int dimension);

/// Tells the rods of the model where these entries are.
void set_rest_entries(const scenario::Scene& scene, Model& model);

/// Adds an actuation to a model whose rods have their supports. Elongations and twists of an edge
/// or a cell are integrals of the profile over it. Curvatures turn each edge to the mean direction
/// that the curve has along it, so that without stress the nodes of a flat curve lie on it,
/// wherever the stretch ends (docs/actuation.md).
void add_actuation(const scenario::Actuation& actuation, Model& model);

/// Tells the places of the loads' moments, and of springs against turning, how far actuations turn
/// the rod there, once all are in the model.
void set_actuated_turns(Model& model);

}  // namespace der
