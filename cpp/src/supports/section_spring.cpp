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
#include "model/corner.hpp"

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

/// What the rod makes of the springs at a place between the middles of two edges, or on one.
struct SectionHold {
  Mat3 stiffness = Mat3::Zero();
  std::array<Mat3, 2> weights;
  Index section_edge = -1;  // whose section the springs hold, number in the model; -1: each its own
  bool counts_turns = true;  // whole ones, of the twist
};

/// In series with the cell in which the rod turns on to the place.
double in_series(double stiffness, double cell_length, double stiffness_of_rod) {
  return stiffness / (1.0 + stiffness * cell_length / stiffness_of_rod);
}

/// On one edge, or between two with nearly the same section.
SectionHold smooth_hold(const Vec3& stiffness, const SectionPlace& place, const RodLayout& rod) {
  SectionHold hold;
  hold.stiffness.diagonal() = Vec3(in_series(stiffness[0], place.bend_cell, rod.EI_1),
                                   in_series(stiffness[1], place.bend_cell, rod.EI_2),
                                   in_series(stiffness[2], place.twist_cell, rod.GJ));
  for (std::size_t i = 0; i < place.across.size(); ++i) {
    hold.weights[i] = Vec3(place.across[i], place.across[i], place.along[i]).asDiagonal();
  }
  return hold;
}

Mat3 axes_of(const SectionFrame& section) {
  Mat3 axes;
  axes << section.first, section.second, section.tangent;
  return axes;
}

/// Unit rotations, in fixed axes, that bend a section towards its two directors and twist it.
Mat3 rotations_of(const SectionFrame& section) {
  Mat3 axes;
  axes << section.second, -section.first, section.tangent;
  return axes;
}

/// Between two edges with different sections, at a corner. Rod before the place and beyond it turns
/// with the compliances A and B about all axes. The moment of the springs on the rod, m, makes the
/// one in it jump, and the section turns by B (A + B)^-1 r_a + A (A + B)^-1 r_b + D m, with the
/// rotations of the two edges and D = A (A + B)^-1 B.
SectionHold corner_hold(const Vec3& stiffness, double s, Index first_edge, const RodLayout& rod,
                        const Model& model) {
  const Index second_edge = first_edge + 1;
  const double corner = rod.arc_length_at(second_edge);
  const double start = rod.edge_middle(first_edge);
  const double end = rod.edge_middle(second_edge);
  const auto number = [&](Index edge) { return rod.first_edge + rod.position(edge); };
  SectionHold hold;
  hold.section_edge = number(s < corner - rod.same_place() ? first_edge : second_edge);
  // The angle of an edge tells the turns about its own tangent alone.
  hold.counts_turns = !is_corner(rod, second_edge, model);

  const Mat3 section = rotations_of(drawn_frame(model, hold.section_edge));
  const Vec3 softness = Vec3(rod.EI_1, rod.EI_2, rod.GJ).cwiseInverse();
  const auto compliance = [&](Index edge, double from, double to) -> Mat3 {
    const Mat3 own = section.transpose() * rotations_of(drawn_frame(model, number(edge)));
    return std::max(0.0, to - from) * own * softness.asDiagonal() * own.transpose();
  };
  const Mat3 before =
      compliance(first_edge, start, std::min(s, corner)) + compliance(second_edge, corner, s);
  const Mat3 beyond =
      compliance(first_edge, s, corner) + compliance(second_edge, std::max(s, corner), end);
  const Mat3 stiffness_between = (before + beyond).inverse();
  hold.weights = {beyond * stiffness_between, before * stiffness_between};
  const Mat3 cell = before * stiffness_between * beyond;
  const Mat3 springs = stiffness.asDiagonal();
  hold.stiffness = (Mat3::Identity() + springs * cell).inverse() * springs;
  return hold;
}

/// Whether two edges side by side have sections that lie differently: at a corner, and where a ring
/// is glued turned.
bool sections_differ(Index first_edge, const RodLayout& rod, const Model& model) {
  if (is_corner(rod, first_edge + 1, model)) return true;
  const bool closes = rod.closed && rod.position(first_edge + 1) == 0 && !rod.joints.empty();
  return closes && rod.joints.back().glued != 0.0;
}

SectionHold hold_at(const SectionSpringPlace& spring, const SectionPlace& place,
                    const RodLayout& rod, const Model& model) {
  const bool resists = rod.EI_1 > 0.0 && rod.EI_2 > 0.0 && rod.GJ > 0.0;
  if (resists && place.across.size() == 2 && sections_differ(place.first_edge, rod, model)) {
    return corner_hold(spring.stiffness, spring.arc_length, place.first_edge, rod, model);
  }
  return smooth_hold(spring.stiffness, place, rod);
}

/// Returns the number of the element in its list.
template <int Edges>
Index add_element(const SectionHold& hold, Index first_edge, const RodLayout& rod, Model& model) {
  using Kernel = SectionSpring<Edges>;
  std::array<Index, Kernel::kDofs> dofs{};
  typename Kernel::Constants constants;
  constants.stiffness = hold.stiffness;
  for (Index i = 0; i < Edges; ++i) {
    const Index number = rod.first_edge + rod.position(first_edge + i);
    const SpatialEdge& edge = model.framed_edges[to_size(number)];
    for (Index c = 0; c < 3; ++c) {
      dofs[to_size(3 * i + c)] = edge.start + c;
      dofs[to_size(3 * i + 3 + c)] = edge.end + c;
    }
    dofs[to_size(3 * Kernel::kNodes + i)] = edge.theta;
    typename Kernel::HeldEdge& held = constants.edges[to_size(i)];
    held.block = FrameBlock::of(number);
    held.first = edge.first;
    held.last = edge.last;
    held.drawn = drawn_frame(model, number);
    held.weights = hold.weights[to_size(i)];
    if (hold.counts_turns) held.reference_twist = follow_twist(number, held.drawn, model);
    if (hold.section_edge >= 0) {
      const SectionFrame section = drawn_frame(model, hold.section_edge);
      held.carried = axes_of(held.drawn).transpose() * axes_of(section);
      held.drawn = section;
    }
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
    const SectionHold hold = hold_at(spring, place, rod, model);
    spring.element = place.across.size() == 1 ? add_element<1>(hold, place.first_edge, rod, model)
                                              : add_element<2>(hold, place.first_edge, rod, model);
  }
}

}  // namespace der
