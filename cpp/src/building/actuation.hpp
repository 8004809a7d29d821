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

/// Adds an actuation to a model whose rods have their supports. The change of the rest shape of an
/// edge or of a cell is the integral of the profile over it: cells reach from where the rod has the
/// direction of one edge to where it has that of the next (`tangent_place`), so that ends of the
/// stretch between nodes lose no order.
void add_actuation(const scenario::Actuation& actuation, Model& model);

}  // namespace der
