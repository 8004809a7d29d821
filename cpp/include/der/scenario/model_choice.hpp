#pragma once

#include <string>

#include "der/scenario/scenario.hpp"

namespace der::scenario {

/// The mechanical model of a scene, and why it is that one.
struct ChosenModel {
  ModelChoice kind = ModelChoice::Planar;  ///< never Auto
  std::string reason;                      ///< a short sentence for the summary
};

/// The model that the scene asks for or, with `model: auto`, the smallest that can represent it:
///
/// - `planar` where every position, velocity, force, moment and prescribed motion lies in the x-y
///   plane, clamps rotate about z only, and every rod bends in its plane without twisting: one of
///   its directors is normal to the plane or the two bending stiffnesses are equal, its natural
///   curvature is about z, and it has no initial or natural twist and no prescribed twist. Not for
///   the vibration modes of a scene of three components, which leave the plane.
/// - `spatial_bend` where no rod twists: equal bending stiffnesses, straight without stress, no
///   initial or natural twist, no moment and no follower load, and at most one support on each rod
///   that holds its section (`clamp: true`), none that twists it or spins it over time. The energy
///   of bending then does not depend on how the sections lie, so the twist energy is the only one
///   that does, and with at most one section held some angles make it vanish in any shape of the
///   rod: the equilibrium for the angles is without twist and without torque. The spin inertia of
///   sections is left out, as their rotary inertia in bending is (both are (thickness/length)^2 of
///   the inertia of displacements); a scene that gives a `rotary_inertia` wants it.
/// - `spatial` otherwise.
///
/// Nothing is rounded to the plane: a node 1e-6 m off it makes the scene spatial. A model asked for
/// is returned even where it cannot represent the scene; the reader refuses such scenes.
ChosenModel choose_model(const Scene& scene);

/// Its name in scenes, `spatial_bend`. Not for Auto.
const char* name_of(ModelChoice kind);

/// Why the model of this kind cannot represent the scene, as a clause; empty if it can.
std::string why_not(ModelChoice kind, const Scene& scene);

}  // namespace der::scenario
