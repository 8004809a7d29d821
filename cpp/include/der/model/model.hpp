#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "der/core/pimpl.hpp"
#include "der/core/types.hpp"
#include "der/energies/damping_times.hpp"
#include "der/kinematics/actuated_turn.hpp"
#include "der/kinematics/held_frame.hpp"
#include "der/kinematics/material_curvature.hpp"
#include "der/model/actuated_stretch.hpp"
#include "der/model/dof_map.hpp"
#include "der/model/edge.hpp"
#include "der/model/followed.hpp"
#include "der/model/frames.hpp"
#include "der/model/leg.hpp"
#include "der/model/load_variation.hpp"
#include "der/model/mass.hpp"
#include "der/model/named_control.hpp"
#include "der/model/natural_strain.hpp"
#include "der/model/time_tables.hpp"
#include "der/scenario/curvature_measure.hpp"

namespace der {

struct Model;
struct ElementLists;  // energies/registry.hpp

/// A node of a rod whose tangent is held.
struct Clamp {
  Index place = 0;            ///< position in RodMesh::nodes
  double direction = 0.0;     ///< initial angle of the held tangent [rad], in a plane
  Index rotation = -1;        ///< control that turns it [rad]; -1: none
  Index followed = -1;        ///< place in Model::followed_edges of the edge beside it, if it turns
  HeldFrame held;             ///< in space
  bool holds_section = true;  ///< in space: against turning about the tangent, too
};

/// A place at which a rod in space bends and twists: an inner node, or a cell beside a clamp.
struct RodVertex {
  Index before = -1;          ///< its edge before, in the rod; -1: a clamp
  Index after = -1;           ///< its edge after; -1: a clamp
  Index clamp = -1;           ///< the clamp's number among those of the rod; -1: an inner node
  double bend_place = 0.0;    ///< arc length [m] at which it bends
  double bend_length = 0.0;   ///< [m] over which it does
  double twist_place = 0.0;   ///< arc length [m] at which it twists
  double twist_length = 0.0;  ///< [m] over which it does
  /// Angle [rad] by which the section after it was turned when it was glued to the one before:
  /// at the closing vertex of a ring. No strain counts it.
  double glued = 0.0;
  MaterialCurvature rest;
  /// The place of its node: of the vertex that closes a ring, the number of nodes.
  [[nodiscard]] Index place() const { return before >= 0 ? before + 1 : after; }
  /// Whether it is the cell between a clamp and the edge that leaves it.
  [[nodiscard]] bool leaves_clamp() const { return clamp >= 0 && after >= 0; }
  Vec2 natural_curvature = Vec2::Zero();  ///< towards the two directors [1/m]
};

/// The two halves of the cell about a node, on the edge before it and on the one after, where their
/// sections differ: at a corner, and where a ring is glued turned. Each adds its own part to the
/// strains of the vertex. Each matrix takes the strains of a half to those of the vertex.
struct CellHalves {
  Index place = 0;  ///< of the node
  Mat3 before = Mat3::Identity();
  Mat3 after = Mat3::Identity();
};

/// A place at which moments act on a rod's tangent: those of loads, those of springs against
/// turning, or both (model/moment_place.hpp).
struct MomentPlace {
  double arc_length = 0.0;  ///< [m]
  /// The edges whose directions the moments turn, from this one on: one, or two neighbours.
  Index first_edge = 0;
  std::vector<double> weights;  ///< of these directions, adding up to 1
  double cell_length = 0.0;     ///< c [m]: they turn against the tangent by c/EI times the moment
  std::vector<Index> moments;   ///< controls of the loads [N m]
  double stiffness = 0.0;       ///< of the springs together [N m/rad]
  Index spring = -1;            ///< number of their element in its list; -1: no spring
  Index followed = -1;          ///< place in Model::followed_edges of the first edge, with a spring
  NaturalStrainOffset spring_shift;  ///< of the springs by actuations
  ActuatedTurn actuated;             ///< of the tangent there, beyond these edges

  /// Stiffness of springs and cell in series against that of the springs, 1/(1 + k c/EI); the part
  /// of the loads' moments that turns the edges.
  [[nodiscard]] double series_share(double EI) const {
    return stiffness == 0.0 ? 1.0 : 1.0 / (1.0 + stiffness * cell_length / EI);
  }
};

/// A place at which a point force acts on a rod, of a load or of a spring to an anchor.
struct ForcePlace {
  double arc_length = 0.0;  ///< [m]
  /// Controls of the load [N]; -1: there is none, or it is constant and at a node, or planar.
  std::array<Index, 3> force{-1, -1, -1};
  Vec3 stiffness = Vec3::Zero();  ///< of the spring [N/m]; planar: z is 0
  Vec3 anchor = Vec3::Zero();     ///< [m]
  Index follower = -1;  ///< of a load that turns with the rod: number in ElementLists::circulatory
};

/// A place at which the moment of a load acts on a rod in space.
struct SpatialMomentPlace {
  double arc_length = 0.0;  ///< [m]
  Index load = 0;           ///< number in ElementLists::circulatory
  ActuatedTurn actuated;    ///< of the section there, beyond the edges that the load turns
};

/// A place at which springs hold the section of a rod in space against turning.
struct SectionSpringPlace {
  double arc_length = 0.0;        ///< [m]
  Vec3 stiffness = Vec3::Zero();  ///< towards the two directors, about the tangent [N m/rad]
  Index element = -1;             ///< number of their element in its list
  bool on_one_edge = false;       ///< SectionSpring<1>; else <2>
  NaturalStrainOffset shift;      ///< by actuations
};

/// A part of a rod on which a distributed force acts.
struct DistributedPlace {
  double from = 0.0, to = 0.0;             ///< rest arc length [m]
  std::array<Index, 3> force{-1, -1, -1};  ///< controls of the load [N/m]
};

/// A part of a rod under which there is an elastic foundation.
struct FoundationPlace {
  double from = 0.0, to = 0.0;    ///< rest arc length [m]
  Vec3 stiffness = Vec3::Zero();  ///< [N/m^2] along the axes; planar: z is 0
};

/// A node at which a curvature or the twist jumps without a corner: where a straight leg runs into
/// an arc, or one arc into another (model/curvature_jump.hpp).
struct CurvatureJump {
  Index place = 0;  ///< position in RodMesh::nodes
  /// The vector about which the rod turns, after the node less before it [1/m], on the drawn rod.
  Vec3 turn = Vec3::Zero();
};

/// Where the nodes and edges of one rod are in the model, and what is known of it for probes and
/// drawings. Only the builder assumes that a rod is a chain; everybody else reads these lists.
///
/// A closed rod, a ring, has as many edges as nodes: the last edge leads back to the first node.
/// Places along it, which number its nodes, and edges are counted on beyond its end and before its
/// start: of n nodes place n is place 0, one length of the ring further on.
struct RodMesh {
  std::string name;
  bool closed = false;
  std::vector<Index> nodes;         ///< in the order of the arc length
  std::vector<double> arc_length;   ///< rest arc length of each node [m]
  std::vector<double> edge_length;  ///< rest length of each edge [m]
  double EA = 0.0;                  ///< [N]
  double EI = 0.0;                  ///< [N m^2], in the plane
  double EI_1 = 0.0;                ///< [N m^2] towards the first director, in space
  double EI_2 = 0.0;                ///< [N m^2] towards the second director, in space
  double GJ = 0.0;                  ///< [N m^2]
  double spin_inertia = 0.0;        ///< about the tangent, per length [kg m]
  double mass_per_length = 0.0;     ///< [kg/m] without spheres
  DampingTimes damping;             ///< internal
  scenario::CurvatureMeasure curvature = scenario::CurvatureMeasure::Angle;
  Index first_edge = 0;  ///< number of its first edge among those of the model
  /// Section frame [-] of each drawn edge at its middle, in space.
  std::vector<SectionFrame> initial_frames;
  /// Director 1 of a rod in a plane: components along the normal z x t of the rod, and along z.
  Vec2 director = Vec2::UnitY();
  double initial_twist = 0.0;            ///< of these frames [rad/m]
  std::vector<Vec2> natural_curvatures;  ///< towards the two directors, at each node [1/m]
  std::vector<double> natural_twist;     ///< at each node [rad/m]; empty: stress-free as drawn
  /// The vertices of a rod in space that bends, from its start to its end; the one between the last
  /// edge of a ring and its first one stands last.
  std::vector<RodVertex> vertices;
  std::vector<CellHalves> cell_halves;  ///< of the vertices whose halves differ
  /// Natural curvature of a planar rod at each node [1/m]; empty: the initial shape is stress-free.
  std::vector<double> natural_curvature;
  /// Places of the corners of a rod whose drawn curve is known, ascending; absent: guessed.
  std::optional<std::vector<Index>> drawn_corners;
  std::vector<CurvatureJump> reference_jumps;  ///< of the curvature of the drawn shape, ascending
  /// Jumps of the natural curvature and twist, and so of those of any equilibrium, ascending.
  std::vector<CurvatureJump> natural_jumps;
  /// Natural turning angle at each node that bends [rad], at clamped ones of the clamp's cells; 0
  /// at free ends.
  std::vector<double> rest_turning_angle;
  std::vector<Leg> legs;                   ///< of a rod in a scene with joints; else none
  std::vector<Clamp> clamps;               ///< none on a rod that does not bend, or has legs
  std::vector<MomentPlace> moment_places;  ///< no two at the same place
  std::vector<ForcePlace> force_places;    ///< of forces at single places
  /// Whether single forces act on each node, of supports, loads or spheres: strain may jump there.
  std::vector<bool> bears_force;
  /// Whether places on both sides of each node have no nodes in common but this (node_weights).
  std::vector<bool> divides_places;
  std::vector<SpatialMomentPlace> spatial_moments;
  std::vector<SectionSpringPlace> section_springs;  ///< no two at the same place
  std::vector<DistributedPlace> distributed_places;
  std::vector<FoundationPlace> foundation_places;
  std::vector<ActuatedStretch> actuated_stretches;  ///< in the order of the scene
  NaturalStrainEntries natural_strain_entries;
  double draw_radius = 0.0;           ///< half the height of the section [m]; 0 if not known
  std::vector<double> sphere_radius;  ///< per node [m]; 0: no sphere

  [[nodiscard]] double rest_length() const { return arc_length.back() + closing_length(); }
  /// Two arc lengths [m] closer than this are the same place.
  [[nodiscard]] double same_place() const { return 1e-9 * rest_length(); }
  [[nodiscard]] Index num_edges() const { return static_cast<Index>(edge_length.size()); }
  /// Length [m] of the edge from the last node of a ring to the first; 0 of an open rod.
  [[nodiscard]] double closing_length() const { return closed ? edge_length.back() : 0.0; }
  /// The position in `nodes` of a place; any number of a ring, of an open rod only these.
  [[nodiscard]] Index position(Index place) const;
  /// The node at a place.
  [[nodiscard]] Index node(Index place) const {
    return nodes[static_cast<std::size_t>(position(place))];
  }
  /// Rest arc length [m] of a place.
  [[nodiscard]] double arc_length_at(Index place) const;
  /// The edge that arrives at a place; -1: none does.
  [[nodiscard]] Index edge_before(Index place) const {
    return closed ? position(place - 1) : place - 1;
  }
  /// The edge that leaves a place; -1: none does.
  [[nodiscard]] Index edge_after(Index place) const {
    return closed ? position(place) : (place < num_edges() ? place : -1);
  }
  /// Whether two edges meet at a place.
  [[nodiscard]] bool is_inner(Index place) const {
    return edge_before(place) >= 0 && edge_after(place) >= 0;
  }
  /// Rest arc length [m] of the middle of an edge.
  [[nodiscard]] double edge_middle(Index edge) const;
  /// Voronoi length [m]: the rod's part that is nearer to this node than to another.
  [[nodiscard]] double voronoi_length(Index node) const;
  /// The halves of the cell about a place; each is the identity where they do not differ.
  [[nodiscard]] CellHalves cell_halves_at(Index place) const;
  [[nodiscard]] Edge edge(Index number, const Model& model) const;
  /// Degrees of freedom (x, y of both ends) of an edge of a planar model.
  [[nodiscard]] std::array<Index, 4> edge_dofs(Index edge, const Model& model) const;
  /// Number of the joint's rotation that the rod's tangent follows at a node; -1: there is none.
  [[nodiscard]] Index rotation_at(Index place) const;
  /// Null if the tangent at that place is free.
  [[nodiscard]] const Clamp* clamp_at(Index place) const;
  /// Places at which moments act, of loads and of springs against turning [m].
  [[nodiscard]] std::vector<double> moment_arc_lengths() const;
  /// The place of a planar rod's moments at an arc length [m]; null if none act there.
  [[nodiscard]] const MomentPlace* moment_place_at(double s) const;
  /// The springs against turning in space at arc length `s` [m]; null: there are none.
  [[nodiscard]] const SectionSpringPlace* section_spring_at(double s) const;
};

/// A prescribed degree of freedom: its value is the initial one plus `weight` times a control.
struct HeldDof {
  Index dof = 0;
  Index displacement = -1;  ///< control that holds the displacement [m]; -1: none
  double weight = 1.0;      ///< of a joint in space: the component of the axis about which it turns
};

/// A control that moves what a support prescribes.
struct PrescribedControl {
  std::size_t support = 0;  ///< its number in the scene
  std::string component;    ///< "x", "y", "z", "angle" or "twist"
  Index control = 0;
};

/// weight * control[i] acts as a force on one degree of freedom.
struct ControlledForce {
  Index dof = 0;
  Index control = 0;
  double weight = 1.0;
};

/// Everything that stays constant in a run. It is const once it is built, so that simulations in
/// several threads can share it. Vectors have one entry a degree of freedom, in the order of
/// `dofs`.
struct Model {
  std::string name;    ///< "planar", "spatial_bend" or "spatial"
  std::string reason;  ///< why this model, in words
  int dimension = 2;
  /// Whether it is smaller than `spatial` and was chosen by `auto` for a scene of three components:
  /// it then has the quantities of space, too (catalog/quantities.hpp).
  bool stands_for_space = false;
  Index num_nodes = 0;
  DofMap dofs;
  std::vector<RodMesh> rods;

  /// [m] The shape as drawn, at which runs start and from which displacements count.
  Vector initial_positions;
  /// [m] The same shape with each edge at its rest length: the reference of all elements. Each rod
  /// is magnified about its first node, and stays as drawn without a `rest_length`.
  Vector reference_positions;
  Vector initial_velocities;  ///< [m/s]
  Mass mass;
  Vector damping;       ///< [N s/m], one entry a degree of freedom: drag and linear damping
  bool damped = false;  ///< whether any of that is there
  std::vector<Index> driven_hinges;  ///< the controls of their angles [rad]
  std::vector<Index> rest_lengths;   ///< the controls of those of springs between joints [m]
  bool viscous = false;              ///< whether any rod has internal damping (ElementList::damped)
  Vector gravity_force;              ///< [N] constant weight without buoyancy
  /// Controls of the acceleration of gravity [m/s^2], where it follows any; its weight is then
  /// among the controlled forces (model/gravity.hpp). -1: there is none, or it is constant.
  std::array<Index, 3> gravity_controls{-1, -1, -1};
  Vector dead_force;             ///< [N] every constant force but weight: buoyancy, constant loads
  NaturalStrain natural_strain;  ///< what actuations make of the rest shape
  TimeTables tables;             ///< tables over time that forces, supports and actuations follow
  /// If the scene varies its loads or motions: their dependence on the load factor. It replaces
  /// `gravity_force`, `dead_force` and `tables` for states whose factor is not 1.
  std::optional<LoadVariation> load_variation;
  std::vector<ControlledForce> controlled_forces;

  std::vector<HeldDof> held;
  std::vector<PrescribedControl> prescribed;  ///< of all supports, in their order
  std::vector<NamedControl> named;            ///< what programs can set by its name

  std::vector<Edge> edges;  ///< of all rods
  std::vector<FollowedEdge> followed_edges;
  std::vector<SpatialEdge> framed_edges;      ///< all edges, if they have section frames; or none
  std::vector<FramedVertex> framed_vertices;  ///< of these
  Vector initial_frames;                      ///< blocks of these in the initial shape
  Pimpl<ElementLists> elements;

  /// Whether a program may set a control in place of its table.
  [[nodiscard]] bool can_set(Index control) const;
  [[nodiscard]] Index num_dofs() const { return dofs.size(); }
  [[nodiscard]] Index num_free() const { return dofs.num_free(); }
  /// Whether edges have angles of their sections as degrees of freedom.
  [[nodiscard]] bool has_sections() const { return dofs.num_angles() > 0; }
  /// Whether it has joints with rotations of their own, which have no mass.
  [[nodiscard]] bool has_rotations() const { return dofs.num_rotations() > 0; }
  /// The largest extent of the initial shape [m]: the length against which steps are small.
  [[nodiscard]] double size() const { return dofs.length(); }
  [[nodiscard]] Index dof(Index node, int component) const {
    return dofs.position(node, component);
  }
  /// Throws Error if there is no rod of that name.
  [[nodiscard]] const RodMesh& rod(const std::string& rod_name) const;
  [[nodiscard]] RodMesh& rod(const std::string& rod_name);
};

/// A node by its place in a rod.
struct NodePlace {
  std::string rod;  ///< the first rod that has it; empty if none does
  Index place = 0;  ///< position in RodMesh::nodes
};
NodePlace place_of(const Model& model, Index node);

/// Number in Model::followed_edges of an edge of `rod`, which is followed from now on.
Index follow_edge(const RodMesh& rod, Index edge, Model& model);

/// Where the controls have what actuations add to the rest strains of a vertex.
NaturalStrainOffset natural_strain_offset(const RodMesh& rod, const RodVertex& vertex);

/// A vector over the free degrees of freedom as one over all, zero on held ones.
Vector over_all_dofs(const Model& model, const Vector& free);

/// "node 3 of rod 'beam' (y)"
std::string describe_dof(const Model& model, Index dof);

}  // namespace der
