#include "building/leg_elements.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "building/arc_elements.hpp"
#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/end_cell.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "model/leg_cells.hpp"
#include "model/leg_curvature.hpp"
#include "model/reference_edge.hpp"

namespace der {
namespace {

template <class Curvature>
class LegBuilder {
 public:
  LegBuilder(Leg& leg, RodMesh& rod, Model& model) : leg_(leg), rod_(rod), model_(model) {}

  void add() {
    for_each_end_cell(leg_, [this](auto edges, auto joints, bool from_start) {
      this->template add_end_cell<edges(), joints()>(from_start);
    });
    for (Index place = leg_.first + 1; place < leg_.last; ++place) {
      if (!leg_.in_end_cell(place)) add_bend(place);
    }
  }

 private:
  [[nodiscard]] bool has_natural() const { return !rod_.natural_curvature.empty(); }
  /// Natural curvature [1/m] by node.
  [[nodiscard]] auto natural() const {
    return [this](Index place) { return natural_in_leg(leg_, rod_, place); };
  }
  [[nodiscard]] Vec2 edge(Index number) const { return reference_edge(rod_, number, model_); }

  void add_bend(Index place) {
    const double rest = has_natural() ? turn_at_node(leg_, rod_, place, natural())
                                      : angle_between(edge(place - 1), edge(place));
    const auto before = rod_.edge_dofs(place - 1, model_);
    const auto after = rod_.edge_dofs(place, model_);
    auto& list = elements_of<PlanarBend<Curvature>>(*model_.elements);
    if (leg_.first_bend < 0) leg_.first_bend = static_cast<Index>(list.size());
    list.add({before[0], before[1], after[0], after[1], after[2], after[3]},
             {rod_.EI / rod_.voronoi_length(place), Curvature::of(rest).kappa,
              rod_.natural_strain_entries.cell(place, false)});
  }

  /// From the joint at the start of the leg, or from that at its end.
  template <int Edges, int Joints>
  void add_end_cell(bool from_start) {
    using Kernel = EndCell<Curvature, Edges, Joints>;
    const Index joint = from_start ? leg_.first : leg_.last;
    const Index step = from_start ? 1 : -1;
    const auto edge_number = [&](int k) { return from_start ? joint + k : joint - 1 - k; };
    std::array<Index, Kernel::kDofs> dofs{};
    for (int k = 0; k < Kernel::kNodes; ++k) {
      const Index node = rod_.node(joint + step * k);
      for (int c = 0; c < 2; ++c) dofs[to_size(2 * k + c)] = model_.dof(node, c);
    }
    typename Kernel::Constants c;
    std::array<Vec2, Kernel::kDirections> drawn;
    const auto enter_joint = [&](int number, const LegEnd& end, std::size_t place) {
      const double direction = end.direction + (from_start ? 0.0 : kPi);
      dofs[to_size(2 * Kernel::kNodes + number)] = model_.dofs.rotation(end.rotation);
      c.direction[to_size(number)] = direction;
      c.driven.control[to_size(number)] = end.driven;
      drawn[place] = {std::cos(direction), std::sin(direction)};
    };
    enter_joint(0, from_start ? leg_.start : leg_.end, 0);
    if constexpr (Joints == 2) enter_joint(1, leg_.end, Kernel::kDirections - 1);
    for (int k = 0; k < Edges; ++k) drawn[to_size(k) + 1] = step * edge(edge_number(k));

    const Mat3 C = end_compliance(leg_, from_start, rod_.edge_length);
    constexpr int n = Kernel::kAngles;
    c.stiffness = rod_.EI * C.template topLeftCorner<n, n>().inverse();
    for (int i = 0; i < n; ++i) {
      const double rest = has_natural() ? turn_in_end_cell(leg_, from_start, C, i, natural())
                                        : angle_between(drawn[to_size(i)], drawn[to_size(i) + 1]);
      c.rest[i] = Curvature::of(rest).kappa;
    }
    c.actuated = rod_.natural_strain_entries.end_cell(
        static_cast<std::size_t>(&leg_ - rod_.legs.data()), from_start);
    auto& list = elements_of<Kernel>(*model_.elements);
    (from_start ? leg_.start_cell : leg_.end_cell) = static_cast<Index>(list.size());
    list.add(dofs, c);
  }

  Leg& leg_;
  RodMesh& rod_;
  Model& model_;
};

}  // namespace

void add_leg_elements(RodMesh& rod, bool with_arcs, Model& model) {
  // The damping of an arc alone would let rotations lag behind that it hardly holds.
  with_arcs = with_arcs && (rod.damping.stretching == 0.0 || rod.damping.bending > 0.0);
  rod.rest_turning_angle.assign(rod.nodes.size(), 0.0);
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    elements_of<Stretch<2>>(*model.elements)
        .add(rod.edge_dofs(edge, model),
             {rod.EA, rod.edge_length[to_size(edge)], rod.natural_strain_entries.edge(edge)});
  }
  for (Index place = 1; place < rod.num_edges(); ++place) {
    rod.rest_turning_angle[to_size(place)] =
        rod.natural_curvature.empty()
            ? angle_between(reference_edge(rod, place - 1, model),
                            reference_edge(rod, place, model))
            : rod.natural_curvature[to_size(place)] * rod.voronoi_length(place);
  }
  if (rod.EI == 0.0) return;
  for (Leg& leg : rod.legs) {
    if (rod.curvature == scenario::CurvatureMeasure::Angle) {
      LegBuilder<AngleCurvature>(leg, rod, model).add();
      if (with_arcs) add_arc_elements(leg, rod, model);
    } else {
      LegBuilder<TangentCurvature>(leg, rod, model).add();
    }
  }
}

}  // namespace der
