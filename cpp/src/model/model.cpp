#include "der/model/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/core/error.hpp"
#include "der/core/index.hpp"

namespace der {

Index RodMesh::position(Index place) const {
  if (!closed) return place;
  const auto count = static_cast<Index>(nodes.size());
  const Index beyond = place % count;
  return beyond < 0 ? beyond + count : beyond;
}

double RodMesh::arc_length_at(Index place) const {
  const Index own = position(place);
  const double s = arc_length[to_size(own)];
  if (own == place) return s;
  const Index turns = (place - own) / static_cast<Index>(nodes.size());
  return s + turns * rest_length();
}

double RodMesh::edge_middle(Index edge) const {
  return 0.5 * (arc_length_at(edge) + arc_length_at(edge + 1));
}

double RodMesh::voronoi_length(Index node) const {
  const auto length = [this](Index edge) { return edge < 0 ? 0.0 : edge_length[to_size(edge)]; };
  return 0.5 * (length(edge_before(node)) + length(edge_after(node)));
}

Edge RodMesh::edge(Index number, const Model& model) const {
  return {model.dof(node(number), 0), model.dof(node(number + 1), 0),
          edge_length[to_size(position(number))]};
}

std::array<Index, 4> RodMesh::edge_dofs(Index edge, const Model& model) const {
  const Index a = node(edge);
  const Index b = node(edge + 1);
  return {model.dof(a, 0), model.dof(a, 1), model.dof(b, 0), model.dof(b, 1)};
}

Index RodMesh::rotation_at(Index place) const {
  place = position(place);
  for (const Leg& leg : legs) {
    if (leg.first == place && leg.start.rotation >= 0) return leg.start.rotation;
    if (leg.last == place && leg.end.rotation >= 0) return leg.end.rotation;
  }
  return -1;
}

const Clamp* RodMesh::clamp_at(Index place) const {
  const Index here = position(place);
  for (const Clamp& clamp : clamps) {
    if (clamp.place == here) return &clamp;
  }
  return nullptr;
}

CellHalves RodMesh::cell_halves_at(Index place) const {
  const Index here = position(place);
  for (const CellHalves& halves : cell_halves) {
    if (halves.place == here) return halves;
  }
  return {here};
}

std::vector<double> RodMesh::moment_arc_lengths() const {
  std::vector<double> places;
  for (const MomentPlace& place : moment_places) places.push_back(place.arc_length);
  for (const SpatialMomentPlace& place : spatial_moments) places.push_back(place.arc_length);
  for (const SectionSpringPlace& place : section_springs) places.push_back(place.arc_length);
  return places;
}

namespace {

/// The first of some places that is at arc length `s` [m]; null: none is.
template <class Place>
const Place* place_at(double s, const std::vector<Place>& places, double same_place) {
  const auto found = std::find_if(places.begin(), places.end(), [&](const Place& place) {
    return std::abs(place.arc_length - s) <= same_place;
  });
  return found == places.end() ? nullptr : &*found;
}

}  // namespace

const MomentPlace* RodMesh::moment_place_at(double s) const {
  return place_at(s, moment_places, same_place());
}

const SectionSpringPlace* RodMesh::section_spring_at(double s) const {
  return place_at(s, section_springs, same_place());
}

const RodMesh& Model::rod(const std::string& rod_name) const {
  for (const RodMesh& layout : rods) {
    if (layout.name == rod_name) return layout;
  }
  throw Error("model_error", "there is no rod named '" + rod_name + "'");
}

RodMesh& Model::rod(const std::string& rod_name) {
  return rods[static_cast<std::size_t>(&std::as_const(*this).rod(rod_name) - rods.data())];
}

Index follow_edge(const RodMesh& rod, Index edge, Model& model) {
  const Edge followed = rod.edge(edge, model);
  const Vec2 drawn = along_edge(followed, model.reference_positions);
  const double direction = std::atan2(drawn.y(), drawn.x());
  // An entry of its own, which no table moves.
  model.followed_edges.push_back({followed, direction, model.tables.add({{0.0}, {0.0}})});
  return static_cast<Index>(model.followed_edges.size()) - 1;
}

bool Model::can_set(Index control) const {
  const auto is_it = [&](const PrescribedControl& moved) { return moved.control == control; };
  if (std::any_of(prescribed.begin(), prescribed.end(), is_it)) return true;
  for (const NamedControl& each : named) {
    for (const ControlComponent& component : each.components) {
      const auto& controls = component.controls;
      if (std::find(controls.begin(), controls.end(), control) != controls.end()) return true;
    }
  }
  return false;
}

NodePlace place_of(const Model& model, Index node) {
  for (const RodMesh& rod : model.rods) {
    const auto found = std::find(rod.nodes.begin(), rod.nodes.end(), node);
    if (found != rod.nodes.end()) {
      return {rod.name, static_cast<Index>(found - rod.nodes.begin())};
    }
  }
  return {};
}

NaturalStrainOffset natural_strain_offset(const RodMesh& rod, const RodVertex& vertex) {
  return rod.natural_strain_entries.cell(rod.position(vertex.place()), vertex.leaves_clamp());
}

Vector over_all_dofs(const Model& model, const Vector& free) {
  Vector full = Vector::Zero(model.num_dofs());
  full(model.dofs.free()) = free;
  return full;
}

std::string describe_dof(const Model& model, Index dof) {
  const Dof what = model.dofs[dof];
  const Index node = model.dofs.node_of(dof);
  const NodePlace place = place_of(model, node);
  const std::string rod = place.rod.empty() ? "" : fmt::format(" of rod '{}'", place.rod);
  const Index number = place.rod.empty() ? node : place.place;
  if (what.kind == DofKind::Rotation)
    return fmt::format("the joint at node {}{} (rotation)", number, rod);
  if (what.kind == DofKind::Angle)
    return fmt::format("the edge after node {}{} (angle)", number, rod);
  return fmt::format("node {}{} ({})", number, rod, "xyz"[what.component]);
}

}  // namespace der
