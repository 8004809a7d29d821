#pragma once

#include <memory>

#include "output/rod_field.hpp"

namespace der {

/// The strain of a rod, times a stiffness [N] (1: the strain itself): at the middles of the edges,
/// at the ends of the rod, and on both sides of the places where a force acts; linear in between,
/// of order 2 everywhere. docs/mechanics.md, "Tension and strain".
std::unique_ptr<RodField> make_stretch_field(double stiffness, const RodLayout& rod,
                                             const Model& model);

}  // namespace der
