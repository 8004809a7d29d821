#include "der/supports/section_spring.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "der/core/index.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/section_spring.hpp"
#include "der/model/frames.hpp"
#include "der/model/location.hpp"
#include "der/model/section_place.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spring.hpp"
#include "model/actuated_turn.hpp"
#include "model/corner.hpp"
#include "model/curvature_jump.hpp"
#include "model/glue.hpp"
#include "supports/leg_clamp.hpp"

namespace der {
namespace {

/// Makes the state follow the twist of an edge against its drawn section, and returns the entry; -1
/// if a clamp at the edge's end has it.
Index follow_twist(Index number, const SectionFrame& drawn, Model& model) {
  HeldFrame held;
  held.drawn = drawn;
  const FramedVertex followed{number, -1, held};
  const auto known =
      std::find_if(model.framed_vertices.begin(), model.framed_vertices.end(),
                   [&](const FramedVertex& vertex) { return vertex.twist() == followed.twist(); });
  if (known == model.framed_vertices.end()) {
    model.framed_vertices.push_back(followed);
    model.initial_frames[followed.twist()] =
        model.reference_positions[model.framed_edges[to_size(number)].theta];
    return followed.twist();
  }
  const bool same = known->held.drawn.tangent == drawn.tangent &&
                    known->held.drawn.first == drawn.first && known->held.rotation < 0;
  return same ? followed.twist() : -1;
}

/// The rod between springs at a place and the edges beside it.
struct SectionHold {
  Mat3 on_the_way = Mat3::Zero();  // its compliance
  std::array<Mat3, 2> weights;
  SectionFrame section;      // the drawn one that the springs hold
  SectionFrame of_natural;   // the one that lies there where no moment acts and no edge has turned
  bool counts_turns = true;  // whole ones, of the twist
};

/// The section that the clamp beside a place holds, on the leg of the place.
HeldFrame held_beside(const PlaceBesideClamp& place, const RodMesh& rod, const Model& model) {
  const Clamp& clamp = rod.clamps[to_size(place.clamp)];
  return clamp_of_leg(clamp, place.edge != clamp.place, rod, model).held;
}

Index number_of(const RodMesh& rod, Index edge) { return rod.first_edge + rod.position(edge); }

/// A section turned by a rotation vector [rad].
SectionFrame turned_by(const Vec3& rotation, const SectionFrame& section) {
  const double angle = rotation.norm();
  if (angle == 0.0) return section;
  const Eigen::AngleAxisd turn(angle, rotation / angle);
  return SectionFrame::of(turn * section.tangent, turn * section.first);
}

/// The drawn section between one and another, bent and twisted by shares of the whole [-].
SectionFrame between(const SectionFrame& from, const SectionFrame& to, double bent,
                     double twisted) {
  const Vec3 axis = from.tangent.cross(to.tangent);
  const double sine = axis.norm();
  const double angle = bent * std::atan2(sine, from.tangent.dot(to.tangent));
  const Eigen::AngleAxisd bend(angle, sine > 0.0 ? Vec3(axis / sine) : Vec3::UnitZ());
  return SectionFrame::of(bend * from.tangent, bend * from.first)
      .turned(twisted * twist_between(from, to));
}

/// The drawn section at arc length `s` [m] on the line through those of an edge and the next.
SectionFrame section_on_line(double s, Index first_edge, const RodMesh& rod, const Model& model) {
  const double middle = rod.edge_middle(first_edge);
  const double share = (s - middle) / (rod.edge_middle(first_edge + 1) - middle);
  return between(initial_frame(model, number_of(rod, first_edge)),
                 initial_frame(model, number_of(rod, first_edge + 1)), share, share);
}

/// The drawn section at arc length `s` [m], inter- or extrapolated from the edges, or from the one
/// edge and the clamp beside it.
SectionFrame reference_section_at(double s, const SectionPlace& place, const RodMesh& rod,
                                  const Model& model) {
  if (place.across.size() == 2) {
    return turned_by(turn_from_line(s, place.first_edge, rod, rod.reference_jumps),
                     section_on_line(s, place.first_edge, rod, model));
  }
  const SectionFrame first = initial_frame(model, number_of(rod, place.first_edge));
  const auto beside = place_beside_clamp(rod, s);
  if (!beside) {
    return first.turned(rod.initial_twist * (s - rod.edge_middle(place.first_edge)));
  }
  const double half = 0.5 * rod.edge_length[to_size(beside->edge)];
  return between(first, held_beside(*beside, rod, model).drawn, 1.0 - place.across[0],
                 1.0 - beside->distance / half);
}

Mat3 axes_of(const SectionFrame& section) {
  Mat3 axes;
  axes << section.first, section.second, section.tangent;
  return axes;
}

/// The rotation that takes one direction to another the shortest way [rad].
Vec3 turn_between(const Vec3& from, const Vec3& to) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond::FromTwoVectors(from, to));
  return turn.angle() * turn.axis();
}

/// The weighted rotations at which no moment acts: none, where the drawn shape is free of stress.
/// A natural shape that is given is that of a chain whose nodes do not lie on the drawn curve
/// (spring.hpp).
Vec3 natural_rotation(double s, const SectionPlace& place, const SectionFrame& section,
                      const RodMesh& rod, const Model& model) {
  Vec3 rotation = Vec3::Zero();
  if (!rod.natural_curvatures.empty()) {
    const auto [at_start, at_end] = natural_turn_lengths(rod, s, place.first_edge, place.across);
    rotation.head<2>() =
        at_start * rod.natural_curvatures.front() + at_end * rod.natural_curvatures.back();
    if (place.across.size() == 2) {
      const double middle = rod.edge_middle(place.first_edge);
      const double spacing = rod.edge_middle(place.first_edge + 1) - middle;
      const Vec3 first = initial_frame(model, number_of(rod, place.first_edge)).tangent;
      const Vec3 second = initial_frame(model, number_of(rod, place.first_edge + 1)).tangent;
      const Vec3 between = ((s - middle) / spacing - place.across[1]) * turn_between(first, second);
      rotation += turning_axes(section).transpose() * between;
    }
  }
  if (place.across.size() == 2) {
    rotation -=
        turning_axes(section).transpose() * natural_turn_from_line(s, place.first_edge, rod);
  }
  if (const double beyond = beyond_outer_middle(rod, s);
      beyond > 0.0 && !rod.natural_twist.empty()) {
    const bool start = s < rod.edge_middle(0);
    const double twist = start ? rod.natural_twist.front() : -rod.natural_twist.back();
    rotation.z() += beyond * (twist - (start ? 1.0 : -1.0) * rod.initial_twist);
  }
  return rotation;
}

/// A section turned by the opposite of a rotation towards its directors and of a twist.
SectionFrame turned_back(const SectionFrame& section, const Vec3& rotation) {
  return turned_by(-(turning_axes(section) * rotation), section);
}

/// On one edge, or between two with nearly the same section.
SectionHold smooth_hold(const SectionSpringPlace& spring, const SectionPlace& place,
                        const RodMesh& rod, const Model& model) {
  SectionHold hold;
  hold.on_the_way.diagonal() =
      Vec3(place.bend_cell / rod.EI_1, place.bend_cell / rod.EI_2, place.twist_cell / rod.GJ);
  for (std::size_t i = 0; i < place.across.size(); ++i) {
    hold.weights[i] = Vec3(place.across[i], place.across[i], place.along[i]).asDiagonal();
  }
  hold.section = reference_section_at(spring.arc_length, place, rod, model);
  hold.of_natural = turned_back(
      hold.section, natural_rotation(spring.arc_length, place, hold.section, rod, model));
  return hold;
}

/// Whether two edges side by side have sections that lie differently: at a corner, and where a ring
/// is glued turned, by more than rounding.
bool sections_differ(Index first_edge, const RodMesh& rod, const Model& model) {
  if (is_corner(rod, first_edge + 1, model)) return true;
  const bool closes = rod.closed && rod.position(first_edge + 1) == 0 && !rod.vertices.empty();
  return closes && is_glued_turned(rod.vertices.back());
}

/// The drawn section at arc length `s` [m] on the leg that ends with an edge, or begins with one:
/// on the line through those of this edge and its neighbour on the leg, of which the neighbour has
/// the one number or the other. A leg of one edge is straight.
SectionFrame section_on_leg(double s, Index edge, Index neighbour, const RodMesh& rod,
                            const Model& model) {
  const Index first = std::min(edge, neighbour);
  if (!rod.is_inner(first + 1) || sections_differ(first, rod, model)) {
    return initial_frame(model, number_of(rod, edge))
        .turned(rod.initial_twist * (s - rod.edge_middle(edge)));
  }
  return section_on_line(s, first, rod, model);
}

/// At a corner, and where a ring is glued turned: by how much the rod turns further along the edges
/// `first_edge` and the next, from `from` to `to` [m], if it has the natural shape that the scene
/// gives, than from one drawn tangent to the other; towards the directors of the section and about
/// its tangent [rad].
Vec3 natural_turn_between_sections(double from, double to, const std::array<Vec3, 2>& tangents,
                                   Index first_edge, const SectionFrame& section,
                                   const RodMesh& rod, const Model& model) {
  Vec3 natural(0.0, 0.0,
               rod.natural_twist.empty()
                   ? 0.0
                   : rod.natural_twist[to_size(rod.position(first_edge + 1))] - rod.initial_twist);
  Vec3 turn = Vec3::Zero();
  if (!rod.natural_curvatures.empty()) {
    natural.head<2>() = rod.natural_curvatures.front();
    turn = -turn_between(tangents[0], tangents[1]);
  }
  const double node = rod.arc_length_at(first_edge + 1);
  const auto add = [&](Index edge, double length) {
    const SectionFrame own = initial_frame(model, number_of(rod, edge));
    turn += std::max(0.0, length) * (turning_axes(own) * natural);
  };
  add(first_edge, std::min(to, node) - from);
  add(first_edge + 1, to - std::max(from, node));
  return turning_axes(section).transpose() * turn;
}

/// Between two edges with different sections, at a corner. Rod before the place and beyond it turns
/// with the compliances A and B about all axes. The moment of the springs on the rod, m, makes the
/// one in it jump, and the section turns by B (A + B)^-1 r_a + A (A + B)^-1 r_b + D m, with the
/// rotations of the two edges and D = A (A + B)^-1 B.
SectionHold corner_hold(double s, Index first_edge, const RodMesh& rod, const Model& model) {
  const Index second_edge = first_edge + 1;
  const double corner = rod.arc_length_at(second_edge);
  const double start = rod.edge_middle(first_edge);
  const double end = rod.edge_middle(second_edge);
  SectionHold hold;
  hold.section = s < corner - rod.same_place()
                     ? section_on_leg(s, first_edge, first_edge - 1, rod, model)
                     : section_on_leg(s, second_edge, second_edge + 1, rod, model);
  // The angle of an edge tells the turns about its own tangent alone.
  hold.counts_turns = !is_corner(rod, second_edge, model);

  const Mat3 section = turning_axes(hold.section);
  const Vec3 softness = Vec3(rod.EI_1, rod.EI_2, rod.GJ).cwiseInverse();
  const auto compliance = [&](Index edge, double from, double to) -> Mat3 {
    const Mat3 own = section.transpose() * turning_axes(initial_frame(model, number_of(rod, edge)));
    return std::max(0.0, to - from) * own * softness.asDiagonal() * own.transpose();
  };
  const Mat3 before =
      compliance(first_edge, start, std::min(s, corner)) + compliance(second_edge, corner, s);
  const Mat3 beyond =
      compliance(first_edge, s, corner) + compliance(second_edge, std::max(s, corner), end);
  const Mat3 stiffness_between = (before + beyond).inverse();
  hold.weights = {beyond * stiffness_between, before * stiffness_between};
  const Mat3 cell = before * stiffness_between * beyond;
  hold.on_the_way = 0.5 * (cell + cell.transpose());
  hold.of_natural = hold.section;
  if (!rod.natural_curvatures.empty() || !rod.natural_twist.empty()) {
    const auto tangent = [&](Index edge) {
      return initial_frame(model, number_of(rod, edge)).tangent;
    };
    const auto turn = [&](double from, double to, const Vec3& at_start, const Vec3& at_end) {
      return natural_turn_between_sections(from, to, {at_start, at_end}, first_edge, hold.section,
                                           rod, model);
    };
    const Vec3 to_place = turn(start, s, tangent(first_edge), hold.section.tangent);
    const Vec3 from_place = turn(s, end, hold.section.tangent, tangent(second_edge));
    hold.of_natural =
        turned_back(hold.section, hold.weights[1] * from_place - hold.weights[0] * to_place);
  }
  return hold;
}

bool is_around_corner(const SectionPlace& place, const RodMesh& rod, const Model& model) {
  const bool resists = rod.EI_1 > 0.0 && rod.EI_2 > 0.0 && rod.GJ > 0.0;
  return resists && place.across.size() == 2 && sections_differ(place.first_edge, rod, model);
}

SectionHold hold_at(const SectionSpringPlace& spring, const SectionPlace& place, const RodMesh& rod,
                    const Model& model) {
  return is_around_corner(place, rod, model)
             ? corner_hold(spring.arc_length, place.first_edge, rod, model)
             : smooth_hold(spring, place, rod, model);
}

/// The part of a turn about the axes of an edge that the section at a corner makes, by its weights.
void add_turn(const ActuatedTurn& turn, const Mat3& weights, ActuatedTurn& sum) {
  for (const auto& [strain, control, weight] : turn.terms) {
    for (Index i = 0; i < 3; ++i) {
      const double share = weights(i, strain);
      if (share != 0.0) sum.terms.push_back({i, control, share * weight});
    }
  }
}

ActuatedTurn actuated_turn_around_corner(double s, Index first_edge, const SectionHold& hold,
                                         const RodMesh& rod, const Model& model) {
  const double corner = rod.arc_length_at(first_edge + 1);
  const Mat3 to_section = turning_axes(hold.section).transpose();
  const auto axes = [&](Index edge) -> Mat3 {
    return to_section * turning_axes(initial_frame(model, number_of(rod, edge)));
  };
  ActuatedTurn sum;
  for (const Index side : {0, 1}) {
    const Index edge = first_edge + side;
    const Mat3& weights = hold.weights[to_size(side)];
    const double own_end = side == 0 ? std::min(s, corner) : std::max(s, corner);
    add_turn(actuated_turn_from_edge(edge, own_end, rod), weights * axes(edge), sum);
    ActuatedTurnTo beyond(s, rod);
    beyond.from(own_end, 1.0, 1.0);
    add_turn(beyond.turn(), weights * axes(first_edge + 1 - side), sum);
  }
  return sum;
}

/// The section that springs hold, but for how the state counts twist.
template <int Edges>
typename SectionSpring<Edges>::Constants constants_of(const SectionHold& hold,
                                                      const SectionSpringPlace& spring,
                                                      Index first_edge, const RodMesh& rod,
                                                      const Model& model) {
  using Kernel = SectionSpring<Edges>;
  typename Kernel::Constants constants;
  constants.spring = {spring.stiffness, hold.on_the_way, hold.section};
  constants.actuated = spring.shift;
  for (Index i = 0; i < Edges; ++i) {
    const Index number = number_of(rod, first_edge + i);
    const SpatialEdge& edge = model.framed_edges[to_size(number)];
    typename Kernel::HeldEdge& held = constants.edges[to_size(i)];
    held.block = FrameBlock::of(number);
    held.first = edge.first;
    held.last = edge.last;
    held.weights = hold.weights[to_size(i)];
    held.carried = axes_of(initial_frame(model, number)).transpose() * axes_of(hold.of_natural);
  }
  if (const auto beside = place_beside_clamp(rod, spring.arc_length)) {
    const HeldFrame held = held_beside(*beside, rod, model);
    constants.clamp = {held, axes_of(held.drawn).transpose() * axes_of(hold.of_natural),
                       rod.clamps[to_size(beside->clamp)].holds_section};
  }
  return constants;
}

/// The section that no springs hold, at the place of `none`.
template <int Edges>
typename SectionSpring<Edges>::Constants free_section(const SectionHold& hold,
                                                      const SectionSpringPlace& none,
                                                      Index first_edge, const RodMesh& rod,
                                                      const Model& model) {
  auto constants = constants_of<Edges>(hold, none, first_edge, rod, model);
  const auto reference_direction = [&](Index edge) {
    return model.reference_positions[model.framed_edges[to_size(number_of(rod, edge))].theta];
  };
  const auto count_by = [&](Index reference, double side, double angles) {
    constants.between = {reference, side, angles + side * model.initial_frames[reference]};
  };
  const FrameBlock block = FrameBlock::of(number_of(rod, first_edge + Edges - 1));
  const double first = reference_direction(first_edge);
  if (Edges == 2) {
    count_by(block.twist_at_start(), 1.0, reference_direction(first_edge + 1) - first);
  } else if (const auto beside = place_beside_clamp(rod, none.arc_length)) {
    const bool leaves = rod.clamps[to_size(beside->clamp)].place == beside->edge;
    count_by(leaves ? block.twist_at_start() : block.twist_at_end(), leaves ? -1.0 : 1.0, -first);
  }
  return constants;
}

/// Returns the number of the element in its list.
template <int Edges>
Index add_element(const SectionHold& hold, const SectionSpringPlace& spring, Index first_edge,
                  const RodMesh& rod, Model& model) {
  using Kernel = SectionSpring<Edges>;
  std::array<Index, Kernel::kDofs> dofs{};
  for (Index i = 0; i < Edges; ++i) {
    const SpatialEdge& edge = model.framed_edges[to_size(number_of(rod, first_edge + i))];
    for (Index c = 0; c < 3; ++c) {
      dofs[to_size(3 * i + c)] = edge.start + c;
      dofs[to_size(3 * i + 3 + c)] = edge.end + c;
    }
    dofs[to_size(3 * Kernel::kNodes + i)] = edge.theta;
  }
  auto constants = constants_of<Edges>(hold, spring, first_edge, rod, model);
  for (Index i = 0; i < Edges && hold.counts_turns; ++i) {
    const Index number = number_of(rod, first_edge + i);
    constants.edges[to_size(i)].reference_twist =
        follow_twist(number, initial_frame(model, number), model);
  }
  auto& springs = elements_of<Kernel>(*model.elements);
  springs.add(dofs, constants);
  return static_cast<Index>(springs.size()) - 1;
}

}  // namespace

void add_to_section_spring(double s, const Vec3& stiffness, RodMesh& rod) {
  if (const SectionSpringPlace* known = rod.section_spring_at(s)) {
    const auto number = static_cast<std::size_t>(known - rod.section_springs.data());
    rod.section_springs[number].stiffness += stiffness;
  } else {
    SectionSpringPlace place;
    place.arc_length = s;
    place.stiffness = stiffness;
    rod.section_springs.push_back(place);
  }
}

bool is_held_or_at_corner(double s, const RodMesh& rod, const Model& model) {
  return rod.section_spring_at(s) != nullptr || is_around_corner(section_place(s, rod), rod, model);
}

ActuatedTurn actuated_turn_at(double s, const RodMesh& rod, const Model& model) {
  const SectionPlace place = section_place(s, rod);
  if (!is_around_corner(place, rod, model)) return actuated_turn(s, place, rod);
  const SectionHold hold = corner_hold(s, place.first_edge, rod, model);
  return actuated_turn_around_corner(s, place.first_edge, hold, rod, model);
}

HeldSectionAt held_section_at(double s, const RodMesh& rod, const Model& model) {
  if (const SectionSpringPlace* spring = rod.section_spring_at(s)) {
    const std::size_t element = to_size(spring->element);
    if (spring->on_one_edge)
      return elements_of<SectionSpring<1>>(*model.elements).constants[element];
    return elements_of<SectionSpring<2>>(*model.elements).constants[element];
  }
  SectionSpringPlace none;
  none.arc_length = s;
  const SectionPlace place = section_place(s, rod);
  const SectionHold hold = hold_at(none, place, rod, model);
  if (place.across.size() == 1) return free_section<1>(hold, none, place.first_edge, rod, model);
  return free_section<2>(hold, none, place.first_edge, rod, model);
}

void add_section_springs(RodMesh& rod, Model& model) {
  Index number = 0;
  for (SectionSpringPlace& spring : rod.section_springs) {
    spring.shift = rod.natural_strain_entries.spring(number++);
    const SectionPlace place = section_place(spring.arc_length, rod);
    const SectionHold hold = hold_at(spring, place, rod, model);
    spring.on_one_edge = place.across.size() == 1;
    spring.element = spring.on_one_edge
                         ? add_element<1>(hold, spring, place.first_edge, rod, model)
                         : add_element<2>(hold, spring, place.first_edge, rod, model);
  }
}

}  // namespace der
