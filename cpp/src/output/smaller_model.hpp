#pragma once

#include <memory>

#include "output/rod_field.hpp"
#include "output/section_field.hpp"

namespace der {

// Quantities of a scene of three components in a model that stands for a larger one
// (Model::stands_for_space): those of a rod that stays in the plane, or does not twist.

/// A field times a constant.
std::unique_ptr<RodField> scaled(double factor, std::unique_ptr<RodField> field);

/// The absolute value of a signed field in the plane: the length of a vector along z.
std::unique_ptr<RodField> magnitude(std::unique_ptr<RodField> field, const RodMesh& rod);

/// A quantity of the sections of a rod in a model without sections. Curvatures and moments of a
/// rod in space are those towards directors that go along the rod, without twist, from the clamp
/// that holds its section; throws Error where none does.
std::unique_ptr<RodField> make_section_field_in_smaller(SectionQuantity quantity,
                                                        const RodMesh& rod, const Model& model);

}  // namespace der
