#include "output/leg_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "der/core/index.hpp"
#include "der/energies/arc_stretch.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/end_cell.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/registry.hpp"
#include "der/energies/strain_rate.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "model/leg_cells.hpp"
#include "model/leg_curvature.hpp"
#include "model/reference_edge.hpp"
#include "output/actuated_shape.hpp"
#include "output/each_leg_field.hpp"

namespace der {
namespace {

/// Reads a moment [N m].
using MomentReader = std::function<double(const Model& model, const State& state)>;

/// The loads of internal damping that an element bears, V s'.
template <class Kernel>
auto viscous_loads(const typename Kernel::Constants& constants, const DampingTimes& times,
                   const std::array<Index, to_size(Kernel::kDofs)>& dofs, const State& state) {
  using Strain = StrainRate<Kernel>;
  constexpr int n = Strain::kSize;
  const Configuration here;  // elements of legs take no controls for their rates
  const typename Strain::Rates rates =
      Strain::gradient(constants, here, gather(dofs, state.positions)) *
      gather(dofs, state.velocities);
  return typename Strain::Rates(Strain::viscosity(constants, times).template topLeftCorner<n, n>() *
                                rates);
}

/// Those of an element next to joints, with what driven hinges add.
template <class Constants, std::size_t Count>
auto coordinates(const Constants& constants, const std::array<Index, Count>& dofs,
                 const Model& model, const State& state) {
  return constants.driven.turned(
      [&](Index control) { return control_value(model, state, control); },
      gather(dofs, state.positions));
}

/// Which loads: all that a section bears, or those that its strains alone make.
enum class Part { Whole, Elastic };

/// Reads what the arc of an edge adds to its tension, and to the moments beside it.
class ArcReader {
 public:
  ArcReader(const LegArc& arc, const DampingTimes& damping, const Model& model)
      : arc_(arc), damping_(damping) {
    for_each_list(*model.elements, [&](const auto& list) {
      using Kernel = typename std::decay_t<decltype(list)>::KernelType;
      enter(Kernel{}, list, model);
    });
  }

  /// [N] In its edge.
  [[nodiscard]] double tension(Part part, const Model& model, const State& state) const {
    return loads_(part, model, state).front();
  }
  /// [N m] At a node of the leg.
  [[nodiscard]] double moment(Index node, Part part, const Model& model, const State& state) const {
    const Index k = arc_.step * (node - arc_.angle);
    if (k < 0 || k > arc_.edges + arc_.joints - 2) return 0.0;
    return arc_.step * loads_(part, model, state)[to_size(1 + k)];
  }

 private:
  template <class Kernel, class List>
  void enter(Kernel /*kernel*/, const List& /*list*/, const Model& /*model*/) {}
  template <int Edges, int Joints>
  void enter(ArcStretch<Edges, Joints> /*kernel*/,
             const ElementList<ArcStretch<Edges, Joints>>& list, const Model& model) {
    using Kernel = ArcStretch<Edges, Joints>;
    if (Edges != arc_.edges || Joints != arc_.joints) return;
    const auto constants = list.constants[to_size(arc_.number)];
    const auto dofs = list.dofs[to_size(arc_.number)];
    const ActuatedRest elongation(constants.elongation, 1, model);
    loads_ = [constants, dofs, elongation, times = damping_](Part part, const Model& now,
                                                             const State& state) {
      const auto x = coordinates(constants, dofs, now, state);
      auto loads = Kernel::loads(constants, elongation.value(0, now, state), x);
      if (part == Part::Whole && times.stretching > 0.0) {
        const auto viscous = viscous_loads<Kernel>(constants, times, dofs, state);
        const auto slopes = Kernel::arc_slopes(constants, x);
        loads.tension += viscous[0] * slopes.length + viscous[1];
        loads.moments += viscous[0] * slopes.angles;
      }
      Loads all{loads.tension};
      std::copy_n(loads.moments.data(), Kernel::kAngles, all.begin() + 1);
      return all;
    };
  }

  using Loads = std::array<double, 5>;  // tension, and the moments along the element

  LegArc arc_;
  DampingTimes damping_;
  std::function<Loads(Part part, const Model& model, const State& state)> loads_;
};

/// Reads quantities off the nodes and edges of one leg.
class LegReader {
 public:
  LegReader(const Leg& leg, const RodMesh& rod, const Model& model)
      : leg_(leg), rod_(rod), actuated_(rod) {
    const MomentReader none = [](const Model& /*model*/, const State& /*state*/) { return 0.0; };
    moments_.assign(to_size(leg.num_cells()) + 1, none);
    viscous_.assign(moments_.size(), none);
    if (rod.EI > 0.0) {
      if (rod.curvature == scenario::CurvatureMeasure::Angle) {
        find_moments<AngleCurvature>(model);
      } else {
        find_moments<TangentCurvature>(model);
      }
    }
    find_curvatures(model);
    for (Index edge = leg.first; edge < leg.last; ++edge) {
      elongations_.emplace_back(rod.natural_strain_entries.edge(edge), 1, model);
    }
    for (const LegArc& arc : leg.arcs) arcs_.emplace_back(arc, rod.damping, model);
    for (const bool from_start : {true, false}) {
      const Mat3 C = end_compliance(leg, from_start, rod.edge_length);
      End& end = from_start ? start_ : end_;
      end.per_moment = rod.EI > 0.0 ? C(0, 1) / rod.EI : 0.0;
      end.lengths = C.row(0);
      const double direction = (from_start ? leg.start : leg.end).direction;
      const Vec2 edge = reference_edge(rod, from_start ? leg.first : leg.last - 1, model);
      end.natural = angle_between({std::cos(direction), std::sin(direction)}, edge);
      if (rod.natural_curvature.empty()) continue;
      end.natural = turn_in_end_cell(leg, from_start, C, 0,
                                     [&](Index place) { return natural_in_leg(leg, rod, place); });
    }
  }

  /// Moment [N m] in the curve of the leg at a node, counted from its start. A node inside a leg
  /// that knows its arcs is l^2/12 of the curvature beside the curve, and so is the force.
  [[nodiscard]] double moment(Index node, const Model& model, const State& state,
                              Part part = Part::Whole) const {
    const double there = transmitted(node, part, model, state);
    if (leg_.arcs.empty() || node == 0 || node == leg_.num_cells()) return there;
    return there + tension(node, model, state, part) * beside(node, model, state);
  }
  /// How far to the left of a node inside the leg the curve lies [m].
  [[nodiscard]] double beside(Index node, const Model& model, const State& state) const {
    const double edges = vector(node - 1, model, state).norm() + vector(node, model, state).norm();
    return edges * bend(node, model, state) / 24.0;
  }
  /// [1/m] With what actuations add.
  [[nodiscard]] double natural_curvature(Index node, const Model& model, const State& state) const {
    return natural_[to_size(node)] + actuated(node, model, state);
  }
  [[nodiscard]] double curvature(Index node, const Model& model, const State& state) const {
    const double elastic =
        rod_.EI > 0.0 ? moment(node, model, state, Part::Elastic) / rod_.EI : 0.0;
    return elastic + natural_curvature(node, model, state);
  }

  /// The angle of the tangent from the x axis [rad]: between nodes linear through the middles of
  /// the edges, whose directions it has there.
  [[nodiscard]] double slope(Index node, const Model& model, const State& state) const {
    const Index last = leg_.num_cells();
    const bool from_end = leg_.start.rotation < 0 && leg_.end.rotation >= 0;
    if (node == 0 && leg_.start.rotation >= 0) return slope_of(leg_.start, model, state);
    if (node == last && leg_.end.rotation >= 0) return slope_of(leg_.end, model, state);
    double edge = 0.0;  // direction of the edge before the node, or of the first one
    if (from_end) {
      edge = edge_beside(slope_of(leg_.end, model, state), last - 1, model, state);
      for (Index k = last - 1; k >= std::max<Index>(node, 1); --k) edge -= turn(k, model, state);
    } else {
      edge = edge_beside(
          leg_.start.rotation >= 0 ? slope_of(leg_.start, model, state) : leg_.start.direction, 0,
          model, state);
      for (Index k = 1; k < node; ++k) edge += turn(k, model, state);
    }
    return slope_beside(edge, node, model, state);
  }

  /// The slope but for whole turns: the edge beside the node tells it.
  [[nodiscard]] double tangent_angle(Index node, const Model& model, const State& state) const {
    if (node == 0 && leg_.start.rotation >= 0) return slope_of(leg_.start, model, state);
    if (node == leg_.num_cells() && leg_.end.rotation >= 0) return slope_of(leg_.end, model, state);
    const Vec2 edge = vector(std::max<Index>(node - 1, 0), model, state);
    return slope_beside(std::atan2(edge.y(), edge.x()), node, model, state);
  }

  /// The force [N] that the rod behind a node exerts on the rod before it: linear through the
  /// middles of the two nearest edges.
  [[nodiscard]] Vec2 force(Index node, const Model& model, const State& state,
                           Part part = Part::Whole) const {
    return through_middles<Vec2>(leg_, rod_, node,
                                 [&](Index edge) { return edge_force(edge, part, model, state); });
  }
  /// Its component along the tangent [N].
  [[nodiscard]] double tension(Index node, const Model& model, const State& state,
                               Part part = Part::Whole) const {
    const double angle = tangent_angle(node, model, state);
    return force(node, model, state, part).dot(Vec2{std::cos(angle), std::sin(angle)});
  }
  [[nodiscard]] double strain(Index node, const Model& model, const State& state) const {
    return tension(node, model, state, Part::Elastic) / rod_.EA;
  }

 private:
  /// How the outermost edge leans against the tangent at an end without a joint.
  struct End {
    double per_moment = 0.0;      ///< of the node next to it [rad/(N m)]
    double natural = 0.0;         ///< without stress [rad]
    Vec3 lengths = Vec3::Zero();  ///< by the curvature at the nodes from the end on [m]
  };

  /// The slope at a node that has no joint. `edge`: the direction of the edge before it, or of the
  /// first one [rad].
  [[nodiscard]] double slope_beside(double edge, Index node, const Model& model,
                                    const State& state) const {
    const Index last = leg_.num_cells();
    if (node == 0) return edge - lean(start_, 1, model, state);
    if (node == last) return edge - lean(end_, last - 1, model, state);
    const double before = edge + lean_in_middle(node - 1, model, state);
    const double after = edge + turn(node, model, state) + lean_in_middle(node, model, state);
    const double share = length(node) / (length(node - 1) + length(node));
    const double between = share * before + (1.0 - share) * after;
    if (leg_.arcs.empty()) return between;
    return between - (bend(node + 1, model, state) - bend(node - 1, model, state)) / 24.0;
  }

  /// The moment [N m] that the elements transmit at a node.
  [[nodiscard]] double transmitted(Index node, Part part, const Model& model,
                                   const State& state) const {
    double sum = moments_[to_size(node)](model, state);
    if (part == Part::Whole) sum += viscous_[to_size(node)](model, state);
    // An arc sees the nodes of its edge, and one more on either side.
    const Index last = std::min(node + 2, static_cast<Index>(arcs_.size()));
    for (Index edge = std::max<Index>(node - 2, 0); edge < last; ++edge) {
      sum += arcs_[to_size(edge)].moment(node, part, model, state);
    }
    return sum;
  }
  /// The curvature at a node times the length of a cell, as the bending energy has it [-].
  [[nodiscard]] double bend(Index node, const Model& model, const State& state) const {
    return length(std::min(node, leg_.num_cells() - 1)) *
           (moments_[to_size(node)](model, state) / rod_.EI +
            natural_curvature(node, model, state));
  }

  template <class Curvature>
  void find_moments(const Model& model) {
    for_each_end_cell(leg_, [&](auto edges, auto joints, bool from_start) {
      add_cell<EndCell<Curvature, edges(), joints()>>(from_start, model);
    });
    if (leg_.first_bend < 0) return;
    const auto& bends = elements_of<PlanarBend<Curvature>>(*model.elements);
    const Index first = leg_.start_cell >= 0 ? 2 : 1;
    const Index last = leg_.num_cells() - (leg_.end_cell >= 0 ? 2 : 1);
    for (Index node = first; node <= last; ++node) {
      const std::size_t number = to_size(leg_.first_bend + node - first);
      const auto constants = bends.constants[number];
      const auto dofs = bends.dofs[number];
      const ActuatedRest rest(constants.actuated, 1, model);
      moments_[to_size(node)] = [constants, dofs, rest](const Model& now, const State& state) {
        const auto [before, after] = PlanarBend<Curvature>::edges(gather(dofs, state.positions));
        return bend_response<Curvature>(constants.stiffness_per_length,
                                        constants.rest_kappa + rest.value(0, now, state),
                                        angle_between(before, after))
            .moment;
      };
      if (rod_.damping.bending == 0.0) continue;
      viscous_[to_size(node)] = [constants, dofs, times = rod_.damping](const Model& /*model*/,
                                                                        const State& state) {
        const auto [before, after] = PlanarBend<Curvature>::edges(gather(dofs, state.positions));
        return Curvature::of(angle_between(before, after)).first *
               viscous_loads<PlanarBend<Curvature>>(constants, times, dofs, state)[0];
      };
    }
  }

  template <class Kernel>
  void add_cell(bool from_start, const Model& model) {
    const auto& list = elements_of<Kernel>(*model.elements);
    const std::size_t number = to_size(from_start ? leg_.start_cell : leg_.end_cell);
    const auto constants = list.constants[number];
    const auto dofs = list.dofs[number];
    const double sign = from_start ? 1.0 : -1.0;
    const ActuatedRest rest(constants.actuated, Kernel::kAngles, model);
    for (int k = 0; k < Kernel::kAngles; ++k) {
      const Index node = from_start ? k : leg_.num_cells() - k;
      moments_[to_size(node)] = [constants, dofs, sign, k, rest](const Model& now,
                                                                 const State& state) {
        typename Kernel::Angles natural = constants.rest;
        for (int i = 0; i < Kernel::kAngles; ++i) natural[i] += rest.value(i, now, state);
        return sign *
               Kernel::moments(constants, natural, coordinates(constants, dofs, now, state))[k];
      };
      if (rod_.damping.bending == 0.0) continue;
      viscous_[to_size(node)] = [constants, dofs, sign, k, times = rod_.damping](
                                    const Model& /*model*/, const State& state) {
        return sign * Kernel::measure_slopes(constants, gather(dofs, state.positions))[k] *
               viscous_loads<Kernel>(constants, times, dofs, state)[k];
      };
    }
  }

  /// Curvatures at the nodes as drawn, known at inner nodes, and without stress.
  void find_curvatures(const Model& model) {
    const Index last = leg_.num_cells();
    drawn_.assign(to_size(last) + 1, 0.0);
    for (Index k = 1; k < last; ++k) {
      drawn_[to_size(k)] = angle_between(reference_edge(rod_, leg_.first + k - 1, model),
                                         reference_edge(rod_, leg_.first + k, model)) /
                           rod_.voronoi_length(leg_.first + k);
    }
    continue_to_ends(leg_, rod_, drawn_);
    natural_ = drawn_;
    if (rod_.natural_curvature.empty()) return;
    for (Index k = 0; k <= last; ++k)
      natural_[to_size(k)] = natural_in_leg(leg_, rod_, k + leg_.first);
  }

  [[nodiscard]] double length(Index edge) const {
    return rod_.edge_length[to_size(leg_.first + edge)];
  }
  [[nodiscard]] Vec2 vector(Index edge, const Model& model, const State& state) const {
    return along_edge<2>(rod_.edge(leg_.first + edge, model), state.positions);
  }
  [[nodiscard]] double turn(Index node, const Model& model, const State& state) const {
    return angle_between(vector(node - 1, model, state), vector(node, model, state));
  }
  static double slope_of(const LegEnd& end, const Model& model, const State& state) {
    const double driven = end.driven < 0 ? 0.0 : control_value(model, state, end.driven);
    return end.direction + driven + state.positions[model.dofs.rotation(end.rotation)];
  }
  /// Direction [rad] of an edge within half a turn of a slope.
  [[nodiscard]] double edge_beside(double slope, Index edge, const Model& model,
                                   const State& state) const {
    return slope + angle_between({std::cos(slope), std::sin(slope)}, vector(edge, model, state));
  }
  /// By how much the outermost edge has turned against the tangent at an end where no moment acts.
  [[nodiscard]] double lean(const End& end, Index beside, const Model& model,
                            const State& state) const {
    const bool from_start = &end == &start_;
    const double sign = from_start ? 1.0 : -1.0;
    double lean = end.natural + sign * end.per_moment * moment(beside, model, state, Part::Elastic);
    for (Index k = 0; k <= std::min<Index>(leg_.num_cells(), 2); ++k) {
      const Index node = from_start ? k : leg_.num_cells() - k;
      lean += sign * end.lengths[k] * actuated(node, model, state);
    }
    return lean;
  }
  /// Curvature that actuations give the rod at a node, on the side of the leg [1/m].
  [[nodiscard]] double actuated(Index node, const Model& model, const State& state) const {
    if (!actuated_.is_strained()) return 0.0;
    const double s = rod_.arc_length_at(leg_.first + node);
    return actuated_.strains(s, node == leg_.num_cells(), model, state)[0];
  }
  /// By how much the tangent at the middle of an edge is turned from the edge: of an outermost one,
  /// whose end is on the curve and whose other node is beside it.
  [[nodiscard]] double lean_in_middle(Index edge, const Model& model, const State& state) const {
    const Index last = leg_.num_cells();
    const auto bent = [&](Index node) {
      return length(edge) / 12.0 * (curvature(node, model, state) - drawn_[to_size(node)]);
    };
    return (edge == 0 ? bent(0) : 0.0) - (edge == last - 1 ? bent(last) : 0.0);
  }

  /// The force [N] that the rod behind an edge exerts on the rod before it.
  [[nodiscard]] Vec2 edge_force(Index edge, Part part, const Model& model,
                                const State& state) const {
    const Vec2 along = vector(edge, model, state);
    const double now = along.norm();
    double extension = now - length(edge) - elongations_[to_size(edge)].value(0, model, state);
    if (part == Part::Whole && rod_.damping.stretching > 0.0) {
      const Vec2 rate = along_edge<2>(rod_.edge(leg_.first + edge, model), state.velocities);
      extension += rod_.damping.stretching * along.dot(rate) / now;
    }
    double tension = rod_.EA * extension / length(edge);
    if (!arcs_.empty()) tension += arcs_[to_size(edge)].tension(part, model, state);
    const double shear =
        (transmitted(edge, part, model, state) - transmitted(edge + 1, part, model, state)) / now;
    return (tension * along + shear * perpendicular(along)) / now;
  }

  Leg leg_;
  RodMesh rod_;
  ActuatedShape actuated_;
  std::vector<MomentReader> moments_;      // of each node, by its bending energy
  std::vector<MomentReader> viscous_;      // by the damping of bending
  std::vector<ArcReader> arcs_;            // of each edge, or none
  std::vector<ActuatedRest> elongations_;  // [m] of each edge
  std::vector<double> drawn_;              // curvature of each node [1/m]
  std::vector<double> natural_;            // likewise, without stress
  End start_;
  End end_;
};

/// A coordinate of the curve at the nodes of a rod: nodes inside legs that know their arcs lie
/// beside it.
class LegPlaceField : public RodField {
 public:
  LegPlaceField(int component, const RodMesh& rod, const Model& model)
      : RodField(rod.arc_length), component_(component), legs_of_(rod.nodes.size()) {
    for (const Index node : rod.nodes) dofs_.push_back(model.dof(node, component));
    smooth_.assign(rod.nodes.size(), true);
    for (const Leg& leg : rod.legs) {
      smooth_[to_size(leg.first)] = leg.first == 0;
      if (leg.arcs.empty()) continue;
      const auto reader = std::make_shared<const LegReader>(leg, rod, model);
      for (Index place = leg.first + 1; place < leg.last; ++place) {
        legs_of_[to_size(place)] = {reader, place - leg.first};
      }
    }
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const double at_node = state.positions[dofs_[i]];
    const auto& [leg, node] = legs_of_[i];
    if (leg == nullptr) return at_node;
    const double angle = leg->tangent_angle(node, model, state);
    return at_node +
           leg->beside(node, model, state) * (component_ == 0 ? -std::sin(angle) : std::cos(angle));
  }
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return smooth_[i]; }

 private:
  int component_;
  std::vector<Index> dofs_;
  std::vector<std::pair<std::shared_ptr<const LegReader>, Index>> legs_of_;
  std::vector<bool> smooth_;
};

class LegField : public EachLegField {
 public:
  LegField(LegQuantity quantity, const RodMesh& rod, const Model& model)
      : EachLegField(rod), quantity_(quantity) {
    for (const Leg& leg : rod.legs) legs_.emplace_back(leg, rod, model);
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const auto& [number, node] = places()[i];
    const LegReader& leg = legs_[number];
    switch (quantity_) {
      case LegQuantity::Moment:
        return leg.moment(node, model, state);
      case LegQuantity::Curvature:
        return leg.curvature(node, model, state);
      case LegQuantity::NaturalCurvature:
        return leg.natural_curvature(node, model, state);
      case LegQuantity::Strain:
        return leg.strain(node, model, state);
      case LegQuantity::Tension:
        return leg.tension(node, model, state);
      case LegQuantity::ForceX:
        return leg.force(node, model, state).x();
      case LegQuantity::ForceY:
        return leg.force(node, model, state).y();
      case LegQuantity::TangentX:
        return std::cos(leg.slope(node, model, state));
      case LegQuantity::TangentY:
        return std::sin(leg.slope(node, model, state));
      case LegQuantity::Slope:
        break;
    }
    return leg.slope(node, model, state);
  }
  /// The slope is what is interpolated, so that tangents stay of length 1.
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    if (quantity_ != LegQuantity::TangentX && quantity_ != LegQuantity::TangentY) {
      return RodField::interpolate(weights, model, state);
    }
    double slope = 0.0;
    for (const auto& [number, weight] : weights) {
      const auto& [leg, node] = places()[number];
      slope += weight * legs_[leg].slope(node, model, state);
    }
    return quantity_ == LegQuantity::TangentX ? std::cos(slope) : std::sin(slope);
  }

 private:
  LegQuantity quantity_;
  std::vector<LegReader> legs_;
};

}  // namespace

std::unique_ptr<RodField> make_leg_place_field(int component, const RodMesh& rod,
                                               const Model& model) {
  return std::make_unique<LegPlaceField>(component, rod, model);
}

std::unique_ptr<RodField> make_leg_field(LegQuantity quantity, const RodMesh& rod,
                                         const Model& model) {
  return std::make_unique<LegField>(quantity, rod, model);
}

}  // namespace der
