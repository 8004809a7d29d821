#pragma once

#include "der/core/types.hpp"

namespace der {

struct Model;
struct State;

/// Momenta of all rods. Those of planar rods have only x and y, and z.
struct Momenta {
  Vec3 linear = Vec3::Zero();   ///< [kg m/s]
  Vec3 angular = Vec3::Zero();  ///< [kg m^2/s] about the origin, spin of sections included
};

Momenta momenta(const Model& model, const State& state);

}  // namespace der
