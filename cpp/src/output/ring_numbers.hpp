#pragma once

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Writhe of a ring in space: the mean, over all directions of view, of the signed crossings that
/// its polygon shows, which at a clamp goes from pivot to pivot (supports/clamp.hpp). It is the sum
/// over all pairs of sides of the signed solid angle of the directions from one to the other, over
/// 2 pi (Banchoff, Indiana Univ. Math. J. 25, 1976; Klenin and Langowski, Biopolymers 54, 2000):
/// exact, in a time that grows with the square of the number of edges.
double writhe_of(const RodMesh& rod, const Model& model, const State& state);

/// Link of a ring whose sections count: how many turns these make around it, its whole twist over 2
/// pi plus its writhe (Calugareanu; White; Fuller, PNAS 68, 1971). No motion changes it unless the
/// ring passes through itself. It is a whole number where the drawn directors come back to
/// themselves around the ring; else the angle by which they were turned to be glued is left out.
double link_of(const RodMesh& rod, const Model& model, const State& state);

}  // namespace der
