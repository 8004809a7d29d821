#include "building/spatial_leg_elements.hpp"

#include <Eigen/LU>
#include <array>

#include "building/spatial_rod_elements.hpp"
#include "der/core/index.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/spatial_end_cell.hpp"
#include "der/energies/stretch.hpp"
#include "der/model/frames.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "model/leg_cells.hpp"
#include "model/leg_curvature.hpp"

namespace der {
namespace {

/// A side of a cell: the section of an edge or a joint, and how far the edge's angle turns it from
/// its reference frame [rad].
struct Side {
  SectionFrame section;
  double turned = 0.0;
  Index edge = -1;              ///< number in the model; -1: a joint
  const LegEnd* end = nullptr;  ///< of a joint
};

template <class Curvature>
class SpatialLegBuilder {
 public:
  SpatialLegBuilder(Leg& leg, const RodMesh& rod, Model& model)
      : leg_(leg), rod_(rod), model_(model) {}

  void add() {
    for_each_end_cell(leg_, [this](auto edges, auto joints, bool from_start) {
      this->template add_end_cell<edges(), joints()>(from_start);
    });
    // A leg of two cells between a joint and an end without a moment has its only node in one.
    for (Index place = leg_.first + 1; place < leg_.last; ++place) {
      if (!leg_.in_end_cell(place)) add_bend(place);
    }
  }

 private:
  [[nodiscard]] bool has_natural_curvature() const { return !rod_.natural_curvatures.empty(); }
  /// Natural curvature towards a director [1/m] by node.
  [[nodiscard]] auto natural_curvature(int director) const {
    return
        [this, director](Index place) { return rod_.natural_curvatures[to_size(place)][director]; };
  }
  /// Natural twist of a cell in excess of the drawn one, over `length` about a place [rad].
  [[nodiscard]] double further_twist(double place, double length) const {
    if (rod_.natural_twist.empty()) return 0.0;
    return length * (natural_twist_at_arc(place) - rod_.initial_twist);
  }
  /// [rad/m] Linear between the nodes of the leg.
  [[nodiscard]] double natural_twist_at_arc(double s) const {
    Index place = leg_.first;
    while (place + 2 <= leg_.last && rod_.arc_length[to_size(place + 1)] < s) ++place;
    const double from = rod_.arc_length[to_size(place)];
    const double share = (s - from) / rod_.edge_length[to_size(place)];
    return (1.0 - share) * rod_.natural_twist[to_size(place)] +
           share * rod_.natural_twist[to_size(place + 1)];
  }
  [[nodiscard]] Index number(Index edge) const { return rod_.first_edge + edge; }
  [[nodiscard]] double length(Index edge) const { return rod_.edge_length[to_size(edge)]; }

  [[nodiscard]] Side edge_side(Index edge) const {
    const Index number = this->number(edge);
    const double theta = model_.reference_positions[model_.dofs.angle(number)];
    return {initial_frame(model_, number), theta, number, nullptr};
  }
  [[nodiscard]] static Side joint_side(const LegEnd& end) { return {end.section, 0.0, -1, &end}; }
  [[nodiscard]] JointSection section_of(const LegEnd& end) const {
    return {end.section, joint_block(model_, end.rotation)};
  }

  /// The strains of a cell as drawn; the state follows its twist. `length`: over which it twists.
  MaterialCurvature follow_cell(const Side& before, const Side& after, double length) {
    const double twist =
        nearest_turn(twist_between(before.section, after.section), length * rod_.initial_twist);
    FramedVertex vertex;
    vertex.before = before.edge;
    vertex.after = after.edge;
    for (const Side& side : {before, after}) {
      if (side.end == nullptr) continue;
      vertex.rotation = model_.dofs.rotation(side.end->rotation);
      vertex.joint = section_of(*side.end);
    }
    model_.framed_vertices.push_back(vertex);
    model_.initial_frames[vertex.twist()] = twist - (after.turned - before.turned);
    return VertexKinematics<Curvature>(before.section, after.section, twist).strain();
  }

  void add_bend(Index place) {
    const Side before = edge_side(place - 1);
    const Side after = edge_side(place);
    const double cell = rod_.voronoi_length(place);
    MaterialCurvature rest = follow_cell(before, after, cell);
    if (has_natural_curvature()) {
      rest.kappa_1 = turn_at_node(leg_, rod_, place, natural_curvature(0));
      rest.kappa_2 = turn_at_node(leg_, rod_, place, natural_curvature(1));
    }
    rest.twist += further_twist(rod_.arc_length[to_size(place)], cell);
    std::array<Index, 11> dofs{};
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c) {
        dofs[to_size(3 * k + c)] = model_.dof(rod_.node(place - 1 + k), c);
      }
    }
    dofs[9] = model_.dofs.angle(before.edge);
    dofs[10] = model_.dofs.angle(after.edge);
    auto& list = elements_of<SpatialBend<Curvature>>(*model_.elements);
    if (leg_.first_bend < 0) leg_.first_bend = static_cast<Index>(list.size());
    list.add(dofs, {{rod_.EI_1 / cell, rod_.EI_2 / cell, rod_.GJ / cell, rest},
                    FrameBlock::of(before.edge),
                    FrameBlock::of(after.edge),
                    0.0,
                    {}});
  }

  /// At the joint at the start of the leg, or at that at its end.
  template <int Edges, int Joints>
  void add_end_cell(bool at_start) {
    using Kernel = SpatialEndCell<Curvature, Edges, Joints>;
    const Index first = at_start ? leg_.first : leg_.last - Edges;
    std::array<Index, Kernel::kDofs> dofs{};
    for (int k = 0; k < Kernel::kNodes; ++k) {
      for (int c = 0; c < 3; ++c) dofs[to_size(3 * k + c)] = model_.dof(rod_.node(first + k), c);
    }
    typename Kernel::Constants c;
    c.leaves = at_start;
    c.EI_1 = rod_.EI_1;
    c.EI_2 = rod_.EI_2;
    std::array<Side, Kernel::kFrames> sides;
    for (int i = 0; i < Edges; ++i) {
      Side& side = sides[to_size(c.frame_of_edge(i))];
      side = edge_side(first + i);
      dofs[to_size(3 * Kernel::kNodes + i)] = model_.dofs.angle(side.edge);
      c.edges[to_size(i)] = FrameBlock::of(side.edge);
    }
    const auto enter_joint = [&](int joint, const LegEnd& end) {
      sides[to_size(c.frame_of_joint(joint))] = joint_side(end);
      for (int k = 0; k < 3; ++k) {
        dofs[to_size(Kernel::kDofs - Kernel::kJoints + 3 * joint + k)] =
            model_.dofs.rotation(end.rotation) + k;
      }
      c.joints[to_size(joint)] = section_of(end);
    };
    enter_joint(0, at_start ? leg_.start : leg_.end);
    if constexpr (Joints == 2) enter_joint(1, leg_.end);

    // The compliance is that from the joint on, cells follow the leg.
    const Mat3 C = end_compliance(leg_, at_start, rod_.edge_length);
    const auto along = [&](int cell) { return at_start ? cell : Kernel::kCells - 1 - cell; };
    typename Kernel::Coupling compliance;
    for (int i = 0; i < Kernel::kCells; ++i) {
      for (int j = 0; j < Kernel::kCells; ++j) compliance(i, j) = C(along(i), along(j));
    }
    c.per_compliance = compliance.inverse();
    for (int i = 0; i < Kernel::kCells; ++i) {
      // From the middle of the edge before the cell, or from the joint, to that after it.
      const Index node = first + i + (at_start ? 0 : 1);
      const double before = sides[to_size(i)].edge < 0 ? 0.0 : 0.5 * length(node - 1);
      const double after = sides[to_size(i) + 1].edge < 0 ? 0.0 : 0.5 * length(node);
      const MaterialCurvature rest = cell_rest(at_start, C, i, along(i), sides, before + after);
      c.rest.row(i) << rest.kappa_1, rest.kappa_2,
          rest.twist + further_twist(rod_.arc_length[to_size(node)] + 0.5 * (after - before),
                                     before + after);
      c.twist[i] = rod_.GJ / (before + after);
    }
    auto& list = elements_of<Kernel>(*model_.elements);
    (at_start ? leg_.start_cell : leg_.end_cell) = static_cast<Index>(list.size());
    list.add(dofs, c);
  }

  template <class Sides>
  MaterialCurvature cell_rest(bool at_start, const Mat3& C, int cell, int from_joint,
                              const Sides& sides, double twist_length) {
    MaterialCurvature rest =
        follow_cell(sides[to_size(cell)], sides[to_size(cell) + 1], twist_length);
    if (has_natural_curvature()) {
      const double sign = at_start ? 1.0 : -1.0;
      rest.kappa_1 = sign * turn_in_end_cell(leg_, at_start, C, from_joint, natural_curvature(0));
      rest.kappa_2 = sign * turn_in_end_cell(leg_, at_start, C, from_joint, natural_curvature(1));
    }
    return rest;
  }

  Leg& leg_;
  const RodMesh& rod_;
  Model& model_;
};

}  // namespace

void add_spatial_leg_elements(RodMesh& rod, Model& model) {
  draw_frames(rod, model);
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    const SpatialEdge ends = spatial_edge(rod, edge, model);
    elements_of<Stretch<3>>(*model.elements)
        .add({ends.start, ends.start + 1, ends.start + 2, ends.end, ends.end + 1, ends.end + 2},
             {rod.EA, rod.edge_length[to_size(edge)], rod.natural_strain_entries.edge(edge)});
  }
  if (rod.EI_1 == 0.0) {
    hold_angles(rod, model);
    return;
  }
  for (Leg& leg : rod.legs) {
    if (rod.curvature == scenario::CurvatureMeasure::Angle) {
      SpatialLegBuilder<AngleCurvature>(leg, rod, model).add();
    } else {
      SpatialLegBuilder<TangentCurvature>(leg, rod, model).add();
    }
  }
}

}  // namespace der
