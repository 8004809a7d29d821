#include <algorithm>
#include <cmath>
#include <deque>
#include <variant>

#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"
#include "scenario/resampled_rod.hpp"
#include "scenario/segments.hpp"
#include "scenario/suggestion.hpp"

namespace der::scenario {
namespace {

/// Places closer than this share of a rod's length are one: a leg of one cell of length l makes
/// the stiffness (L/l)^3 times as large as that of the rod, and rounding rules below that.
constexpr double kSamePoint = 2e-5;

/// Why something has a place.
enum class Role { Border, Joint, Acts, IsRead };

/// A place of a rod, by the key that names it.
struct NamedPlace {
  Location* at = nullptr;
  Role role = Role::Acts;
};
using Places = std::vector<NamedPlace>;

template <class Enter>
void for_each_place(SceneText& scene, const Enter& enter) {
  for (Joint& joint : scene.joints) {
    for (JointMember& member : joint.of) enter(member.rod, member.at, Role::Joint);
  }
  for (Support& support : scene.supports) enter(support.rod, support.at, Role::Acts);
  for (Load& load : scene.loads) {
    std::visit(
        [&](auto& what) {
          if constexpr (std::is_base_of_v<AtPlace, std::decay_t<decltype(what)>>) {
            enter(what.rod, what.at, Role::Acts);
          }
        },
        load.what);
  }
  for (Rod& rod : scene.rods) {
    for (Sphere& sphere : rod.spheres) enter(rod.name, sphere.at, Role::Acts);
  }
  for (Probe& probe : scene.given_output.probes) {
    if (probe.rod && probe.at) enter(*probe.rod, *probe.at, Role::IsRead);
  }
}

/// Nodes move: the place of one is that of an even rod.
void name_by_arc_length(const RestLine& line, Location& at) {
  const bool is_node =
      at.kind == Location::Kind::Node && at.node < line.num_nodes() && at.node >= -line.num_nodes();
  if (!is_node && at.kind != Location::Kind::Middle) return;
  at.arc_length = line.arc_length_of(at);
  at.kind = Location::Kind::ArcLength;
}

/// The places inside a rod where legs end, ascending. Those that are nearly one become one: that of
/// a border of the drawn shape, or of a joint, whose rods meet there, if there is one.
std::vector<double> leg_ends(const RestLine& line, const Places& places) {
  const double near = kSamePoint * line.length();
  Places inside;
  for (const NamedPlace& place : places) {
    Location& at = *place.at;
    name_by_arc_length(line, at);
    if (place.role == Role::IsRead || at.kind != Location::Kind::ArcLength) continue;
    if (at.arc_length > line.length()) continue;
    const bool at_end = at.arc_length >= line.length() - near;
    if (at.arc_length <= near || (at_end && line.closed())) {
      at.kind = Location::Kind::Start;
    } else if (at_end) {
      at.kind = Location::Kind::End;
    } else {
      inside.push_back(place);
    }
  }
  std::sort(inside.begin(), inside.end(), [](const NamedPlace& a, const NamedPlace& b) {
    return a.at->arc_length < b.at->arc_length;
  });
  std::vector<double> ends;
  for (std::size_t first = 0; first < inside.size();) {
    std::size_t last = first + 1;
    const double from = inside[first].at->arc_length;
    while (last < inside.size() && inside[last].at->arc_length <= from + near) ++last;
    std::size_t chosen = first;
    for (std::size_t i = first; i < last; ++i) {
      if (inside[i].role < inside[chosen].role) chosen = i;
    }
    ends.push_back(inside[chosen].at->arc_length);
    const bool all = inside[chosen].role == Role::Border;
    for (; first < last; ++first) {
      if (all || inside[first].role != Role::Joint) inside[first].at->arc_length = ends.back();
    }
  }
  // A probe there reads one of the two sides.
  for (const auto& [at, role] : places) {
    if (role != Role::IsRead || at->kind != Location::Kind::ArcLength) continue;
    for (const double end : ends) {
      if (std::abs(at->arc_length - end) <= near) at->arc_length = end;
    }
  }
  return ends;
}

/// Arc length [m] of a node of a line; the node behind the last of a ring is at its end.
double arc_length_at(const RestLine& line, int node) {
  return node < line.num_nodes() ? line.arc_length(node) : line.length();
}

/// Where an arc length [m] is among the nodes of a line.
OldPlace old_place(const RestLine& line, double s) {
  const int nearest = line.nearest_node(s);
  const int last = line.num_nodes() - (line.closed() ? 1 : 2);  // edge
  const int before = std::clamp(nearest - (s < line.arc_length(nearest) ? 1 : 0), 0, last);
  const double from = line.arc_length(before);
  return {before, (s - from) / (arc_length_at(line, before + 1) - from)};
}

int num_cells(const RodText& text, const RestLine& line) {
  return line.closed() ? *text.nodes : *text.nodes - 1;
}

/// Places the nodes of a rod on its curve, evenly on each leg: as many cells as the scene's `nodes`
/// say, each cut into as many as `subdivide` says. `jumps`: of its list of natural curvatures.
RestLine place_nodes(RodText& text, Rod& rod, const std::vector<double>& ends,
                     const std::vector<int>& jumps, const RestLine& line) {
  const double drawn = text.curve->length() / line.length();
  std::vector<double> bounds{0.0};
  for (const double end : ends) bounds.push_back(drawn * end);
  bounds.push_back(text.curve->length());
  std::vector<double> lengths;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i) lengths.push_back(bounds[i + 1] - bounds[i]);
  std::vector<int> cells = share_out(num_cells(text, line), lengths);
  for (int& count : cells) count *= text.subdivide.value_or(1);
  CurveMesh mesh = mesh_of(*text.curve, bounds, cells);
  rod.points = std::move(mesh.points);
  enter_borders(*text.curve, mesh, rod);
  std::vector<OldPlace> nodes;
  for (const double s : mesh.arc_length) nodes.push_back(old_place(line, s / drawn));
  resample_lists(nodes, jumps, rod);
  return rest_line(*text.curve, mesh, rod.points, rod.rest_length);
}

void place_leg_ends(CheckContext& context, std::size_t number, Places places) {
  const Path path{"rods", static_cast<int>(number)};
  std::optional<RestLine>& line = context.lines[number];
  RodText& text = context.scene.given_rods[number];
  Rod& rod = context.scene.rods[number];
  if (!text.nodes) return;  // those of a rod drawn by points stay
  std::deque<Location> others;
  for (const CurveBorder& border : text.curve->borders()) {
    Location& at = others.emplace_back();
    at.kind = Location::Kind::ArcLength;
    at.arc_length = border.arc_length / text.curve->length() * line->length();
    places.push_back({&at, Role::Border});
  }
  const bool has_borders = !others.empty();
  // The two sides of a jump are smooth, each by itself.
  const std::vector<int> jumps = natural_jumps(rod, line->length() / num_cells(text, *line));
  for (const int node : jumps) {
    Location& at = others.emplace_back();
    at.kind = Location::Kind::Node;
    at.node = node;
    places.push_back({&at, Role::Acts});
  }
  const std::vector<double> ends = leg_ends(*line, places);
  const int least = static_cast<int>(ends.size()) + (rod.closed ? 1 : 2);
  if (*text.nodes < least) {
    context.diagnostics.add(
        path / "nodes",
        fmt::format("things act at {} places inside the rod{}, and it takes a node at each: write "
                    "{} or more",
                    ends.size(), has_borders ? ", or its shape has borders there" : "", least));
    line.reset();
    return;
  }
  line = place_nodes(text, rod, ends, jumps, *line);
}

/// Where an actuated part of a rod begins or ends.
struct PartEnd {
  double* value = nullptr;  ///< [m]
  std::string rod;
  Location at{};
};

/// Those of actuated curvatures, which jump there.
std::deque<PartEnd> ends_of_parts(SceneText& scene) {
  std::deque<PartEnd> ends;
  for (Actuation& actuation : scene.actuations) {
    if (actuation.what == Actuated::Length) continue;
    for (double* value : {&actuation.from, &actuation.to}) {
      PartEnd& end = ends.emplace_back(PartEnd{value, actuation.rod});
      end.at.kind = Location::Kind::ArcLength;
      end.at.arc_length = *value;
    }
  }
  return ends;
}

/// Gives all that stands on a joint the place of the joint's first member that bends, or else of
/// its first.
void name_members(CheckContext& context) {
  SceneText& scene = context.scene;
  const auto bends = [&](const JointMember& member) {
    const auto rod = context.rods.find(member.rod);
    return rod != context.rods.end() &&
           !does_not_bend(scene.rods[static_cast<std::size_t>(rod->second)]);
  };
  // A rod without bending stiffness does not follow the joint's rotation.
  const auto take = [&](const std::string& name, const Path& path, std::string& rod,
                        Location& at) -> const Joint* {
    const Joint* joint = find_joint(context, name, path);
    if (joint == nullptr || joint->of.empty()) return nullptr;
    const auto found = std::find_if(joint->of.begin(), joint->of.end(), bends);
    const JointMember& member = found == joint->of.end() ? joint->of.front() : *found;
    rod = member.rod;
    at = member.at;
    return joint;
  };
  const auto need_rigid = [&](const Joint* joint, const Path& path) {
    if (joint == nullptr || joint->kind == JointKind::Rigid) return;
    context.diagnostics.add(path, fmt::format("each rod has its own rotation in {} '{}': write "
                                              "the 'rod' and 'at' in place of 'joint'",
                                              in_words(joint->kind), joint->name));
  };
  const auto need_sides = [&](const Joint* joint, const Path& path) {
    if (joint == nullptr || joint->kind != JointKind::Hinge) return need_rigid(joint, path);
    if (joint->of.size() == 2) return;
    context.diagnostics.add(
        path, fmt::format("a moment acts between two rods, and {} meet in hinge '{}': write the "
                          "'rod' and 'at' of each on which one acts",
                          joint->of.size(), joint->name));
  };
  for (int i = 0; i < static_cast<int>(scene.supports.size()); ++i) {
    Support& support = scene.supports[static_cast<std::size_t>(i)];
    if (support.joint.empty()) continue;
    const Path path = Path{"supports", i} / "joint";
    const Joint* joint = take(support.joint, path, support.rod, support.at);
    const bool turns =
        support.clamps() || (support.spring && !support.spring->rotational_stiffness.empty());
    if (turns) need_rigid(joint, path);
  }
  for (int i = 0; i < static_cast<int>(scene.loads.size()); ++i) {
    std::visit(
        [&](auto& what) {
          using Kind = std::decay_t<decltype(what)>;
          if constexpr (std::is_base_of_v<AtPlace, Kind>) {
            if (what.joint.empty()) return;
            const Path path = Path{"loads", i, Kind::kKey} / "joint";
            const Joint* joint = take(what.joint, path, what.rod, what.at);
            if constexpr (std::is_same_v<Kind, Moment>) need_sides(joint, path);
          }
        },
        scene.loads[static_cast<std::size_t>(i)].what);
  }
  for (Probe& probe : scene.given_output.probes) {
    if (!probe.joint || probe.at || probe.leg) continue;
    const Path path{"output", "probes", probe.name, "joint"};
    probe.rod.emplace();
    const Joint* joint = take(*probe.joint, path, *probe.rod, probe.at.emplace());
    if (joint != nullptr) continue;
    probe.rod.reset();
    probe.at.reset();
  }
}

}  // namespace

const Joint* find_joint(CheckContext& context, const std::string& name, const Path& path) {
  const auto& joints = context.scene.joints;
  const auto found = std::find_if(joints.begin(), joints.end(),
                                  [&](const Joint& joint) { return joint.name == name; });
  if (found != joints.end()) return &*found;
  std::vector<std::string> names;
  for (const Joint& joint : joints) names.push_back(joint.name);
  const std::string near = did_you_mean(name, names);
  context.diagnostics.add(path, fmt::format("there is no joint '{}'{}", name,
                                            !near.empty()   ? near
                                            : names.empty() ? "; the scene has none"
                                                            : "; there is " + listed(names)));
  return nullptr;
}

void place_leg_ends(CheckContext& context) {
  SceneText& scene = context.scene;
  for (std::size_t i = 0; i < scene.given_rods.size(); ++i) {
    if (!scene.given_rods[i].subdivide) continue;
    const bool by_shape = !scene.given_rods[i].shape.empty();
    if ((!scene.joints.empty() || by_shape) && scene.given_rods[i].nodes) continue;
    context.diagnostics.add(Path{"rods", static_cast<int>(i)} / "subdivide",
                            "is for rods with a 'shape', and for straight ones in a scene with "
                            "joints: write the number of 'nodes', or more 'points'");
  }
  name_members(context);
  if (scene.joints.empty()) return;
  std::vector<Places> places(scene.rods.size());
  for_each_place(scene, [&](const std::string& name, Location& at, Role role) {
    const auto rod = context.rods.find(name);
    if (rod != context.rods.end())
      places[static_cast<std::size_t>(rod->second)].push_back({&at, role});
  });
  std::deque<PartEnd> ends = ends_of_parts(scene);
  for (PartEnd& end : ends) {
    const auto rod = context.rods.find(end.rod);
    if (rod == context.rods.end()) continue;
    places[static_cast<std::size_t>(rod->second)].push_back({&end.at, Role::Acts});
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (context.lines[i]) place_leg_ends(context, i, places[i]);
  }
  for (const PartEnd& end : ends) {
    const auto rod = context.rods.find(end.rod);
    if (rod == context.rods.end()) continue;
    if (const auto& line = context.lines[static_cast<std::size_t>(rod->second)]) {
      *end.value = line->arc_length_of(end.at);
    }
  }
}

void count_along_edges(CheckContext& context) {
  SceneText& scene = context.scene;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    const auto& curve = scene.given_rods[i].curve;
    if (!curve || curve->is_polyline()) continue;
    const RestLine& along_curve = *context.lines[i];
    const RestLine along_edges(rod.points, rod.closed, rod.rest_length);
    const auto moved = [&](double s) {
      const auto [before, share] = old_place(along_curve, s);
      const double from = arc_length_at(along_edges, before);
      return from + share * (arc_length_at(along_edges, before + 1) - from);
    };
    const auto move = [&](const std::string& name, Location& at) {
      const bool is_place =
          at.kind == Location::Kind::Middle || at.kind == Location::Kind::ArcLength;
      if (name != rod.name || !is_place) return;
      at.arc_length = moved(along_curve.arc_length_of(at));
      at.kind = Location::Kind::ArcLength;
    };
    for_each_place(scene, [&](const std::string& name, Location& at, Role) { move(name, at); });
    for (Probe& probe : scene.output.probes) {
      if (probe.rod && probe.at) move(*probe.rod, *probe.at);
    }
    const auto move_part = [&](auto& part) {
      if (part.rod != rod.name) return;
      part.from = moved(part.from);
      part.to = moved(part.to);
    };
    for (Load& load : scene.loads) {
      std::visit(
          [&](auto& what) {
            if constexpr (std::is_base_of_v<OnPart, std::decay_t<decltype(what)>>) move_part(what);
          },
          load.what);
    }
    for (Actuation& actuation : scene.actuations) move_part(actuation);
  }
}

}  // namespace der::scenario
