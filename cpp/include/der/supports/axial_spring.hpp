#pragma once

#include <array>

#include "der/model/model.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

/// The nodes of the two joints that a spring is between.
std::array<Index, 2> nodes_of(const scenario::AxialSpring& spring, const scenario::Scene& scene,
                              const Model& model);
/// Adds the element of a spring between two joints, whose rest length a program sets by its name.
void add_axial_spring(const scenario::AxialSpring& spring, const scenario::Scene& scene,
                      Model& model);

}  // namespace der
