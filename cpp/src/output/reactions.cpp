#include "der/output/reactions.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/registry.hpp"
#include "der/loads/external_force.hpp"
#include "der/model/clamp_cell.hpp"
#include "der/model/internal_damping.hpp"
#include "der/model/location.hpp"
#include "der/model/moment_place.hpp"
#include "der/model/spin.hpp"
#include "der/output/vertex_strain.hpp"
#include "der/scenario/scenario.hpp"
#include "der/supports/bearing.hpp"
#include "der/supports/spring.hpp"
#include "output/acting_elements.hpp"
#include "output/held_motion.hpp"
#include "output/in_space.hpp"
#include "output/spread_moments.hpp"

namespace der {
namespace {

template <class Kernel>
struct IsPlanarClamp : std::false_type {};
template <class Curvature>
struct IsPlanarClamp<PlanarClamp<Curvature>> : std::true_type {};

template <class Kernel>
struct StartsFromPivot : std::false_type {};
template <class Kernel, class PivotKind>
struct StartsFromPivot<FromPivot<Kernel, PivotKind>> : std::true_type {
  using Element = Kernel;
};

template <class Kernel>
struct IsSectionSpring : std::false_type {};
template <int Edges>
struct IsSectionSpring<SectionSpring<Edges>> : std::true_type {};

Vec3 in_space(const Vec3& vector) { return vector; }

/// The part of a spring that belongs to one of the supports whose springs act there together; of
/// an axis about which none of them holds an equal part.
double share_of(double own, double all, int supports) {
  return all > 0.0 ? own / all : 1.0 / supports;
}

}  // namespace

/// The data that the reactions of a model need.
class Reactions::Reader {
 public:
  Reader(const scenario::Scene& scene, const Model& model, std::optional<std::size_t> only);

  const std::vector<Reaction>& evaluate(const Model& model, const State& state);

 private:
  /// A spring against turning, at a place where those of several supports may act together.
  struct Turning {
    std::size_t place = 0;  // in RodMesh::moment_places; in space in `section_springs`
    Vec3 share = Vec3::Zero();
  };
  /// A place of a support; its number is that of its reaction.
  struct Place {
    std::size_t rod = 0;
    std::vector<Weighted> nodes;  // whose weighted sum is the point
    std::vector<HeldDof> held;
    Index clamp = -1;               // number among those of the rod
    Vec3 stiffness = Vec3::Zero();  // of a spring to the anchor [N/m]
    Vec3 anchor = Vec3::Zero();     // [m]
    std::optional<Turning> turning;
    Index rotation = -1;              // degree of freedom of a joint's rotation that it holds
    double rotational_stiffness = 0;  // of springs on that rotation, which it does not hold
    std::optional<SpatialJointSpring::Constants> joint_spring;  // the same in space
  };

  void add_place(const scenario::Scene& scene, std::size_t number, double s, const Model& model);
  void add_spring(const scenario::Scene& scene, std::size_t number, double s, const Model& model,
                  Place& place) const;
  static void add_bearing(double s, const RodMesh& rod, Place& place);
  [[nodiscard]] static std::vector<HeldDof> held_by(const scenario::Support& support, Index node,
                                                    const Model& model);
  /// Where the moment of a clamp is summed: its number among all of the model.
  [[nodiscard]] std::size_t clamp_number(std::size_t rod, const Clamp& clamp,
                                         const Model& model) const;
  void choose_elements(const Model& model);

  void add_elements(const Model& model, const State& state);
  /// A force [N] that acts at a clamp's pivot rather than at its node, whose first degree of
  /// freedom is `dof`.
  template <class PivotKind, class Force>
  void add_at_pivot(const PivotKind& pivot, Index dof, const Force& force);
  template <class Kernel>
  void add_pivots(const Kernel& kernel, const typename Kernel::Constants& constants,
                  const std::array<Index, Kernel::kDofs>& dofs,
                  const Eigen::Matrix<double, Kernel::kDofs, 1>& gradient);
  void add_vertices(const Model& model, const State& state);
  void add_planar_moments(std::size_t rod, const Model& model, const State& state);
  void add_spatial_moments(std::size_t rod, const Model& model, const State& state);
  void add_gyroscopic_forces(const Model& model, const State& state);
  [[nodiscard]] Vec3 turning_moment(const Place& place, const Model& model,
                                    const State& state) const;
  [[nodiscard]] Mat3 axes_of_springs(const SectionSpringPlace& place, const Model& model) const;

  HeldMotion motion_;
  std::vector<Place> places_;
  std::vector<Reaction> reactions_;
  std::vector<SpreadMoments> spread_;      // in space, of each rod
  std::vector<std::size_t> first_clamps_;  // number of each rod's first clamp
  std::vector<Index> clamp_at_;            // of each degree of freedom: the clamp of its node; -1
  ActingElements elements_;
  // At the state.
  Configuration here_;
  Vector force_;
  Vector turn_rates_;
  Vector gradient_;            // on held degrees of freedom that are read
  std::vector<Vec3> moments_;  // of clamps
  CirculatoryTerm term_;
};

Reactions::Reader::Reader(const scenario::Scene& scene, const Model& model,
                          std::optional<std::size_t> only)
    : motion_(scene), clamp_at_(to_size(model.num_dofs()), -1) {
  std::size_t clamps = 0;
  for (const RodMesh& rod : model.rods) {
    if (model.has_sections()) spread_.emplace_back(rod, model);
    first_clamps_.push_back(clamps);
    for (const Clamp& clamp : rod.clamps) {
      clamp_at_[to_size(model.dof(rod.node(clamp.place), 0))] = static_cast<Index>(clamps++);
    }
  }
  moments_.resize(clamps);
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    if (only && *only != i) continue;
    const scenario::Support& support = scene.supports[i];
    const RodMesh& rod = model.rod(support.rod);
    for (const double s : arc_lengths_of(support.at, rod)) add_place(scene, i, s, model);
  }
  choose_elements(model);
}

void Reactions::Reader::add_place(const scenario::Scene& scene, std::size_t number, double s,
                                  const Model& model) {
  const scenario::Support& support = scene.supports[number];
  const RodMesh& rod = model.rod(support.rod);
  Place place;
  place.rod = static_cast<std::size_t>(&rod - model.rods.data());
  place.nodes = node_weights(rod, s, model);
  if (support.holds()) {
    const Index node = place.nodes.front().place;
    place.held = held_by(support, rod.node(node), model);
    if (const Index rotation = rod.rotation_at(node); support.clamps() && rotation >= 0) {
      place.rotation = model.dofs.rotation(rotation);
    }
    if (const Clamp* clamp = rod.clamp_at(node); support.clamps() && clamp != nullptr) {
      place.clamp = static_cast<Index>(clamp - rod.clamps.data());
    }
    if (is_bearing(support, node, rod, model)) add_bearing(s, rod, place);
  }
  if (support.spring) add_spring(scene, number, s, model, place);
  places_.push_back(std::move(place));
  Reaction reaction;
  reaction.support = number;
  reaction.rod = rod.name;
  reaction.arc_length = s;
  reactions_.push_back(std::move(reaction));
}

std::vector<HeldDof> Reactions::Reader::held_by(const scenario::Support& support, Index node,
                                                const Model& model) {
  std::vector<HeldDof> held;
  for (int c = 0; c < model.dimension; ++c) {
    const Index dof = model.dof(node, c);
    const auto component = static_cast<scenario::Component>(c);
    const bool fixed =
        std::find(support.fix.begin(), support.fix.end(), component) != support.fix.end();
    const auto motion =
        std::find_if(support.prescribe.begin(), support.prescribe.end(),
                     [&](const auto& prescribed) { return prescribed.component == component; });
    if (!support.clamps(component) && !fixed && motion == support.prescribe.end()) continue;
    const auto known = std::find_if(model.held.begin(), model.held.end(),
                                    [&](const HeldDof& other) { return other.dof == dof; });
    if (known != model.held.end()) held.push_back(*known);
  }
  return held;
}

void Reactions::Reader::add_spring(const scenario::Scene& scene, std::size_t number, double s,
                                   const Model& model, Place& place) const {
  const RodMesh& rod = model.rods[place.rod];
  const scenario::Spring& spring = *scene.supports[number].spring;
  for (std::size_t c = 0; c < std::min(spring.stiffness.size(), to_size(model.dimension)); ++c) {
    const auto axis = static_cast<Index>(c);
    place.stiffness[axis] = spring.stiffness[c];
    for (const auto& [node, weight] : place.nodes) {
      place.anchor[axis] +=
          weight * model.initial_positions[model.dof(rod.node(node), static_cast<int>(c))];
    }
    if (!spring.anchor.empty()) place.anchor[axis] = spring.anchor[c];
  }
  if (spring.rotational_stiffness.empty()) return;
  if (!rod.legs.empty()) {
    place.rotation = model.dofs.rotation(rod.rotation_at(place.nodes.front().place));
    if (model.dimension == 3) {
      place.joint_spring = joint_spring(spring, s, rod, model);
    } else {
      place.rotational_stiffness = spring.rotational_stiffness[0];
    }
    return;
  }
  const auto is_here = [&](const auto& other) {
    return std::abs(other.arc_length - s) <= rod.same_place();
  };
  int supports = 0;
  for (const scenario::Support& other : scene.supports) {
    if (other.rod != rod.name || !other.spring || other.spring->rotational_stiffness.empty()) {
      continue;
    }
    if (std::abs(arc_length_of(other.at, rod) - s) <= rod.same_place()) ++supports;
  }
  Turning turning;
  if (model.dimension == 2) {
    const auto found = std::find_if(rod.moment_places.begin(), rod.moment_places.end(), is_here);
    turning.place = static_cast<std::size_t>(found - rod.moment_places.begin());
    turning.share.z() = share_of(spring.rotational_stiffness[0], found->stiffness, supports);
  } else {
    const auto found =
        std::find_if(rod.section_springs.begin(), rod.section_springs.end(), is_here);
    if (found == rod.section_springs.end()) return;
    turning.place = static_cast<std::size_t>(found - rod.section_springs.begin());
    for (Index axis = 0; axis < 3; ++axis) {
      turning.share[axis] =
          share_of(spring.rotational_stiffness[to_size(axis)], found->stiffness[axis], supports);
    }
  }
  place.turning = turning;
}

/// Its springs are so much stiffer than others there that they have all of the moment across.
void Reactions::Reader::add_bearing(double s, const RodMesh& rod, Place& place) {
  const SectionSpringPlace* found = rod.section_spring_at(s);
  if (found == nullptr) return;
  place.turning =
      Turning{static_cast<std::size_t>(found - rod.section_springs.data()), Vec3(1.0, 1.0, 0.0)};
}

std::size_t Reactions::Reader::clamp_number(std::size_t rod, const Clamp& clamp,
                                            const Model& model) const {
  return first_clamps_[rod] + static_cast<std::size_t>(&clamp - model.rods[rod].clamps.data());
}

/// Those that act on the held nodes, and on those of clamps that are free to move: the others add
/// nothing.
void Reactions::Reader::choose_elements(const Model& model) {
  std::vector<bool> read(to_size(model.num_dofs()), false);
  for (const Place& place : places_) {
    for (const HeldDof& held : place.held) read[to_size(held.dof)] = true;
    for (int c = 0; place.clamp >= 0 && c < model.dimension; ++c) {
      const Index node = model.rods[place.rod].node(place.nodes.front().place);
      read[to_size(model.dof(node, c))] = true;
    }
    for (Index c = 0; place.rotation >= 0 && c < (model.dimension == 3 ? 3 : 1); ++c) {
      read[to_size(place.rotation + c)] = true;
    }
  }
  elements_ = ActingElements(model, [&](Index dof) { return read[to_size(dof)]; });
}

template <class PivotKind, class Force>
void Reactions::Reader::add_at_pivot(const PivotKind& pivot, Index dof, const Force& force) {
  const Index clamp = clamp_at_[to_size(dof)];
  if (pivot.distance == 0.0 || clamp < 0) return;
  moments_[to_size(clamp)] += in_space(pivot.offset(here_.controls)).cross(in_space(force));
}

/// Adds the gradient of an element to the clamps beside it: its force acts at the pivot.
template <class Kernel>
void Reactions::Reader::add_pivots(const Kernel& /*kernel*/,
                                   const typename Kernel::Constants& constants,
                                   const std::array<Index, Kernel::kDofs>& dofs,
                                   const Eigen::Matrix<double, Kernel::kDofs, 1>& gradient) {
  if constexpr (IsSectionSpring<Kernel>::value) {
    // Each edge has opposite forces at its ends.
    constexpr Index last_node = Kernel::kNodes - 1;
    for (std::size_t i = 0; i < constants.edges.size(); ++i) {
      const Vec3 at_start = i == 0 ? Vec3(gradient.template head<3>())
                                   : Vec3(-gradient.template segment<3>(3 * last_node));
      add_at_pivot(constants.edges[i].first, dofs[3 * i], at_start);
      add_at_pivot(constants.edges[i].last, dofs[3 * i + 3], Vec3(-at_start));
    }
  } else if constexpr (StartsFromPivot<Kernel>::value) {
    constexpr int dimension = decltype(constants.first)::kDimension;
    constexpr int last = dimension * (Kernel::kNodes - 1);
    add_at_pivot(constants.first, dofs[0],
                 Eigen::Matrix<double, dimension, 1>(gradient.template head<dimension>()));
    add_at_pivot(constants.last, dofs[to_size(last)],
                 Eigen::Matrix<double, dimension, 1>(gradient.template segment<dimension>(last)));
  }
}

/// Sums the forces of the elements and, from those beside clamps, how their energy changes as what
/// a clamp holds turns.
void Reactions::Reader::add_elements(const Model& model, const State& state) {
  gradient_.setZero(model.num_dofs());
  std::fill(moments_.begin(), moments_.end(), Vec3::Zero());
  const auto add = [&](auto kernel, const auto& constants, const auto& dofs,
                       const auto& coordinates, const auto& gradient) {
    using Kernel = decltype(kernel);
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      gradient_[dofs[i]] += gradient[static_cast<Index>(i)];
    }
    add_pivots(kernel, constants, dofs, gradient);
    if constexpr (StartsFromPivot<Kernel>::value) {
      if constexpr (IsPlanarClamp<typename StartsFromPivot<Kernel>::Element>::value) {
        // The cell turns with the edge as it does against the held tangent.
        const auto moved = Kernel::from_pivots(constants, here_.controls, coordinates);
        const Vec3 along = in_space(Vec2(moved.template tail<2>() - moved.template head<2>()));
        const Index clamp = clamp_at_[to_size(constants.element.side > 0.0 ? dofs[0] : dofs[2])];
        moments_[to_size(clamp)] -= along.cross(in_space(Vec2(gradient.template tail<2>())));
      }
    }
  };
  elements_.for_each_gradient(model, here_, add);
  if (model.viscous) {
    set_turn_rates(model, state, turn_rates_);
    elements_.for_each_viscous_gradient(model, {here_, state.velocities, turn_rates_}, add);
  }
  add_circulatory_forces(model.elements->circulatory, here_, -1.0, gradient_);
}

/// Cells beside clamps in space: their moment acts on the held section.
void Reactions::Reader::add_vertices(const Model& model, const State& state) {
  for (std::size_t i = 0; i < model.rods.size(); ++i) {
    const RodMesh& rod = model.rods[i];
    for (const RodVertex& vertex : rod.vertices) {
      if (vertex.clamp < 0) continue;
      const Vec3 moment = cell_moment(vertex, rod, model, state);
      Vec3& sum = moments_[first_clamps_[i] + to_size(vertex.clamp)];
      sum += vertex.after >= 0 ? Vec3(-moment) : moment;
    }
  }
}

/// A moment beside a clamp acts in part on the edge; the clamp takes the rest of it.
void Reactions::Reader::add_planar_moments(std::size_t rod_number, const Model& model,
                                           const State& state) {
  const RodMesh& rod = model.rods[rod_number];
  for (const MomentPlace& place : rod.moment_places) {
    const auto beside = place_beside_clamp(rod, place.arc_length);
    if (!beside) continue;
    double applied = 0.0;
    for (const Index moment : place.moments) applied += here_.controls[moment];
    const double carried = carried_moment(place, rod, model, state, applied);
    const Clamp& clamp = rod.clamps[to_size(beside->clamp)];
    moments_[clamp_number(rod_number, clamp, model)].z() -= (1.0 - beside->share()) * carried;
  }
}

void Reactions::Reader::add_spatial_moments(std::size_t rod_number, const Model& model,
                                            const State& state) {
  const RodMesh& rod = model.rods[rod_number];
  const SpreadMoments& spread = spread_[rod_number];
  for (std::size_t i = 0; i < spread.size(); ++i) {
    const auto beside = place_beside_clamp(rod, spread[i].arc_length);
    if (!beside) continue;
    const EdgeMoments value = spread.value(i, model, state);
    moments_[first_clamps_[rod_number] + to_size(beside->clamp)] -=
        value.whole - value.on_edge[0] - value.on_edge[1];
  }
  for (const SpatialMomentPlace& place : rod.spatial_moments) {
    const CirculatoryLoad& load = model.elements->circulatory[to_size(place.load)];
    load.evaluate(here_, term_);
    const auto edges = load.turned_edges();
    for (std::size_t k = 0; k < edges.size() && edges[k] != nullptr; ++k) {
      const SpatialEdge& edge = edges[k]->edge;
      const Vec3 at_end = term_.force.segment<3>(4 * static_cast<Index>(k));
      add_at_pivot(edge.first, edge.start, at_end);
      add_at_pivot(edge.last, edge.end, Vec3(-at_end));
    }
  }
}

/// An edge beside a clamp turns with the pivot, whose velocity the equations of motion leave out
/// (model/spin.hpp): the clamp bears the part of the couple that they have for it, since the
/// edge's angular momentum does not change by that.
void Reactions::Reader::add_gyroscopic_forces(const Model& model, const State& state) {
  const auto rate = [&](Index dof) { return state.velocities[dof]; };
  const auto force = [&](const SpatialEdge& edge, Index /*number*/, const Vec3& vector) {
    const Vec3 pair = gyroscopic_force(edge, vector, model.mass, rate);
    const double spin = model.mass.lumped[edge.theta] * state.velocities[edge.theta];
    const auto add_at_clamp = [&](const SpatialPivot& pivot, Index dof, double side) {
      add_at_pivot(pivot, dof, Vec3(side * pair));
      const Index clamp = clamp_at_[to_size(dof)];
      if (clamp < 0 || pivot.held.rotation < 0) return;
      const double turning = motion_.turning_rate(pivot.held.rotation, model, state);
      const Vec3 velocity = turning * pivot.held.axis.cross(pivot.offset(here_.controls));
      moments_[to_size(clamp)] +=
          vector.cross(gyroscopic_force<double>(vector, side * velocity, spin));
    };
    add_at_clamp(edge.first, edge.start, 1.0);
    add_at_clamp(edge.last, edge.end, -1.0);
    return pair;
  };
  take_pairs(model, here_, force, gradient_);
}

/// The moment [N m] of the springs against turning of one support.
Vec3 Reactions::Reader::turning_moment(const Place& place, const Model& model,
                                       const State& state) const {
  const RodMesh& rod = model.rods[place.rod];
  const auto& [number, share] = *place.turning;
  if (model.dimension == 2) {
    const MomentPlace& there = rod.moment_places[number];
    double applied = 0.0;
    for (const Index moment : there.moments) applied += here_.controls[moment];
    return share.cwiseProduct(
        Vec3(0.0, 0.0, carried_moment(there, rod, model, state, applied) - applied));
  }
  const SectionSpringPlace& springs = rod.section_springs[number];
  const std::size_t spring = rod.spatial_moments.size() + number;
  Vec3 whole = spread_[place.rod].value(spring, model, state).whole;
  Mat3 axes = axes_of_springs(springs, model);
  for (const SpatialMomentPlace& load : rod.spatial_moments) {
    if (rod.section_spring_at(load.arc_length) != &springs) continue;
    const CirculatoryLoad& moment = model.elements->circulatory[to_size(load.load)];
    whole += moment.taken_by_springs(here_);
    axes = moment.axes_of_springs(here_).value_or(axes);  // those of the last have all moments
  }
  return axes * share.cwiseProduct(axes.partialPivLu().solve(whole));
}

Mat3 Reactions::Reader::axes_of_springs(const SectionSpringPlace& place, const Model& model) const {
  const auto of_list = [&](auto kernel) -> Mat3 {
    using Kernel = decltype(kernel);
    const auto& list = elements_of<Kernel>(*model.elements);
    const std::size_t element = to_size(place.element);
    return Kernel::axes_of_springs(list.constants[element], here_,
                                   gather(list.dofs[element], here_.coordinates));
  };
  return place.on_one_edge ? of_list(SectionSpring<1>{}) : of_list(SectionSpring<2>{});
}

const std::vector<Reaction>& Reactions::Reader::evaluate(const Model& model, const State& state) {
  configuration_of(model, state, here_);
  external_force(model, here_, state.extra_force, force_);
  motion_.evaluate(model, state);
  add_elements(model, state);
  add_gyroscopic_forces(model, state);
  add_vertices(model, state);
  for (std::size_t rod = 0; rod < model.rods.size(); ++rod) {
    add_planar_moments(rod, model, state);
    if (model.has_sections()) add_spatial_moments(rod, model, state);
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place& place = places_[i];
    Reaction& reaction = reactions_[i];
    const RodMesh& rod = model.rods[place.rod];
    reaction.point.setZero();
    for (const auto& [node, weight] : place.nodes) {
      reaction.point.head(model.dimension) +=
          weight * state.positions.segment(model.dof(rod.node(node), 0), model.dimension);
    }
    reaction.force = -place.stiffness.cwiseProduct(reaction.point - place.anchor);
    for (const HeldDof& held : place.held) {
      const auto [velocity, acceleration] = motion_.of(held, state);
      reaction.force[held.dof - model.dof(rod.node(place.nodes.front().place), 0)] +=
          model.mass.lumped[held.dof] * acceleration + model.damping[held.dof] * velocity +
          gradient_[held.dof] - force_[held.dof];
    }
    reaction.moment.setZero();
    if (place.clamp >= 0)
      reaction.moment = moments_[first_clamps_[place.rod] + to_size(place.clamp)];
    if (place.rotational_stiffness > 0.0) {
      reaction.moment.z() = -place.rotational_stiffness * state.positions[place.rotation];
    } else if (place.joint_spring) {
      const JointTurn turn(place.joint_spring->section.joint, here_.controls,
                           state.positions.segment<3>(place.rotation));
      reaction.moment = -SpatialJointSpring::respond<false>(*place.joint_spring, turn).moment;
    } else if (place.rotation >= 0 && model.dimension == 3) {
      reaction.moment = gradient_.segment<3>(place.rotation) - force_.segment<3>(place.rotation);
    } else if (place.rotation >= 0) {
      reaction.moment.z() = gradient_[place.rotation] - force_[place.rotation];
    }
    if (place.turning) reaction.moment += turning_moment(place, model, state);
  }
  return reactions_;
}

Reactions::Reactions(const scenario::Scene& scene, const Model& model,
                     std::optional<std::size_t> only)
    : reader_(std::make_unique<Reader>(scene, model, only)) {}

Reactions::~Reactions() = default;

const std::vector<Reaction>& Reactions::evaluate(const Model& model, const State& state) {
  return reader_->evaluate(model, state);
}

}  // namespace der
