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
void add_to_section_spring(double s, const Vec3& stiffness, RodMesh& rod);

/// Adds the elements of these springs, after those of the rod.
void add_section_springs(RodMesh& rod, Model& model);

/// The section at arc length `s` [m] (energies/loaded_section.hpp): that of the springs there, or
/// one that no springs hold.
using HeldSectionAt = std::variant<SectionSpring<1>::Constants, SectionSpring<2>::Constants>;
HeldSectionAt held_section_at(double s, const RodMesh& rod, const Model& model);

/// How far actuations turn the section at arc length `s` [m] beyond those that the edges and a
/// clamp beside it carry there; at a corner each part about the axes of its own leg.
ActuatedTurn actuated_turn_at(double s, const RodMesh& rod, const Model& model);

/// Whether springs or a corner keep the edges from telling how the section at `s` [m] lies under
/// any moment there.
bool is_held_or_at_corner(double s, const RodMesh& rod, const Model& model);

}  // namespace der
