#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"
#include "scenario/checks.hpp"
#include "scenario/directions.hpp"
#include "scenario/segments.hpp"

namespace der::scenario {
namespace {

Path rod_path(int rod) { return {"rods", rod}; }

void take_section(RodText& rod) {
  rod.cross_section = rod.section.shape;
  rod.director = std::move(rod.section.director);
}

void check_name(CheckContext& context, int i) {
  const std::string& name = context.scene.given_rods[static_cast<std::size_t>(i)].name;
  if (name.empty()) return;
  const auto [first, is_new] = context.rods.emplace(name, i);
  if (is_new) return;
  const int line = context.scene.given_rods[static_cast<std::size_t>(first->second)].mark.line;
  context.diagnostics.add(rod_path(i) / "name",
                          fmt::format("there is already a rod '{}'{}", name,
                                      line > 0 ? fmt::format(" (line {})", line) : std::string()));
}

/// The longest length [m] whose fourth power is a double, and so are the reciprocals.
constexpr double kLongest = 1e70;

/// An edge that turns by less than this [rad] from a half turn runs back over the one before.
constexpr double kStraightBack = 1e-9;

/// A shape that turns by no more than this [rad] from node to node is fine.
constexpr double kFineTurn = 0.2;

/// Whether what is computed of the rod's lengths, up to their fourth powers, are numbers.
bool is_computable(const RodText& rod, const RestLine& line, const Path& path,
                   Diagnostics& diagnostics) {
  double farthest = line.length();
  for (const Components& point : rod.points) {
    for (const double component : point) farthest = std::max(farthest, std::abs(component));
  }
  const double shortest = line.length() / (line.num_nodes() - 1);
  if (farthest < kLongest && shortest > 1.0 / kLongest) return true;
  diagnostics.add(path,
                  fmt::format("the rod is too {} for double-precision numbers: write lengths "
                              "and coordinates between {:g} and {:g} m",
                              farthest < kLongest ? "short" : "long", 1.0 / kLongest, kLongest));
  return false;
}

/// Puts the nodes of a rod that is drawn by `from` on its curve, and reports too few of them. In a
/// scene with joints they are to move once it is known what stands on the rod (leg_mesh.cpp).
std::optional<CurveMesh> place_on_curve(const CheckContext& context, RodText& rod,
                                        const Path& path) {
  std::optional<DrawnCurve> curve = drawn_curve(rod, path, context.diagnostics);
  if (!curve) return std::nullopt;
  const std::vector<double> bounds = curve->bounds();
  const int parts = static_cast<int>(bounds.size()) - 1;
  const int more = rod.closed ? 0 : 1;  // nodes than cells
  if (*rod.nodes < parts + more) {
    context.diagnostics.add(
        path / "nodes",
        fmt::format("the shape has {} parts between corners and jumps of its curvature, and each "
                    "takes an element: write {} or more",
                    parts, parts + more));
    return std::nullopt;
  }
  std::vector<double> lengths;
  for (int i = 0; i < parts; ++i) {
    const auto part = static_cast<std::size_t>(i);
    lengths.push_back(bounds[part + 1] - bounds[part]);
  }
  std::vector<int> cells = share_out(*rod.nodes - more, lengths);
  if (context.scene.joints.empty()) {
    for (int& count : cells) count *= rod.subdivide.value_or(1);
  }
  CurveMesh mesh = mesh_of(*curve, bounds, cells);
  rod.curve = std::make_shared<DrawnCurve>(std::move(*curve));
  return mesh;
}

/// Whether the nodes on a curve are enough for its turns.
bool has_enough_nodes(const RodText& rod, const RestLine& line, const Path& path,
                      Diagnostics& diagnostics) {
  const int count = line.num_nodes();
  double sharpest = 0.0;
  bool lies_on_another = false;
  Vec3 before = Vec3::Zero();
  for (int k = 1; k < (rod.closed ? count + 2 : count); ++k) {
    const Vec3 edge = in_space(rod.points[static_cast<std::size_t>(k % count)]) -
                      in_space(rod.points[static_cast<std::size_t>((k - 1) % count)]);
    const double dot = before.dot(edge);
    lies_on_another = lies_on_another || edge.norm() <= line.same_place() ||
                      (dot < 0.0 && before.cross(edge).norm() <= -dot * kStraightBack);
    before = edge;
    if (k > count) break;
    sharpest =
        std::max(sharpest, rod.curve->turn_between(line.arc_length(k - 1),
                                                   k < count ? line.arc_length(k) : line.length()));
  }
  if (sharpest >= kPi) {
    diagnostics.add(
        path, fmt::format("{} are too few for this shape: it turns by {:.3g} rad from "
                          "a node to the next, and half a turn is too much: write "
                          "about {:g}",
                          *rod.nodes, sharpest, std::ceil(*rod.nodes * sharpest / kFineTurn)));
  } else if (lies_on_another) {
    diagnostics.add(path, fmt::format("{} are too few for this shape: edges from node to node lie "
                                      "on one another",
                                      *rod.nodes));
  }
  return sharpest < kPi && !lies_on_another;
}

/// No edge without length, no edge that runs straight back over the one before.
bool check_polyline(const RodText& rod, const RestLine& line, const Path& path,
                    Diagnostics& diagnostics) {
  const Path points = path / "points";
  if (!is_computable(rod, line, points, diagnostics)) return false;
  const std::size_t before = diagnostics.size();
  const int count = line.num_nodes();
  Vec3 before_it = Vec3::Zero();  // the edge before
  // A ring goes on along its closing edge to its first one.
  for (int k = 1; k < (rod.closed ? count + 2 : count); ++k) {
    const Vec3 from = in_space(rod.points[static_cast<std::size_t>((k - 1) % count)]);
    const Vec3 edge = in_space(rod.points[static_cast<std::size_t>(k % count)]) - from;
    if (edge.norm() <= line.same_place()) {
      if (k < count) {
        diagnostics.add(points / k, "coincides with the point before it: an edge needs a length");
      } else if (k == count) {
        diagnostics.add(points / (count - 1),
                        "repeats the first point: a closed rod goes back there by itself, so leave "
                        "this point out");
      }
      continue;
    }
    const double dot = before_it.dot(edge);
    if (dot < 0.0 && before_it.cross(edge).norm() <= -dot * kStraightBack) {
      diagnostics.add(points / ((k - 1) % count),
                      "the rod turns straight back here, through 180 degrees: its "
                      "side of bending is not defined");
    }
    before_it = edge;
  }
  return diagnostics.size() == before;
}

/// A ring goes around something.
bool can_be_closed(const RodText& rod, const Path& path, Diagnostics& diagnostics) {
  if (!rod.closed) return true;
  if (rod.given_points.empty() && rod.shape.empty()) {
    diagnostics.add(path / "closed",
                    "a straight line cannot be closed: draw the ring by a 'shape' that leads back "
                    "to 'from', or by 'points', of which the first is not repeated");
    return false;
  }
  const std::size_t count =
      rod.nodes ? static_cast<std::size_t>(*rod.nodes) : rod.given_points.size();
  if (count >= 3) return true;
  const char* key = rod.nodes ? "nodes" : "points";
  diagnostics.add(path / key,
                  fmt::format("a closed rod takes 3 {} or more, got {}: the edge from the last "
                              "one to the first would lie upon another",
                              key, count));
  return false;
}

/// An edge that starts shorter than this fraction of its rest length nearly ends before the pivot
/// of a clamp; and no rod that is stretched to more than twice its length obeys a linear law.
constexpr double kShortest = 0.5;

/// A rod drawn shorter than its rest length by more than this ratio starts waves that fold it.
constexpr double kCompressed = 1.001;

bool check_rest_length(CheckContext& context, const RodText& rod, double drawn, const Path& path) {
  if (context.diagnostics.under(path)) return false;
  const double rest = *rod.rest_length;
  if (rest * kShortest > drawn) {
    context.diagnostics.add(
        path,
        fmt::format("is {:.3g} times the length as drawn, {:.6g} m, and can be {:g} times it at "
                    "most: draw a longer rod, as a curve by 'shape' or 'points'",
                    rest / drawn, drawn, 1.0 / kShortest));
  } else if (rest < kShortest * drawn) {
    context.diagnostics.add(
        path, fmt::format("stretches the rod to {:.3g} times its length where it is drawn, {:.6g} "
                          "m, and it can be {:g} times it: draw a shorter rod and let 'prescribe' "
                          "of a support pull its end",
                          drawn / rest, drawn, 1.0 / kShortest));
  } else if (std::holds_alternative<BucklingAnalysis>(context.scene.analysis)) {
    context.diagnostics.add(path,
                            "linear buckling counts from a shape without stress: draw the rod "
                            "without 'rest_length', or use 'analysis: continuation'");
  } else {
    if (rest > kCompressed * drawn && context.scene.is_dynamic() &&
        context.scene.start_from.empty()) {
      context.scene.warnings.push_back(fmt::format(
          "rod '{}' begins compressed to {:.2g} of its rest length and springs apart: write "
          "'start_from: equilibrium' to begin at rest",
          rod.name, drawn / rest));
    }
    return true;
  }
  return false;
}

/// The rod's nodes, as far as the keys that say where they are could be read.
void check_geometry(CheckContext& context, int i) {
  const Path path = rod_path(i);
  for (const char* key :
       {"nodes", "subdivide", "from", "to", "shape", "points", "closed", "rest_length"}) {
    if (context.diagnostics.under(path / key)) return;
  }
  RodText& rod = context.scene.given_rods[static_cast<std::size_t>(i)];
  const bool by_points = !rod.given_points.empty();
  if (!by_points && !rod.nodes) return;  // not a mapping at all
  if (!can_be_closed(rod, path, context.diagnostics)) return;
  std::optional<CurveMesh> mesh;
  if (by_points) {
    rod.points = std::move(rod.given_points);
  } else {
    mesh = place_on_curve(context, rod, path);
    if (!mesh) return;
    rod.points = std::move(mesh->points);
    enter_borders(*rod.curve, *mesh, rod);
  }
  const auto line_of = [&](std::optional<double> rest_length) {
    return by_points ? RestLine(rod.points, rod.closed, rest_length)
                     : rest_line(*rod.curve, *mesh, rod.points, rest_length);
  };
  RestLine line = line_of(std::nullopt);
  bool fine = true;
  if (by_points) {
    fine = check_polyline(rod, line, path, context.diagnostics);
  } else {
    fine = is_computable(rod, line, path / (rod.shape.empty() ? "to" : "shape"),
                         context.diagnostics) &&
           has_enough_nodes(rod, line, path / "nodes", context.diagnostics);
  }
  if (fine && rod.rest_length) {
    fine = check_rest_length(context, rod, line.length(), path / "rest_length");
    line = line_of(rod.rest_length);
  }
  if (fine) context.lines[static_cast<std::size_t>(i)] = std::move(line);
}

std::string kind_name(const CrossSection& section) {
  struct Name {
    std::string operator()(const Circle& /*kind*/) const { return "circle"; }
    std::string operator()(const Tube& /*kind*/) const { return "tube"; }
    std::string operator()(const Rectangle& /*kind*/) const { return "rectangle"; }
    std::string operator()(const Ellipse& /*kind*/) const { return "ellipse"; }
    std::string operator()(const Stiffness& /*kind*/) const { return "stiffness"; }
  };
  return std::visit(Name{}, section);
}

void check_material(CheckContext& context, int i) {
  const Path path = rod_path(i);
  if (context.diagnostics.under(path / "cross_section") ||
      context.diagnostics.under(path / "material") || context.diagnostics.at(path)) {
    return;
  }
  const RodText& rod = context.scene.given_rods[static_cast<std::size_t>(i)];
  const bool direct = std::holds_alternative<Stiffness>(rod.cross_section);
  if (direct && rod.material) {
    context.diagnostics.add(path / "material",
                            "'material' and 'cross_section: {stiffness: ...}' exclude each other: "
                            "the stiffnesses and the mass per length are given already");
  } else if (!direct && !rod.material) {
    context.diagnostics.add(
        path / "material", fmt::format("a rod with the cross-section '{}' needs the key 'material'",
                                       kind_name(rod.cross_section)));
  }
}

/// Reports a list with one entry for each node that has another length.
bool one_for_each_node(CheckContext& context, std::size_t count, std::size_t nodes,
                       const Path& path) {
  if (count == nodes) return true;
  context.diagnostics.add(path, fmt::format("needs one value for all nodes or one for each of the "
                                            "{} nodes, got {}",
                                            nodes, count));
  return false;
}

void check_velocity(CheckContext& context, int i) {
  const Path path = rod_path(i) / "initial_velocity";
  RodText& rod = context.scene.given_rods[static_cast<std::size_t>(i)];
  if (context.diagnostics.under(path)) return;
  if (auto* constant = std::get_if<Components>(&rod.given_velocity)) {
    rod.initial_velocity.assign(rod.points.size(), *constant);
  } else if (auto* list = std::get_if<std::vector<Components>>(&rod.given_velocity);
             list != nullptr && one_for_each_node(context, list->size(), rod.points.size(), path)) {
    rod.initial_velocity = std::move(*list);
  }
}

/// Two numbers are a list with one for each node where vectors have two components, and a pair
/// where they have three.
void check_natural_curvature(CheckContext& context, int i) {
  const Path path = rod_path(i) / "natural_curvature";
  RodText& rod = context.scene.given_rods[static_cast<std::size_t>(i)];
  if (context.diagnostics.under(path)) return;
  if (const auto* pairs = std::get_if<std::vector<CurvaturePair>>(&rod.natural_curvature)) {
    one_for_each_node(context, pairs->size(), rod.points.size(), path);
    return;
  }
  const auto* list = std::get_if<std::vector<double>>(&rod.natural_curvature);
  if (!list) return;
  if (context.diagnostics.dimension() == 2) {
    one_for_each_node(context, list->size(), rod.points.size(), path);
  } else if (list->size() == 2) {
    rod.natural_curvature = CurvaturePair{(*list)[0], (*list)[1]};
  } else {
    context.diagnostics.add(
        path, fmt::format("in a scene of three components a natural curvature is a pair [k1, k2], "
                          "or a list of pairs with one for each node, but this is a list of {} "
                          "number{}",
                          list->size(), list->size() == 1 ? "" : "s"));
  }
}

void check_natural_twist(CheckContext& context, int i) {
  const Path path = rod_path(i) / "natural_twist";
  const RodText& rod = context.scene.given_rods[static_cast<std::size_t>(i)];
  if (context.diagnostics.under(path)) return;
  if (const auto* list = std::get_if<std::vector<double>>(&rod.natural_twist)) {
    one_for_each_node(context, list->size(), rod.points.size(), path);
  }
}

/// A direction across the rod where it begins, which is +z unless given.
void check_director(CheckContext& context, int i) {
  RodText& rod = context.scene.given_rods[static_cast<std::size_t>(i)];
  const Path path = rod_path(i) / "cross_section";
  if (context.diagnostics.under(path)) return;
  if (rod.director) {
    rod.director->resize(3, 0.0);
    if (is_zero(*rod.director)) {
      context.diagnostics.add(path / "director",
                              "a director needs a direction: its components "
                              "are all 0");
      return;
    }
  }
  if (has_width_direction(rod)) return;
  if (rod.director) {
    context.diagnostics.add(path / "director",
                            "lies along the rod where it begins: give a direction across it");
  } else if (!is_isotropic(rod.cross_section)) {
    context.diagnostics.add(path,
                            "the rod begins along z: give 'director', the direction of the width "
                            "across the rod");
  }
}

void check_spheres(CheckContext& context, int i) {
  const Path path = rod_path(i) / "spheres";
  RodText& rod = context.scene.given_rods[static_cast<std::size_t>(i)];
  for (std::size_t k = 0; k < rod.spheres.size(); ++k) {
    const Path at = path / static_cast<int>(k) / "at";
    if (!context.diagnostics.under(at)) context.nodes_at(i, rod.spheres[k].at, at, true);
  }
}

bool is_massless(const Rod& rod) {
  if (const auto* direct = std::get_if<Stiffness>(&rod.cross_section)) {
    return direct->mass_per_length == 0.0;
  }
  return rod.material->density == 0.0;
}

/// Nodes that could move but have no mass.
std::vector<int> weightless_nodes(CheckContext& context, int i) {
  Rod& rod = context.scene.rods[static_cast<std::size_t>(i)];
  std::vector<double> density(rod.points.size(), 0.0);
  for (Sphere& sphere : rod.spheres) {
    const auto nodes = context.nodes_at(i, sphere.at, rod_path(i) / "spheres", true);
    for (const int node : *nodes) density[static_cast<std::size_t>(node)] = sphere.density;
  }
  std::vector<int> nodes;
  for (int node = 0; node < static_cast<int>(density.size()); ++node) {
    if (density[static_cast<std::size_t>(node)] == 0.0 && !context.is_fixed(i, node)) {
      nodes.push_back(node);
    }
  }
  return nodes;
}

void check_masses(CheckContext& context, int i) {
  const Rod& rod = context.scene.rods[static_cast<std::size_t>(i)];
  if (!is_massless(rod)) return;
  const std::vector<int> nodes = weightless_nodes(context, i);
  if (nodes.empty()) return;
  constexpr std::size_t shown = 5;
  std::string numbers;
  for (std::size_t k = 0; k < std::min(shown, nodes.size()); ++k) {
    numbers += (k > 0 ? ", " : "") + std::to_string(nodes[k]);
  }
  if (nodes.size() > shown) numbers += fmt::format(", ... ({} in all)", nodes.size());
  const Path path = rod_path(i);
  const bool direct = std::holds_alternative<Stiffness>(rod.cross_section);
  context.diagnostics.add(
      direct ? path / "cross_section" / "stiffness" / "mass_per_length"
             : path / "material" / "density",
      fmt::format(
          "every free node needs a mass in a run over time, but {} {} {} none: give the rod "
          "a {}, or the node a sphere with a density",
          nodes.size() > 1 ? "nodes" : "node", numbers, nodes.size() > 1 ? "have" : "has",
          direct ? "mass per length" : "density"));
}

/// A rod of a single edge has no inner node, so only a clamp can make it bend.
void check_bends(CheckContext& context, int i) {
  const Rod& rod = context.scene.rods[static_cast<std::size_t>(i)];
  const bool curved = !std::holds_alternative<StressFreeReference>(rod.natural_curvature);
  if (!curved || rod.points.size() > 2) return;
  if (context.is_clamped(i, 0) || context.is_clamped(i, 1)) return;
  context.diagnostics.add(
      rod_path(i) / "natural_curvature",
      "has no effect: a rod of 2 nodes without a clamp cannot bend; give it 3 or "
      "more nodes");
}

}  // namespace

bool fit_into_memory(CheckContext& context) {
  constexpr std::size_t most = 4'000'000;
  std::size_t nodes = 0;
  int number = 0;
  for (const RodText& rod : context.scene.given_rods) {
    const bool straight = rod.given_points.empty();
    nodes += straight ? static_cast<std::size_t>(rod.nodes.value_or(0)) *
                            static_cast<std::size_t>(rod.subdivide.value_or(1))
                      : rod.given_points.size();
    if (nodes > most) {
      context.diagnostics.add(
          rod_path(number) / (straight ? "nodes" : "points"),
          fmt::format("with this rod the scene has {} nodes, and it can have {}: give its rods "
                      "fewer nodes, or let each be a scene of its own",
                      nodes, most));
      return false;
    }
    ++number;
  }
  return true;
}

void check_rods(CheckContext& context) {
  const auto count = static_cast<int>(context.scene.given_rods.size());
  context.lines.resize(context.scene.given_rods.size());
  for (int i = 0; i < count; ++i) {
    take_section(context.scene.given_rods[static_cast<std::size_t>(i)]);
    check_name(context, i);
    check_geometry(context, i);
    check_material(context, i);
    if (context.scene.given_rods[static_cast<std::size_t>(i)].points.empty()) continue;
    check_velocity(context, i);
    check_natural_curvature(context, i);
    check_natural_twist(context, i);
    if (!context.lines[static_cast<std::size_t>(i)]) continue;
    check_spheres(context, i);
    check_director(context, i);
  }
  for (RodText& rod : context.scene.given_rods) {
    context.scene.rods.push_back(static_cast<Rod&&>(rod));
  }
}

void check_free_nodes(CheckContext& context) {
  if (context.diagnostics.under({"supports"})) return;
  for (int i = 0; i < static_cast<int>(context.lines.size()); ++i) {
    if (context.diagnostics.under(rod_path(i))) continue;
    check_bends(context, i);
    const bool vibrates = std::holds_alternative<ModesAnalysis>(context.scene.analysis);
    if (context.scene.is_dynamic() || vibrates) check_masses(context, i);
  }
}

}  // namespace der::scenario
