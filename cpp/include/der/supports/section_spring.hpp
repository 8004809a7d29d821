#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

// Springs against turning in space: those of supports/spring.hpp with section frames. Spring and
// cell are in series (energies/held_section.hpp), with the lengths of model/section_place.hpp.

/// Enters a spring [N m/rad] against turning of the section at arc length `s` [m] into the layout,
/// where it joins what is at the same place.
void add_to_section_spring(double s, const Vec3& stiffness, RodLayout& rod);

/// Adds the elements of these springs, after those of the rod.
void add_section_springs(RodLayout& rod, Model& model);

}  // namespace der
