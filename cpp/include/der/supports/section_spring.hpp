#pragma once

#include <variant>

#include "der/core/types.hpp"
#include "der/energies/section_spring.hpp"
#include "der/model/model.hpp"

namespace der {

// Springs against turning in space: those of supports/spring.hpp with section frames. Spring and
// cell are in series (energies/held_section.hpp), with the lengths of model/section_place.hpp.

/// Enters a spring [N m/rad] against turning of the section at arc length `s` [m] into the layout,
/// where it joins what is at the same place.
void add_to_section_spring(double s, const Vec3& stiffness, RodLayout& rod);

/// Adds the elements of these springs, after those of the rod.
void add_section_springs(RodLayout& rod, Model& model);

/// The section at arc length `s` [m] on which a moment acts there (energies/held_moment.hpp): that
/// of the springs, or at a corner without them one that nothing holds. Nothing elsewhere: the
/// section is then known by its edges alone.
using HeldSectionAt =
    std::variant<std::monostate, SectionSpring<1>::Constants, SectionSpring<2>::Constants>;
HeldSectionAt held_section_at(double s, const RodLayout& rod, Model& model);

}  // namespace der
