#include "der/supports/section_spring.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "der/core/index.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/section_spring.hpp"
#include "der/model/frames.hpp"
#include "der/model/section_place.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

/// Makes the state follow the twist of an edge against its drawn section, and returns the entry; -1
/// if a clamp at the edge's end has it.
Index follow_twist(Index number, const SectionFrame& drawn, Model& model) {
  HeldFrame held;
  held.drawn = drawn;
  const FramedJoint followed{number, -1, held};
  const auto known =
      std::find_if(model.framed_joints.begin(), model.framed_joints.end(),
                   [&](const FramedJoint& joint) { return joint.twist() == followed.twist(); });
  if (known == model.framed_joints.end()) {
    model.framed_joints.push_back(followed);
    model.drawn_frames[followed.twist()] =
        model.initial_positions[model.framed_edges[to_size(number)].theta];
    return followed.twist();
  }
  const bool same = known->held.drawn.tangent == drawn.tangent &&
                    known->held.drawn.first == drawn.first && known->held.rotation < 0;
  return same ? followed.twist() : -1;
}

/// In series with the cell in which the rod turns on to the place.
double in_series(double stiffness, double cell_length, double stiffness_of_rod) {
  return stiffness / (1.0 + stiffness * cell_length / stiffness_of_rod);
}

/// Returns the number of the element in its list.
template <int Edges>
Index add_element(const SectionSpringPlace& spring, const SectionPlace& place, const RodLayout& rod,
                  Model& model) {
  using Kernel = SectionSpring<Edges>;
  std::array<Index, Kernel::kDofs> dofs{};
  typename Kernel::Constants constants;
  constants.stiffness = {in_series(spring.stiffness[0], place.bend_cell, rod.EI_1),
                         in_series(spring.stiffness[1], place.bend_cell, rod.EI_2),
                         in_series(spring.stiffness[2], place.twist_cell, rod.GJ)};
  for (Index i = 0; i < Edges; ++i) {
    const Index number = rod.first_edge + rod.position(place.first_edge + i);
    const SpatialEdge& edge = model.framed_edges[to_size(number)];
    for (Index c = 0; c < 3; ++c) {
      dofs[to_size(3 * i + c)] = edge.start + c;
      dofs[to_size(3 * i + 3 + c)] = edge.end + c;
    }
    dofs[to_size(3 * Kernel::kNodes + i)] = edge.theta;
    const double across = place.across[to_size(i)];
    typename Kernel::HeldEdge& held = constants.edges[to_size(i)];
    held.block = FrameBlock::of(number);
    held.first = edge.first;
    held.last = edge.last;
    held.drawn = drawn_frame(model, number);
    held.reference_twist = follow_twist(number, held.drawn, model);
    held.weights = {across, across, place.along[to_size(i)]};
  }
  auto& springs = elements_of<Kernel>(*model.elements);
  springs.add(dofs, constants);
  return static_cast<Index>(springs.size()) - 1;
}

}  // namespace

void add_to_section_spring(double s, const Vec3& stiffness, RodLayout& rod) {
  for (SectionSpringPlace& known : rod.section_springs) {
    if (std::abs(known.arc_length - s) > rod.same_place()) continue;
    known.stiffness += stiffness;
    return;
  }
  rod.section_springs.push_back({s, stiffness, -1});
}

void add_section_springs(RodLayout& rod, Model& model) {
  for (SectionSpringPlace& spring : rod.section_springs) {
    SectionPlace place = section_place(spring.arc_length, rod);
    if (is_beside_turning_clamp(rod, spring.arc_length)) {
      // The clamp's turn is not among the coordinates of the spring, which acts on the edge alone.
      place.across = place.along = {1.0};
      place.bend_cell = place.twist_cell = 0.0;
    }
    spring.element = place.across.size() == 1 ? add_element<1>(spring, place, rod, model)
                                              : add_element<2>(spring, place, rod, model);
  }
}

}  // namespace der
