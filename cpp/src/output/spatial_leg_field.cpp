#include "output/spatial_leg_field.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/spatial_end_cell.hpp"
#include "der/model/frames.hpp"
#include "model/leg_cells.hpp"
#include "model/leg_curvature.hpp"
#include "output/each_leg_field.hpp"

namespace der {
namespace {

/// Reads a moment [N m] in fixed axes.
using MomentReader = std::function<Vec3(const Configuration& here)>;

/// Reads quantities off the nodes and edges of one leg in space. Nodes are counted from its start.
/// "In a section" are two parts towards the directors and one about the tangent.
class SpatialLegReader {
 public:
  SpatialLegReader(const Leg& leg, const RodMesh& rod, const Model& model)
      : leg_(leg), rod_(rod), stiffness_(rod.EI_1, rod.EI_2, rod.GJ) {
    moments_.assign(to_size(leg.num_cells()) + 1,
                    [](const Configuration& /*here*/) { return Vec3(Vec3::Zero()); });
    if (bends()) {
      if (rod.curvature == scenario::CurvatureMeasure::Angle) {
        find_moments<AngleCurvature>(model);
      } else {
        find_moments<TangentCurvature>(model);
      }
    }
    find_strains(model);
    for (const bool at_start : {true, false}) {
      const Mat3 C = end_compliance(leg, at_start, rod.edge_length);
      End& end = at_start ? start_ : end_;
      end.per_moment = C(0, 1);
      end.natural = natural_lean(at_start, C, model);
    }
  }

  /// The moment that the rod behind a node exerts on the rod before it [N m].
  [[nodiscard]] Vec3 moment(Index node, const Configuration& here) const {
    return moments_[to_size(node)](here);
  }
  /// The same in the section [N m].
  [[nodiscard]] Vec3 moment_in_section(Index node, const Model& model,
                                       const Configuration& here) const {
    return components(moment(node, here), section(node, model, here));
  }
  /// Curvatures and twist without stress, in the section [1/m].
  [[nodiscard]] const Vec3& natural(Index node) const { return natural_[to_size(node)]; }
  [[nodiscard]] Vec3 strain(Index node, const Model& model, const Configuration& here) const {
    if (!bends()) return natural(node);
    return natural(node) + moment_in_section(node, model, here).cwiseQuotient(stiffness_);
  }

  [[nodiscard]] SectionFrame section(Index node, const Model& model,
                                     const Configuration& here) const {
    const Index last = leg_.num_cells();
    if (node == 0 && leg_.start.rotation >= 0) return joint_section(leg_.start, model, here);
    if (node == last && leg_.end.rotation >= 0) return joint_section(leg_.end, model, here);
    if (node == 0 || node == last) return section_at_free_end(node, model, here);
    const SectionFrame before = middle_section(node - 1, model, here);
    const SectionFrame after = middle_section(node, model, here);
    const double share = length(node - 1) / (length(node - 1) + length(node));
    const Vec3 tangent = ((1.0 - share) * before.tangent + share * after.tangent).normalized();
    const Vec3 director = transport(before.first, before.tangent, tangent);
    return SectionFrame::of(tangent, made_perpendicular(director, tangent))
        .turned(share * twist_between(before, after));
  }

  /// The force [N] that the rod behind a node exerts on the rod before it: linear through the
  /// middles of the two nearest edges.
  [[nodiscard]] Vec3 force(Index node, const Model& model, const Configuration& here) const {
    return through_middles<Vec3>(leg_, rod_, node,
                                 [&](Index edge) { return edge_force(edge, model, here); });
  }
  [[nodiscard]] double tension(Index node, const Model& model, const Configuration& here) const {
    return force(node, model, here).dot(section(node, model, here).tangent);
  }

 private:
  /// How the outermost edge leans against the tangent at an end without a joint.
  struct End {
    double per_moment = 0.0;      ///< of the node next to it, over the stiffness [m]
    Vec3 natural = Vec3::Zero();  ///< without stress, in the section [-]
  };

  [[nodiscard]] bool bends() const { return rod_.EI_1 > 0.0; }
  [[nodiscard]] double length(Index edge) const {
    return rod_.edge_length[to_size(leg_.first + edge)];
  }
  [[nodiscard]] Index number(Index edge) const { return rod_.first_edge + leg_.first + edge; }
  static Vec3 components(const Vec3& moment, const SectionFrame& frame) {
    return {moment.dot(frame.second), -moment.dot(frame.first), moment.dot(frame.tangent)};
  }
  static SectionFrame joint_section(const LegEnd& end, const Model& model,
                                    const Configuration& here) {
    const Vec3 w = here.coordinates.segment<3>(model.dofs.rotation(end.rotation));
    return JointTurn(joint_block(model, end.rotation), here.controls, w).section(end.section);
  }
  [[nodiscard]] SectionFrame edge_section(Index edge, const Model& model,
                                          const Configuration& here) const {
    return section_frame(model, number(edge), here);
  }

  /// The frame turned towards its directors by two small angles [rad].
  static SectionFrame bent(const SectionFrame& frame, double towards_1, double towards_2) {
    const Vec3 axis = towards_1 * frame.second - towards_2 * frame.first;
    const double angle = axis.norm();
    if (angle == 0.0) return frame;
    const Eigen::AngleAxisd turn(angle, axis / angle);
    return SectionFrame::of(turn * frame.tangent, turn * frame.first);
  }
  /// The section in the middle of an edge. An outermost edge leans against the tangent there: its
  /// end is on the curve and its other node beside it.
  [[nodiscard]] SectionFrame middle_section(Index edge, const Model& model,
                                            const Configuration& here) const {
    const SectionFrame frame = edge_section(edge, model, here);
    Vec3 lean = Vec3::Zero();
    const auto beside = [&](Index node) -> Vec3 {
      if (!bends()) return Vec3::Zero();
      const Vec3 curvature = natural(node) - drawn_[to_size(node)] +
                             components(moment(node, here), frame).cwiseQuotient(stiffness_);
      return length(edge) / 12.0 * curvature;
    };
    if (edge == 0) lean += beside(0);
    if (edge == leg_.num_cells() - 1) lean -= beside(leg_.num_cells());
    return bent(frame, lean[0], lean[1]);
  }
  [[nodiscard]] SectionFrame section_at_free_end(Index node, const Model& model,
                                                 const Configuration& here) const {
    const bool at_start = node == 0;
    const Index edge = at_start ? 0 : node - 1;
    const SectionFrame frame = edge_section(edge, model, here);
    const End& end = at_start ? start_ : end_;
    Vec3 lean = end.natural;
    if (bends()) {
      const Vec3 near = moment(at_start ? 1 : node - 1, here);
      lean += (at_start ? 1.0 : -1.0) * end.per_moment *
              components(near, frame).cwiseQuotient(stiffness_);
    }
    return bent(frame, -lean[0], -lean[1])
        .turned((at_start ? -0.5 : 0.5) * length(edge) * rod_.initial_twist);
  }
  /// From the drawn section at an end without a joint to the outermost edge.
  [[nodiscard]] Vec3 natural_lean(bool at_start, const Mat3& C, const Model& model) const {
    if (!rod_.natural_curvatures.empty()) {
      const auto towards = [&](int director) {
        return turn_in_end_cell(leg_, at_start, C, 0, [&](Index place) {
          return rod_.natural_curvatures[to_size(place)][director];
        });
      };
      return {towards(0), towards(1), 0.0};
    }
    const SectionFrame& end = (at_start ? leg_.start : leg_.end).section;
    const SectionFrame edge = initial_frame(model, number(at_start ? 0 : leg_.num_cells() - 1));
    return {edge.first.dot(edge.tangent - end.tangent), edge.second.dot(edge.tangent - end.tangent),
            0.0};
  }

  template <class Curvature>
  void find_moments(const Model& model) {
    for_each_end_cell(leg_, [&](auto edges, auto joints, bool from_start) {
      add_cell<SpatialEndCell<Curvature, edges(), joints()>>(from_start, model);
    });
    if (leg_.first_bend < 0) return;
    using Bend = SpatialBend<Curvature>;
    const auto& bends = elements_of<Bend>(*model.elements);
    const Index first = leg_.start_cell >= 0 ? 2 : 1;
    const Index last = leg_.num_cells() - (leg_.end_cell >= 0 ? 2 : 1);
    for (Index node = first; node <= last; ++node) {
      const std::size_t bend = to_size(leg_.first_bend + node - first);
      moments_[to_size(node)] = [constants = bends.constants[bend],
                                 dofs = bends.dofs[bend]](const Configuration& here) {
        const auto frames = Bend::frames(constants, here.controls, gather(dofs, here.coordinates));
        VertexResponse response;
        VertexKinematics<Curvature>(frames.a.frame, frames.b.frame, frames.twist)
            .template respond<false>(constants.vertex, response);
        return response.moment;
      };
    }
  }

  template <class Kernel>
  void add_cell(bool at_start, const Model& model) {
    const auto& list = elements_of<Kernel>(*model.elements);
    const std::size_t element = to_size(at_start ? leg_.start_cell : leg_.end_cell);
    for (int k = 0; k < Kernel::kCells; ++k) {
      const Index node = at_start ? k : leg_.num_cells() - Kernel::kCells + 1 + k;
      moments_[to_size(node)] = [constants = list.constants[element], dofs = list.dofs[element],
                                 k](const Configuration& here) {
        return typename Kernel::Response(constants, here.controls, gather(dofs, here.coordinates))
            .moment(k);
      };
    }
  }

  /// Curvatures and twists at the nodes as drawn, known at inner nodes, and without stress.
  void find_strains(const Model& model) {
    const Index last = leg_.num_cells();
    drawn_.assign(to_size(last) + 1, Vec3(0.0, 0.0, rod_.initial_twist));
    for (Index k = 1; k < last; ++k) {
      const SectionFrame before = initial_frame(model, number(k - 1));
      const SectionFrame after = initial_frame(model, number(k));
      const double twist = nearest_turn(twist_between(before, after),
                                        rod_.voronoi_length(leg_.first + k) * rod_.initial_twist);
      const MaterialCurvature strain =
          VertexKinematics<AngleCurvature>(before, after, twist).strain();
      drawn_[to_size(k)].head<2>() =
          Vec2(strain.kappa_1, strain.kappa_2) / rod_.voronoi_length(leg_.first + k);
    }
    continue_to_ends(leg_, rod_, drawn_);
    natural_ = drawn_;
    for (Index k = 0; k <= last; ++k) {
      const std::size_t place = to_size(leg_.first + k);
      if (!rod_.natural_curvatures.empty()) {
        natural_[to_size(k)].head<2>() = rod_.natural_curvatures[place];
      }
      if (!rod_.natural_twist.empty()) natural_[to_size(k)][2] = rod_.natural_twist[place];
    }
  }

  /// The force [N] that the rod behind an edge exerts on the rod before it.
  [[nodiscard]] Vec3 edge_force(Index edge, const Model& model, const Configuration& here) const {
    const Vec3 along = along_edge<3>(rod_.edge(leg_.first + edge, model), here.coordinates);
    const double now = along.norm();
    const double tension = rod_.EA * (now / length(edge) - 1.0);
    const Vec3 change = moment(edge + 1, here) - moment(edge, here);
    return (tension * along + along.cross(change) / now) / now;
  }

  Leg leg_;
  RodMesh rod_;
  Vec3 stiffness_;
  std::vector<MomentReader> moments_;  // of each node
  std::vector<Vec3> drawn_;            // strains of each node [1/m]
  std::vector<Vec3> natural_;          // likewise, without stress
  End start_;
  End end_;
};

class SpatialLegField : public EachLegField {
 public:
  /// Reads the value at a node of a leg.
  using Reading = std::function<double(const SpatialLegReader& leg, Index node, const Model& model,
                                       const Configuration& here)>;

  SpatialLegField(Reading read, const RodMesh& rod, const Model& model)
      : EachLegField(rod), read_(std::move(read)) {
    for (const Leg& leg : rod.legs) legs_.emplace_back(leg, rod, model);
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const auto& [number, node] = places()[i];
    return read_(legs_[number], node, model, configuration_of(model, state));
  }
  void sample_all(const Model& model, const State& state, double* values) const override {
    const Configuration here = configuration_of(model, state);
    for (std::size_t i = 0; i < places().size(); ++i) {
      const auto& [number, node] = places()[i];
      values[i] = read_(legs_[number], node, model, here);
    }
  }

 private:
  Reading read_;
  std::vector<SpatialLegReader> legs_;
};

SpatialLegField::Reading reading_of(SpatialLegQuantity quantity, double EA) {
  using Quantity = SpatialLegQuantity;
  const auto component = [quantity](Quantity first) {
    return static_cast<Index>(quantity) - static_cast<Index>(first);
  };
  switch (quantity) {
    case Quantity::Strain:
      return [EA](const auto& leg, Index node, const auto& model, const auto& here) {
        return leg.tension(node, model, here) / EA;
      };
    case Quantity::Tension:
      return [](const auto& leg, Index node, const auto& model, const auto& here) {
        return leg.tension(node, model, here);
      };
    case Quantity::TangentX:
    case Quantity::TangentY:
    case Quantity::TangentZ:
      return [axis = component(Quantity::TangentX)](const auto& leg, Index node, const auto& model,
                                                    const auto& here) {
        return leg.section(node, model, here).tangent[axis];
      };
    case Quantity::ForceX:
    case Quantity::ForceY:
    case Quantity::ForceZ:
      return [axis = component(Quantity::ForceX)](const auto& leg, Index node, const auto& model,
                                                  const auto& here) {
        return leg.force(node, model, here)[axis];
      };
    default:
      return [axis = component(Quantity::MomentX)](const auto& leg, Index node,
                                                   const auto& /*model*/, const auto& here) {
        return leg.moment(node, here)[axis];
      };
  }
}

SpatialLegField::Reading reading_of(SectionQuantity quantity) {
  using Quantity = SectionQuantity;
  const auto moment = [](const auto& reduce) {
    return [reduce](const auto& leg, Index node, const auto& model, const auto& here) {
      return reduce(leg.moment_in_section(node, model, here));
    };
  };
  const auto strain = [](const auto& reduce) {
    return [reduce](const auto& leg, Index node, const auto& model, const auto& here) {
      return reduce(leg.strain(node, model, here));
    };
  };
  const auto natural = [](Index part) {
    return [part](const auto& leg, Index node, const auto& /*model*/, const auto& /*here*/) {
      return leg.natural(node)[part];
    };
  };
  const auto part = [](Index number) {
    return [number](const Vec3& parts) { return parts[number]; };
  };
  const auto bending = [](const Vec3& parts) { return parts.head<2>().norm(); };
  switch (quantity) {
    case Quantity::Curvature:
      return strain(bending);
    case Quantity::Curvature1:
      return strain(part(0));
    case Quantity::Curvature2:
      return strain(part(1));
    case Quantity::Twist:
      return strain(part(2));
    case Quantity::Moment:
      return moment(bending);
    case Quantity::Moment1:
      return moment(part(0));
    case Quantity::Moment2:
      return moment(part(1));
    case Quantity::Torque:
      return moment(part(2));
    case Quantity::NaturalCurvature1:
      return natural(0);
    case Quantity::NaturalCurvature2:
      return natural(1);
    case Quantity::NaturalTwist:
      break;
  }
  return natural(2);
}

}  // namespace

std::unique_ptr<RodField> make_spatial_leg_field(SpatialLegQuantity quantity, const RodMesh& rod,
                                                 const Model& model) {
  return std::make_unique<SpatialLegField>(reading_of(quantity, rod.EA), rod, model);
}

std::unique_ptr<RodField> make_spatial_leg_field(SectionQuantity quantity, const RodMesh& rod,
                                                 const Model& model) {
  return std::make_unique<SpatialLegField>(reading_of(quantity), rod, model);
}

}  // namespace der
