#include <algorithm>
#include <cmath>
#include <deque>
#include <variant>

#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"
#include "scenario/resampled_rod.hpp"
#include "scenario/suggestion.hpp"

namespace der::scenario {
namespace {

/// Places closer than this share of a rod's length are one: a leg of one cell of length l makes
/// the stiffness (L/l)^3 times as large as that of the rod, and rounding rules below that.
constexpr double kSamePoint = 2e-5;

/// Why something has a place.
enum class Role { Joint, Acts, IsRead };

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
/// a joint, whose rods meet there, if there is one.
std::vector<double> leg_ends(const RestLine& line, const Places& places) {
  const double near = kSamePoint * line.length();
  Places inside;
  for (const NamedPlace& place : places) {
    Location& at = *place.at;
    name_by_arc_length(line, at);
    if (place.role == Role::IsRead || at.kind != Location::Kind::ArcLength) continue;
    if (at.arc_length > line.length()) continue;
    if (at.arc_length <= near) {
      at.kind = Location::Kind::Start;
    } else if (at.arc_length >= line.length() - near) {
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
    for (std::size_t i = first; i < last && inside[chosen].role != Role::Joint; ++i) {
      if (inside[i].role == Role::Joint) chosen = i;
    }
    ends.push_back(inside[chosen].at->arc_length);
    for (; first < last; ++first) {
      if (inside[first].role != Role::Joint) inside[first].at->arc_length = ends.back();
    }
  }
  return ends;
}

/// Shares cells out among legs of these lengths, one each at least, so that the longest cell is as
/// short as can be.
std::vector<int> share_out(int cells, const std::vector<double>& lengths, double whole) {
  std::vector<int> counts;
  int given = 0;
  for (const double length : lengths) {
    counts.push_back(std::max(1, static_cast<int>(cells * (length / whole) * (1.0 - 1e-12))));
    given += counts.back();
  }
  constexpr double kLonger = 1.0 + 1e-9;  // of equal legs the first has one more, not a rounded one
  const auto cell = [&](std::size_t leg, int more) { return lengths[leg] / (counts[leg] + more); };
  for (; given != cells; given += given < cells ? 1 : -1) {
    std::size_t chosen = lengths.size();
    for (std::size_t leg = 0; leg < lengths.size(); ++leg) {
      if (given > cells && counts[leg] == 1) continue;
      const bool better =
          chosen == lengths.size() || (given < cells ? cell(leg, 0) > kLonger * cell(chosen, 0)
                                                     : cell(leg, -1) * kLonger < cell(chosen, -1));
      if (better) chosen = leg;
    }
    counts[chosen] += given < cells ? 1 : -1;
  }
  return counts;
}

/// Places the nodes of a straight rod evenly on each leg: as many cells as the scene's `nodes` say,
/// each cut into as many as `subdivide` says.
void place_nodes(RodText& text, Rod& rod, const std::vector<double>& ends,
                 const std::vector<int>& jumps, double length) {
  std::vector<double> bounds{0.0};
  bounds.insert(bounds.end(), ends.begin(), ends.end());
  bounds.push_back(length);
  std::vector<double> lengths;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i) lengths.push_back(bounds[i + 1] - bounds[i]);
  const int given = *text.nodes - 1;
  std::vector<int> cells = share_out(given, lengths, length);
  std::vector<OldPlace> nodes{{0, 0.0}};
  rod.points.resize(1);
  for (std::size_t leg = 0; leg < cells.size(); ++leg) {
    const int count = cells[leg] * text.subdivide.value_or(1);
    for (int k = 1; k <= count; ++k) {
      const double share = (bounds[leg] + lengths[leg] * k / count) / length;
      const int before = std::clamp(static_cast<int>(share * given), 0, given - 1);
      nodes.push_back({before, share * given - before});
      Components point = text.from;
      for (std::size_t c = 0; c < point.size(); ++c) point[c] += share * (text.to[c] - point[c]);
      rod.points.push_back(std::move(point));
    }
  }
  rod.points.back() = text.to;
  resample_lists(nodes, jumps, rod);
}

/// Places the nodes of a straight rod so that legs end where anything acts; none: reports that it
/// has too few.
std::optional<RestLine> mesh_straight(CheckContext& context, std::size_t number,
                                      const Places& places) {
  RodText& text = context.scene.given_rods[number];
  Rod& rod = context.scene.rods[number];
  const RestLine& line = *context.lines[number];
  Places all = places;
  // The two sides of a jump are smooth, each by itself.
  const std::vector<int> jumps = natural_jumps(rod, line.length() / (*text.nodes - 1));
  std::vector<Location> at_jumps;
  for (const int node : jumps) {
    at_jumps.emplace_back().kind = Location::Kind::Node;
    at_jumps.back().node = node;
  }
  for (Location& at : at_jumps) all.push_back({&at, Role::Acts});
  const std::vector<double> ends = leg_ends(line, all);
  const int least = static_cast<int>(ends.size()) + 2;
  if (*text.nodes < least) {
    context.diagnostics.add(
        Path{"rods", static_cast<int>(number)} / "nodes",
        fmt::format("things act at {} places inside the rod, and it takes a node at each: write "
                    "{} or more",
                    ends.size(), least));
    return std::nullopt;
  }
  place_nodes(text, rod, ends, jumps, line.length());
  return RestLine(rod.points, false, rod.rest_length);
}

/// Where a part of a rod begins or ends.
struct Border {
  double* value = nullptr;  ///< [m]
  std::string rod;
  Role role = Role::IsRead;
  Location at{};
};

/// Those of actuations and of loads along rods. Where an actuated curvature begins or ends it
/// jumps.
std::deque<Border> borders_of(SceneText& scene) {
  std::deque<Border> borders;
  const auto enter = [&](const std::string& rod, double& value, Role role) {
    Border& border = borders.emplace_back(Border{&value, rod, role});
    border.at.kind = Location::Kind::ArcLength;
    border.at.arc_length = value;
  };
  for (Actuation& actuation : scene.actuations) {
    const Role role = actuation.what == Actuated::Length ? Role::IsRead : Role::Acts;
    enter(actuation.rod, actuation.from, role);
    enter(actuation.rod, actuation.to, role);
  }
  for (Load& load : scene.loads) {
    std::visit(
        [&](auto& what) {
          if constexpr (std::is_base_of_v<OnPart, std::decay_t<decltype(what)>>) {
            enter(what.rod, what.from, Role::IsRead);
            enter(what.rod, what.to, Role::IsRead);
          }
        },
        load.what);
  }
  return borders;
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
    if (!scene.joints.empty() && scene.given_rods[i].nodes) continue;
    context.diagnostics.add(Path{"rods", static_cast<int>(i)} / "subdivide",
                            "is for straight rods in a scene with joints: write the number of "
                            "'nodes', or more 'points'");
  }
  name_members(context);
  if (scene.joints.empty()) return;
  std::vector<Places> places(scene.rods.size());
  for_each_place(scene, [&](const std::string& name, Location& at, Role role) {
    const auto rod = context.rods.find(name);
    if (rod != context.rods.end())
      places[static_cast<std::size_t>(rod->second)].push_back({&at, role});
  });
  std::deque<Border> borders = borders_of(scene);
  for (Border& border : borders) {
    const auto rod = context.rods.find(border.rod);
    if (rod == context.rods.end()) continue;
    places[static_cast<std::size_t>(rod->second)].push_back({&border.at, border.role});
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::optional<RestLine>& line = context.lines[i];
    if (line && scene.given_rods[i].nodes) line = mesh_straight(context, i, places[i]);
  }
  for (const Border& border : borders) {
    const auto rod = context.rods.find(border.rod);
    if (rod == context.rods.end()) continue;
    if (const auto& line = context.lines[static_cast<std::size_t>(rod->second)]) {
      *border.value = line->arc_length_of(border.at);
    }
  }
}

}  // namespace der::scenario
