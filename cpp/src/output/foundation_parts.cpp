#include "output/foundation_parts.hpp"

#include <algorithm>
#include <unordered_map>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/foundation.hpp"

namespace der {

Vec2 FoundationPart::excess_beyond_middle(double edge_length, const State& state) const {
  const Eigen::Vector4d displacement = gather(dofs, state.positions) - drawn;
  const Vec2 first = displacement.head<2>();
  const Vec2 change = displacement.tail<2>() - first;
  // Integrals from `a` to `b` of the displacement, and of its product with the shape function of
  // the edge's end.
  const auto all = [&](double a, double b) -> Vec2 {
    return (b - a) * first + 0.5 * (b * b - a * a) * change;
  };
  const auto at_end = [&](double a, double b) -> Vec2 {
    return 0.5 * (b * b - a * a) * first + (b * b * b - a * a * a) / 3.0 * change;
  };
  const double middle = std::clamp(0.5, start, end);
  return -edge_length * stiffness.cwiseProduct(all(middle, end) - at_end(start, end));
}

std::vector<FoundationPart> foundation_parts(const RodLayout& rod, const Model& model) {
  const auto& elements = elements_of<Foundation>(*model.elements);
  std::vector<FoundationPart> found;
  if (elements.size() == 0) return found;
  std::unordered_map<Index, Index> edge_from;  // the edge that begins at a degree of freedom
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    edge_from[rod.edge_dofs(edge, model)[0]] = edge;
  }
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto edge = edge_from.find(elements.dofs[e][0]);
    if (edge == edge_from.end() || rod.edge_dofs(edge->second, model) != elements.dofs[e]) continue;
    const Foundation::Constants& c = elements.constants[e];
    found.push_back({edge->second, c.start, c.end, c.stiffness, elements.dofs[e], c.drawn});
  }
  return found;
}

std::vector<double> foundation_jumps(const RodLayout& rod,
                                     const std::vector<FoundationPart>& parts) {
  std::vector<double> jumps;
  std::vector<Vec2> change(rod.nodes.size(), Vec2::Zero());  // of the stiffness at each node
  for (const FoundationPart& part : parts) {
    const double s0 = rod.arc_length[to_size(part.edge)];
    const double length = rod.edge_length[to_size(part.edge)];
    if (part.start > 0.0) {
      jumps.push_back(s0 + part.start * length);
    } else {
      change[to_size(part.edge)] += part.stiffness;
    }
    if (part.end < 1.0) {
      jumps.push_back(s0 + part.end * length);
    } else {
      change[to_size(part.edge + 1)] -= part.stiffness;
    }
  }
  for (std::size_t node = 0; node < change.size(); ++node) {
    if (!change[node].isZero()) jumps.push_back(rod.arc_length[node]);
  }
  return jumps;
}

}  // namespace der
