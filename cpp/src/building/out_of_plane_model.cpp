#include "der/building/out_of_plane_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "der/building/builder.hpp"
#include "der/core/index.hpp"
#include "der/core/nearest_node.hpp"
#include "der/energies/corner_fork.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/fork.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/model/frames.hpp"
#include "der/model/location.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "model/corner.hpp"
#include "scenario/conform.hpp"
#include "scenario/directions.hpp"

namespace der {
namespace {

/// A node of a rod.
struct Place {
  Index rod;
  Index node;  // position in RodMesh::nodes
};

/// The nodes of a support: those that it holds, or the one next to a spring.
std::vector<Place> places_of(const scenario::Support& support, const Model& planar) {
  const auto rod = std::find_if(planar.rods.begin(), planar.rods.end(),
                                [&](const RodMesh& each) { return each.name == support.rod; });
  const auto number = static_cast<Index>(rod - planar.rods.begin());
  std::vector<Place> places;
  if (support.holds()) {
    for (const Index node : nodes_at(support.at, *rod)) places.push_back({number, node});
    return places;
  }
  for (const double s : arc_lengths_of(support.at, *rod)) {
    std::vector<double> places_along = rod->arc_length;
    if (rod->closed) places_along.push_back(rod->rest_length());
    const int nearest = nearest_node(places_along, s);
    places.push_back({number, rod->position(nearest)});
  }
  return places;
}

/// The nodes of all supports but clamps.
std::vector<Place> fork_places(const scenario::Scene& scene, const Model& planar) {
  std::vector<Place> places;
  for (const scenario::Support& support : scene.supports) {
    if (support.clamps()) continue;
    const std::vector<Place> more = places_of(support, planar);
    places.insert(places.end(), more.begin(), more.end());
  }
  return places;
}

scenario::Support hold_z(const std::string& rod, Index node) {
  scenario::Support support;
  support.rod = rod;
  support.at = {scenario::Location::Kind::Node, 0.0, static_cast<int>(node), {}};
  support.fix = {scenario::Component::Z};
  return support;
}

void hold_plane(Model& model) {
  std::vector<Index> in_plane;
  for (Index node = 0; node < model.num_nodes; ++node) {
    for (const int c : {0, 1}) in_plane.push_back(model.dof(node, c));
  }
  model.dofs.hold(in_plane);
}

/// The rods in space with their clamps, and z held at the forks.
scenario::Scene rods_in_space(const scenario::Scene& planar_scene, const Model& planar,
                              const std::vector<Place>& forks) {
  scenario::Scene scene = planar_scene;
  scene.model = scenario::ModelChoice::Spatial;
  scene.analysis = scenario::StaticAnalysis{};
  scene.start_from.clear();
  scene.loads.clear();
  scene.supports.clear();
  for (scenario::Support support : planar_scene.supports) {
    if (!support.clamps()) continue;
    support.fix.clear();
    support.prescribe.clear();
    support.spring.reset();
    scene.supports.push_back(std::move(support));
  }
  for (const auto& [rod, node] : forks) {
    scene.supports.push_back(hold_z(planar.rods[to_size(rod)].name, node));
  }
  for (scenario::Rod& rod : scene.rods) rod.initial_velocity.clear();
  conform(scene, scene.model);
  return scene;
}

/// Takes the twist out of the vertex at a node, which a fork divides in two.
template <class Kernel>
void divide_vertex(Index first_dof, ElementLists& elements) {
  auto& plain = elements_of<Kernel>(elements);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (plain.dofs[i][3] == first_dof) plain.constants[i].vertex.twist = 0.0;
  }
  auto& beside_clamps = elements_of<FromSpatialPivot<Kernel>>(elements);
  for (std::size_t i = 0; i < beside_clamps.size(); ++i) {
    if (beside_clamps.dofs[i][3] != first_dof) continue;
    beside_clamps.constants[i].element.vertex.twist = 0.0;
  }
}

/// From a place to where an edge beside it has the direction of the tangent [m].
double reach(const RodMesh& rod, Index place, Index edge) {
  const double along = tangent_place(rod, edge) - rod.arc_length_at(edge);
  return edge == place ? along : rod.edge_length[to_size(edge)] - along;
}

/// The tangent at a place as the rod on the side of `edge` alone has it: on the line of the
/// directions of this edge and the next one on its side.
OutOfPlaneModel::Tangent one_sided_tangent_at(const RodMesh& rod, Index place, Index edge,
                                              const Model& model) {
  const Index number = rod.first_edge + edge;
  const Index inner = rod.position(edge == place ? edge + 1 : edge);
  const Index next = edge == place ? rod.edge_after(inner) : rod.edge_before(inner);
  if (next < 0 || is_corner(rod, inner, model)) return {number, number};
  const double between = reach(rod, inner, edge) + reach(rod, inner, next);
  return {number, rod.first_edge + next, -reach(rod, place, edge) / between};
}

/// The tangent at a place: between the directions of `edge` and of the one on the other side, as
/// the rod bends there in one piece; of what is drawn, the mean of both sides. At an end or a
/// corner that of the one side.
OutOfPlaneModel::Tangent tangent_at(const RodMesh& rod, Index place, Index edge,
                                    const Model& model) {
  const Index other = edge == place ? rod.edge_before(place) : rod.edge_after(place);
  const OutOfPlaneModel::Tangent own_side = one_sided_tangent_at(rod, place, edge, model);
  if (other < 0 || is_corner(rod, place, model)) return own_side;
  const OutOfPlaneModel::Tangent other_side = one_sided_tangent_at(rod, place, other, model);
  const double own = reach(rod, place, edge);
  OutOfPlaneModel::Tangent tangent{own_side.edge, other_side.edge,
                                   own / (own + reach(rod, place, other))};
  const bool both_continue =
      own_side.neighbour != own_side.edge && other_side.neighbour != other_side.edge;
  if (!both_continue) return tangent;
  const Vector& drawn = model.initial_frames;
  const double first = own_side.direction(drawn);
  const double mean = first + 0.5 * nearest_turn(other_side.direction(drawn) - first, 0.0);
  tangent.lean = nearest_turn(mean - tangent.direction(drawn), 0.0);
  return tangent;
}

/// The components towards the two directors of the vector of a section that points along z.
Vec2 upright(const SectionFrame& drawn) { return {drawn.first.z(), drawn.second.z()}; }

/// Holds the section by the half edge on one side of a node.
void add_half_fork(const RodMesh& rod, Index place, Index edge, OutOfPlaneModel& twin) {
  Model& model = twin.model;
  const Index number = rod.first_edge + edge;
  const SpatialEdge& own = model.framed_edges[to_size(number)];
  const OutOfPlaneModel::Tangent tangent = tangent_at(rod, place, edge, model);
  const Index direction = model.tables.add({});
  const double half = 0.5 * rod.edge_length[to_size(edge)];
  elements_of<FromSpatialPivot<Fork>>(*model.elements)
      .add({own.start, own.start + 1, own.start + 2, own.end, own.end + 1, own.end + 2, own.theta},
           {{rod.GJ / half, upright(initial_frame(model, number)), FrameBlock::of(number),
             direction},
            own.first,
            own.last});
  twin.forks.push_back({tangent, tangent, direction});
}

/// Stiffness [N m] of the half of a vertex's cell that lies on an edge against rotations about axes
/// in the plane; `share` of the cell.
Eigen::Matrix2d half_stiffness(const RodMesh& rod, const RodVertex& vertex, double share,
                               const SectionFrame& edge) {
  const Vec2 along = edge.tangent.head<2>().normalized();
  const Vec2 across(-along.y(), along.x());
  const Vec2 upward = upright(edge).cwiseAbs2();
  const double twisting = rod.GJ / (share * vertex.twist_length);
  const double bending =
      (rod.EI_1 * upward[0] + rod.EI_2 * upward[1]) / (share * vertex.bend_length);
  return twisting * along * along.transpose() + bending * across * across.transpose();
}

/// Holds the section at a corner by what the corner's vertex leaves between the two edges.
void add_corner_fork(const RodMesh& rod, const RodVertex& vertex, OutOfPlaneModel& twin) {
  Model& model = twin.model;
  const Index place = rod.position(vertex.place());
  OutOfPlaneModel::ForkAxis axis{tangent_at(rod, place, vertex.before, model),
                                 tangent_at(rod, place, vertex.after, model), 0};
  const double angle = axis.direction(model.initial_frames);
  const Vec2 tangent(std::cos(angle), std::sin(angle));
  axis.control = model.tables.add({});

  const Index before = rod.first_edge + vertex.before;
  const Index after = rod.first_edge + vertex.after;
  const SectionFrame section_before = initial_frame(model, before);
  const SectionFrame section_after = initial_frame(model, after);
  const double length = rod.edge_length[to_size(vertex.before)];
  const double share = length / (length + rod.edge_length[to_size(vertex.after)]);
  const Eigen::Matrix2d own = half_stiffness(rod, vertex, share, section_before);
  const Eigen::Matrix2d other = half_stiffness(rod, vertex, 1.0 - share, section_after);
  const Vec2 turned = (own + other).inverse() * tangent;
  const Eigen::Rotation2Dd from_axis(-angle);
  const SpatialEdge& a = model.framed_edges[to_size(before)];
  const SpatialEdge& b = model.framed_edges[to_size(after)];
  elements_of<FromSpatialPivot<CornerFork>>(*model.elements)
      .add({a.start, a.start + 1, a.start + 2, b.start, b.start + 1, b.start + 2, b.end, b.end + 1,
            b.end + 2, a.theta, b.theta},
           {{1.0 / tangent.dot(turned),
             {upright(section_before), from_axis * (own * turned), FrameBlock::of(before)},
             {upright(section_after), from_axis * (other * turned), FrameBlock::of(after)},
             axis.control},
            a.first,
            b.last});
  twin.forks.push_back(axis);
}

/// Holds the section at a node: on a smooth curve by each of the half edges beside it.
void add_fork(const RodMesh& rod, Index place, OutOfPlaneModel& twin) {
  if (rod.vertices.empty() || rod.clamp_at(place) != nullptr) return;
  if (is_corner(rod, place, twin.model)) {
    const auto here = [&](const RodVertex& vertex) {
      return vertex.clamp < 0 && rod.position(vertex.place()) == place;
    };
    add_corner_fork(rod, *std::find_if(rod.vertices.begin(), rod.vertices.end(), here), twin);
    return;
  }
  const Index first_dof = twin.model.dof(rod.nodes[to_size(place)], 0);
  divide_vertex<SpatialBend<AngleCurvature>>(first_dof, *twin.model.elements);
  divide_vertex<SpatialBend<TangentCurvature>>(first_dof, *twin.model.elements);
  for (const Index edge : {rod.edge_before(place), rod.edge_after(place)}) {
    if (edge >= 0) add_half_fork(rod, place, edge, twin);
  }
}

void follow_actuations(const scenario::Rod& rod, std::size_t number, const Model& planar,
                       OutOfPlaneModel& twin) {
  const auto& stretches = planar.rods[number].actuated_stretches;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const auto& own = twin.model.rods[number].actuated_stretches[i].controls;
    const Index control = stretches[i].controls[0];
    if (stretches[i].what == scenario::Actuated::Length) {
      twin.actuations.push_back({control, own[0], 1.0});
      continue;
    }
    const auto [first, second] = scenario::flat_director(rod).pair(1.0);
    twin.actuations.push_back({control, own[0], first});
    twin.actuations.push_back({control, own[1], second});
  }
}

/// Angle [rad] about z from one tangent in the plane to another.
double angle_about_z(const Vec3& from, const Vec3& to) {
  return std::atan2(from.cross(to).z(), from.dot(to));
}

}  // namespace

double OutOfPlaneModel::Tangent::direction(const Vector& values) const {
  const Vec3 own = FrameBlock::of(edge).tangent(values);
  const Vec3 next = FrameBlock::of(neighbour).tangent(values);
  return std::atan2(own.y(), own.x()) + share * angle_about_z(own, next) + lean;
}

double OutOfPlaneModel::ForkAxis::direction(const Vector& values) const {
  const double first = before.direction(values);
  return first + 0.5 * nearest_turn(after.direction(values) - first, 0.0);
}

Configuration OutOfPlaneModel::at(const Model& planar, const Configuration& here) const {
  Configuration result;
  result.coordinates = model.initial_positions;
  for (Index node = 0; node < model.num_nodes; ++node) {
    for (const int c : {0, 1}) {
      result.coordinates[model.dof(node, c)] = here.coordinates[planar.dof(node, c)];
    }
  }
  Vector& controls = result.controls;
  model.tables.evaluate(0.0, controls);
  for (std::size_t rod = 0; rod < model.rods.size(); ++rod) {
    for (std::size_t i = 0; i < model.rods[rod].clamps.size(); ++i) {
      const Index rotation = planar.rods[rod].clamps[i].rotation;
      if (rotation < 0) continue;
      controls[model.rods[rod].clamps[i].held.rotation] = here.controls[rotation];
    }
  }
  for (const Follower& table : actuations) {
    controls[table.control] = table.factor * here.controls[table.planar];
  }
  model.natural_strain.enter(controls);
  controls.head(model.initial_frames.size()) = model.initial_frames;
  const auto reference_tangent = [&](Index edge) -> Vec3 {
    return FrameBlock::of(edge).tangent(model.initial_frames);
  };
  for (Index edge = 0; edge < static_cast<Index>(model.framed_edges.size()); ++edge) {
    const FrameBlock block = FrameBlock::of(edge);
    const Vec3 tangent =
        model.framed_edges[to_size(edge)].vector(result.coordinates, controls).normalized();
    const Eigen::AngleAxisd turn(angle_about_z(reference_tangent(edge), tangent), Vec3::UnitZ());
    const Vec3 director = turn * block.director(model.initial_frames);
    controls.segment<3>(block.first) = tangent;
    controls.segment<3>(block.first + 3) = made_perpendicular(director, tangent);
  }
  for (const ForkAxis& fork : forks) controls[fork.control] = fork.direction(controls);
  return result;
}

OutOfPlaneModel build_out_of_plane_model(const scenario::Scene& scene, const Model& planar) {
  const std::vector<Place> places = fork_places(scene, planar);
  OutOfPlaneModel twin{build_model(rods_in_space(scene, planar, places)), {}, {}};
  hold_plane(twin.model);
  for (std::size_t i = 0; i < planar.rods.size(); ++i)
    follow_actuations(scene.rods[i], i, planar, twin);
  std::vector<char> has_fork(to_size(planar.num_nodes), 0);
  for (const auto& [rod, place] : places) {
    const RodMesh& layout = twin.model.rods[to_size(rod)];
    char& done = has_fork[to_size(layout.nodes[to_size(place)])];
    if (std::exchange(done, 1) == 0) add_fork(layout, place, twin);
  }
  return twin;
}

bool is_held_out_of_plane(const scenario::Scene& scene, const Model& planar) {
  const bool has_sections =
      std::any_of(planar.rods.begin(), planar.rods.end(),
                  [](const RodMesh& rod) { return rod.EI > 0.0 && rod.nodes.size() > 2; });
  if (has_sections) return false;
  std::vector<char> held(to_size(planar.num_nodes), 0);
  for (const scenario::Support& support : scene.supports) {
    for (const auto& [rod, place] : places_of(support, planar)) {
      held[to_size(planar.rods[to_size(rod)].nodes[to_size(place)])] = 1;
    }
  }
  return std::all_of(held.begin(), held.end(), [](char each) { return each != 0; });
}

}  // namespace der
