#include "output/lean_excess.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "model/corner.hpp"
#include "output/leaning_edge.hpp"
#include "output/natural_curvature.hpp"

namespace der {

LeanExcess::LeanExcess(const RodMesh& rod, const SpreadForces& forces, const Model& model)
    : rod_(rod), actuated_(rod) {
  if (!bears_forces_across(rod, model)) return;
  for (const Clamp& clamp : rod.clamps) {
    for (const Index edge : {rod.edge_before(clamp.place), rod.edge_after(clamp.place)}) {
      if (edge < 0) continue;
      const double further = clamp_cell_length(rod, edge) - 0.5 * rod.edge_length[to_size(edge)];
      const double sign = edge == clamp.place ? 1.0 : -1.0;
      const Vec2 natural = reference_curvature(edge, model);
      add({edge, sign * further, sign * (reference_lean(rod, edge) - further) * natural, {}});
    }
  }
  add_free_end(false, model);
  add_free_end(true, model);
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    if (actuation_jumps_in(edge, rod, false)) add({edge, 0.0, Vec2::Zero(), {}});
  }
  for (Lean& lean : leans_) {
    lean.actuated = actuated_turn_from_edge(lean.edge, rod.edge_middle(lean.edge), rod);
    bound_by(forces, lean);
  }
}

double LeanExcess::tension(Index edge, double stretch, const ForceAcross& across,
                           const Model& model, const State& state) const {
  const Lean& lean = *find(edge);
  const ForceAcross::Mean mean = across.mean(lean.from, lean.to, model, state);
  const Vec3 turned = value_of(lean.actuated, model, state);
  const Vec3 actuated = actuated_.strains(rod_.edge_middle(edge), false, model, state);
  const Vec2 turn =
      lean.beyond * (mean.curvature - actuated.head<2>()) + lean.natural - turned.head<2>();
  return turn.dot(mean.force) / stretch;
}

/// Null if the edge does not lean.
const LeanExcess::Lean* LeanExcess::find(Index edge) const {
  const auto found = std::find_if(leans_.begin(), leans_.end(),
                                  [&](const Lean& lean) { return lean.edge == edge; });
  return found == leans_.end() ? nullptr : &*found;
}

/// Curvature [1/m] of an edge of a rod that is free of stress as it is drawn; 0 of a straight
/// one, and where the scene gives it: the cells of a clamp then have it.
Vec2 LeanExcess::reference_curvature(Index edge, const Model& model) const {
  constexpr double kStraight = 1e-12;  // [rad]
  Vec2 drawn = Vec2::Zero();
  if (!rod_.natural_curvature.empty() || !rod_.natural_curvatures.empty()) return drawn;
  if (model.dimension == 2) {
    drawn[0] = NaturalCurvature(rod_, model).at(edge, rod_.edge_middle(edge));
  } else {
    double beside = 0.0;
    for (const RodVertex& vertex : rod_.vertices) {
      if (vertex.clamp < 0 && is_corner(rod_, vertex.place(), model)) continue;
      if (vertex.after != edge && vertex.before != edge) continue;
      drawn += vertex.natural_curvature;
      beside += 1.0;
    }
    if (beside > 0.0) drawn /= beside;
  }
  const bool straight = drawn.norm() * rod_.edge_length[to_size(edge)] < kStraight;
  return straight ? Vec2(Vec2::Zero()) : drawn;
}

void LeanExcess::add_free_end(bool last, const Model& model) {
  if (rod_.closed || rod_.clamp_at(last ? rod_.num_edges() : 0) != nullptr) return;
  Vec2 natural = Vec2::Zero();
  if (!rod_.natural_curvature.empty()) {
    natural[0] = last ? rod_.natural_curvature.back() : rod_.natural_curvature.front();
  } else if (!rod_.natural_curvatures.empty()) {
    natural = last ? rod_.natural_curvatures.back() : rod_.natural_curvatures.front();
  }
  const bool is_bent = bears_moment(last ? rod_.rest_length() : 0.0);
  if (natural.isZero(0.0) && !is_bent) return;
  const Index edge = last ? rod_.num_edges() - 1 : 0;
  const double twelfth = (last ? 1.0 : -1.0) * rod_.edge_length[to_size(edge)] / 12.0;
  if (is_bent) {
    // A moment bends the end as a natural curvature does, and the curvature there has both; but
    // that of the drawn shape is no lean, since the nodes of a drawn curve lie on it.
    add({edge, twelfth, -twelfth * reference_curvature(edge, model), {}});
  } else {
    add({edge, 0.0, twelfth * natural, {}});
  }
}
/// Whether a moment or a spring against turning acts at a place.
bool LeanExcess::bears_moment(double s) const {
  const std::vector<double> places = rod_.moment_arc_lengths();
  return std::any_of(places.begin(), places.end(),
                     [&](double place) { return std::abs(place - s) <= rod_.same_place(); });
}

/// An edge between two clamps leans against both.
void LeanExcess::add(const Lean& lean) {
  const auto known = std::find_if(leans_.begin(), leans_.end(),
                                  [&](const Lean& other) { return other.edge == lean.edge; });
  if (known == leans_.end()) {
    leans_.push_back(lean);
  } else {
    known->beyond += lean.beyond;
    known->natural += lean.natural;
  }
}

/// By the point forces within the edge, but for those so close to its middle that between them the
/// error of the moment is as large as its change.
void LeanExcess::bound_by(const SpreadForces& forces, Lean& lean) const {
  constexpr double kTooClose = 0.1;
  lean.from = rod_.arc_length_at(lean.edge);
  lean.to = rod_.arc_length_at(lean.edge + 1);
  const double middle = rod_.edge_middle(lean.edge);
  const double least = kTooClose * rod_.edge_length[to_size(lean.edge)];
  for (std::size_t f = 0; f < forces.size(); ++f) {
    const double s = forces[f].place.arc_length;
    if (s <= middle + rod_.same_place()) {
      lean.from = std::max(lean.from, std::min(s, lean.to - least));
    } else {
      lean.to = std::min(lean.to, std::max(s, lean.from + least));
    }
  }
}

}  // namespace der
