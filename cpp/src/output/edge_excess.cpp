#include "output/edge_excess.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "output/line_loads.hpp"

namespace der {

EdgeExcess::EdgeExcess(const RodMesh& rod, const SpreadForces& forces)
    : rod_(rod), edges_(to_size(rod.num_edges())) {
  for (Index edge = 0; edge < rod.num_edges(); ++edge) add_forces(edge, forces);
  for (std::size_t d = 0; d < rod.distributed_places.size(); ++d) add_distributed(d);
  for (const FoundationPlace& place : rod.foundation_places) add_foundation(place);
}

void EdgeExcess::add_forces(Index edge, const SpreadForces& forces) {
  const double middle = rod_.edge_middle(edge);
  for (std::size_t f = 0; f < forces.size(); ++f) {
    const std::vector<Weighted>& nodes = forces[f].nodes;
    if (nodes.front().place > edge || nodes.back().place <= edge) continue;
    double amount = forces[f].place.arc_length > middle + rod_.same_place() ? 1.0 : 0.0;
    for (const auto& [node, weight] : nodes) amount -= node > edge ? weight : 0.0;
    edges_[to_size(edge)].forces.push_back({f, amount});
  }
}

void EdgeExcess::add_distributed(std::size_t number) {
  const DistributedPlace& place = rod_.distributed_places[number];
  for (const EdgePart& part : edge_parts(rod_, place.from, place.to)) {
    if (!is_cut(part, rod_)) continue;
    const double middle = rod_.edge_middle(part.edge);
    const double beyond = std::max(0.0, part.to - std::max(part.from, middle));
    edges_[to_size(part.edge)].distributed.push_back(
        {number, beyond - length_at_last_end(part, rod_)});
  }
}

void EdgeExcess::add_foundation(const FoundationPlace& place) {
  for (const EdgePart& part : edge_parts(rod_, place.from, place.to)) {
    if (!is_cut(part, rod_)) continue;
    const double s0 = rod_.arc_length_at(part.edge);
    const double s1 = rod_.arc_length_at(part.edge + 1);
    edges_[to_size(part.edge)].foundations.push_back(
        {(part.from - s0) / (s1 - s0), (part.to - s0) / (s1 - s0), place.stiffness});
  }
}

bool EdgeExcess::none(Index edge) const {
  const Loads& loads = edges_[to_size(edge)];
  return loads.forces.empty() && loads.distributed.empty() && loads.foundations.empty();
}

Vec3 EdgeExcess::force(Index edge, const SpreadForces& forces, const Model& model,
                       const State& state) const {
  const Loads& loads = edges_[to_size(edge)];
  Vec3 sum = Vec3::Zero();
  for (const auto& [force, amount] : loads.forces) {
    sum += amount * forces.value(force, model, state);
  }
  for (const auto& [number, amount] : loads.distributed) {
    sum += amount * force_per_length(rod_.distributed_places[number], model, state);
  }
  for (const CutFoundation& foundation : loads.foundations) {
    sum += foundation_force(edge, foundation, model, state);
  }
  return sum;
}

Vec3 EdgeExcess::foundation_force(Index edge, const CutFoundation& foundation, const Model& model,
                                  const State& state) const {
  const Vec3 first = node_displacement(rod_, edge, model, state);
  const Vec3 change = node_displacement(rod_, edge + 1, model, state) - first;
  // Integrals from `a` to `b` of the displacement, and of its product with the shape function of
  // the edge's end.
  const auto all = [&](double a, double b) -> Vec3 {
    return (b - a) * first + 0.5 * (b * b - a * a) * change;
  };
  const auto at_end = [&](double a, double b) -> Vec3 {
    return 0.5 * (b * b - a * a) * first + (b * b * b - a * a * a) / 3.0 * change;
  };
  const auto& [start, end, stiffness] = foundation;
  const double middle = std::clamp(0.5, start, end);
  return -rod_.edge_length[to_size(edge)] *
         stiffness.cwiseProduct(all(middle, end) - at_end(start, end));
}

}  // namespace der
