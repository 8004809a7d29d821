#pragma once

#include <memory>

#include "output/rod_field.hpp"

namespace der {

/// A component of a vector of the state at every node, such as of `State::positions`.
std::unique_ptr<RodField> make_component_field(Vector State::* vector, int component,
                                               const RodMesh& rod, const Model& model);

/// The magnitude of the velocity [m/s] at every node. Between nodes it is that of the interpolated
/// velocity: the speed itself has a kink where the velocity changes its sign.
std::unique_ptr<RodField> make_speed_field(const RodMesh& rod, const Model& model);

}  // namespace der
