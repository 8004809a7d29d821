#pragma once

#include <memory>

#include "output/rod_field.hpp"

namespace der {

// Strain and tension of a rod: at the middles of the edges, at the ends of the rod, and on both
// sides of the places where a force acts; linear in between, of order 2 everywhere.
// docs/mechanics.md, "Tension and strain".

std::unique_ptr<RodField> make_strain_field(const RodMesh& rod, const Model& model);
/// In [N].
std::unique_ptr<RodField> make_tension_field(const RodMesh& rod, const Model& model);

}  // namespace der
