#include "output/natural_curvature.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "model/curvature_jump.hpp"
#include "model/legs.hpp"
#include "model/reference_edge.hpp"

namespace der {

NaturalCurvature::NaturalCurvature(const RodMesh& rod, const Model& model) {
  const std::vector<Index> bounds = leg_bounds(rod, model);
  for (const Index bound : bounds) legs_.push_back({bound, {}, {}});
  legs_.push_back({rod.num_edges(), {}, {}});
  if (rod.natural_curvature.empty()) {
    read_reference(bounds, rod, model);
  } else {
    read_given(bounds, rod);
  }
}

void NaturalCurvature::read_given(const std::vector<Index>& bounds, const RodMesh& rod) {
  auto leg = legs_.begin();
  for (Index i = 0; i <= rod.num_edges(); ++i) {
    const auto add = [&](bool after) {
      leg->arc_length.push_back(rod.arc_length_at(i));
      leg->values.push_back(planar_curvature_beside(rod, i, after));
    };
    if (!std::binary_search(bounds.begin(), bounds.end(), rod.position(i))) {
      add(true);
      continue;
    }
    if (i > 0) add(false);
    if (i == rod.num_edges()) continue;
    ++leg;
    add(true);
  }
}

void NaturalCurvature::read_reference(const std::vector<Index>& bounds, const RodMesh& rod,
                                      const Model& model) {
  auto leg = legs_.begin();
  for (Index i = 0; i <= rod.num_edges(); ++i) {
    if (std::binary_search(bounds.begin(), bounds.end(), rod.position(i))) {
      if (i < rod.num_edges()) ++leg;
      continue;
    }
    if (!rod.is_inner(i)) continue;
    const double before = rod.edge_length[to_size(rod.edge_before(i))];
    const double after = rod.edge_length[to_size(rod.edge_after(i))];
    leg->arc_length.push_back(rod.arc_length_at(i) + (after - before) / 3.0);
    leg->values.push_back(
        angle_between(reference_edge(rod, i - 1, model), reference_edge(rod, i, model)) /
        (0.5 * (before + after)));
  }
  // A leg of one edge has no node of its own. Where the curvature jumps, its value is known beside.
  for (std::size_t k = 0; k < legs_.size(); ++k) {
    for (const bool at_end : {false, true}) {
      if (!legs_[k].values.empty() || (at_end ? k >= bounds.size() : k == 0)) continue;
      const Index bound = bounds[at_end ? k : k - 1];
      const double beyond = curvature_beyond_mean(rod, bound, !at_end, rod.reference_jumps).z();
      if (beyond == 0.0) continue;
      legs_[k].arc_length.push_back(rod.arc_length_at(bound));
      legs_[k].values.push_back(
          angle_between(reference_edge(rod, bound - 1, model), reference_edge(rod, bound, model)) /
              rod.voronoi_length(bound) +
          beyond);
    }
  }
}

double NaturalCurvature::at(Index edge, double s) const {
  const auto leg = std::find_if(legs_.begin(), legs_.end(),
                                [edge](const Leg& other) { return edge < other.end; });
  const auto& [end, places, values] = *leg;
  if (values.empty()) return 0.0;
  if (values.size() == 1) return values.front();
  const auto above =
      static_cast<std::size_t>(std::upper_bound(places.begin(), places.end(), s) - places.begin());
  const std::size_t right = std::clamp<std::size_t>(above, 1, places.size() - 1);
  const double share = (s - places[right - 1]) / (places[right] - places[right - 1]);
  return (1.0 - share) * values[right - 1] + share * values[right];
}

}  // namespace der
