#include "scenario/checks.hpp"

#include <algorithm>
#include <numeric>

#include "der/scenario/model_choice.hpp"
#include "der/scenario/unit_problem.hpp"
#include "scenario/conform.hpp"
#include "scenario/suggestion.hpp"

namespace der::scenario {
namespace {

std::string in_words(const Location& at) {
  return at.kind == Location::Kind::Middle ? "in the middle" : "at this arc length";
}

std::string no_node_there(const RestLine& line, const Location& at, double s) {
  const int nearest = line.nearest_node(s);
  // An even number of edges has a node in the middle.
  const bool is_odd = (line.num_nodes() - (line.closed() ? 0 : 1)) % 2 != 0;
  const bool evenly_halved = at.kind == Location::Kind::Middle && is_odd;
  return fmt::format("no node lies {} ({:.9g} m): the nearest is {{node: {}}} at {:.9g} m{}",
                     in_words(at), s, nearest, line.arc_length(nearest),
                     evenly_halved ? fmt::format("; the rod has {} nodes, an {} number has one in "
                                                 "the middle",
                                                 line.num_nodes(), line.closed() ? "even" : "odd")
                                   : "");
}

}  // namespace

Hold hold_of(Component component) {
  switch (component) {
    case Component::X:
      return Hold::X;
    case Component::Y:
      return Hold::Y;
    case Component::Z:
      break;
  }
  return Hold::Z;
}

const char* name_of(Hold hold) {
  switch (hold) {
    case Hold::X:
      return "x";
    case Hold::Y:
      return "y";
    case Hold::Z:
      return "z";
    case Hold::Angle:
      break;
  }
  return "the angle";
}

const HeldNode* CheckContext::held_at(int rod, int node) const {
  const auto found = held.find(node_key(rod, node));
  return found == held.end() ? nullptr : &found->second;
}

bool CheckContext::is_clamped(int rod, int node) const { return clamp_at(rod, node) != nullptr; }

const Support* CheckContext::clamp_at(int rod, int node) const {
  const HeldNode* holding = held_at(rod, node);
  if (holding == nullptr) return nullptr;
  const std::optional<int> by = holding->holder(Hold::Angle);
  return by ? &scene.supports[static_cast<std::size_t>(*by)] : nullptr;
}

bool CheckContext::is_fixed(int rod, int node) const {
  const HeldNode* holding = held_at(rod, node);
  return holding && holding->holds(Hold::X) && holding->holds(Hold::Y) &&
         (dimension == 2 || holding->holds(Hold::Z));
}

std::optional<int> CheckContext::find_rod(const std::string& name, const Path& path) {
  if (const auto found = rods.find(name); found != rods.end()) {
    if (!lines[static_cast<std::size_t>(found->second)]) return std::nullopt;
    return found->second;
  }
  std::vector<std::string> names;
  for (const Rod& rod : scene.rods) {
    if (rod.name.empty()) return std::nullopt;  // it may be the one that is meant
    names.push_back(rod.name);
  }
  if (names.empty()) return std::nullopt;
  const std::string near = did_you_mean(name, names);
  diagnostics.add(path, fmt::format("there is no rod '{}'{}", name,
                                    near.empty() ? "; there is " + listed(names) : near));
  return std::nullopt;
}

std::optional<std::vector<int>> CheckContext::nodes_at(int rod, Location& at, const Path& path,
                                                       bool needs_node) {
  const RestLine& line = *lines[static_cast<std::size_t>(rod)];
  const int count = line.num_nodes();
  double s = 0.0;
  switch (at.kind) {
    case Location::Kind::Start:
      return std::vector<int>{0};
    case Location::Kind::End:
      if (line.closed()) {
        diagnostics.add(path,
                        "a closed rod has no end: it goes back to its start. Write 'start', an arc "
                        "length or a node");
        return std::nullopt;
      }
      return std::vector<int>{count - 1};
    case Location::Kind::All: {
      std::vector<int> all(static_cast<std::size_t>(count));
      std::iota(all.begin(), all.end(), 0);
      return all;
    }
    case Location::Kind::Node:
      if (at.node < count && at.node >= -count) {
        return std::vector<int>{at.node < 0 ? at.node + count : at.node};
      }
      diagnostics.add(path,
                      fmt::format("the rod has no node {}: its nodes are 0 to {} (or, from the "
                                  "end, -1 to -{})",
                                  at.node, count - 1, count));
      return std::nullopt;
    case Location::Kind::Middle:
      s = line.arc_length_of(at);
      break;
    case Location::Kind::ArcLength:
      if (at.arc_length > line.length() + line.same_place()) {
        diagnostics.add(path, fmt::format("arc length {} m lies beyond the rod's length, {:.9g} m",
                                          at.arc_length, line.length()));
        return std::nullopt;
      }
      at.arc_length = std::min(at.arc_length, line.length());
      s = at.arc_length;
      break;
  }
  if (const std::optional<int> node = line.node_at(s)) return std::vector<int>{*node};
  if (!needs_node) return std::vector<int>{};
  diagnostics.add(path, no_node_there(line, at, s));
  return std::nullopt;
}

bool does_not_bend(const Rod& rod) {
  const auto* direct = std::get_if<Stiffness>(&rod.cross_section);
  return direct != nullptr && (direct->EI ? direct->EI : direct->EI2) == 0.0;
}

void check_scene(SceneText& scene, Diagnostics& diagnostics) {
  if (diagnostics.vectors_differ()) return;
  scene.in_space = diagnostics.dimension() == 3;
  CheckContext context{scene, diagnostics};
  if (!fit_into_memory(context)) return;
  check_rods(context);
  place_leg_ends(context);
  check_joints(context);
  check_axial_springs(context);
  check_supports(context);
  if (diagnostics.size() == 0) {
    context.dimension = choose_model(scene).kind == ModelChoice::Planar ? 2 : 3;
  }
  check_springs(context);
  check_free_nodes(context);
  check_loads(context);
  check_actuations(context);
  check_names(context);
  check_time(context);
  check_probes(context);
  if (diagnostics.size() > 0) return;
  check_resolution(context);
  if (diagnostics.size() > 0) return;
  const ChosenModel model = choose_model(scene);
  check_model(scene, model, diagnostics);
  if (diagnostics.size() > 0) return;
  if (scene.joints.empty()) check_cells(context, model.kind);
  warn_of_touching_rods(context);
  warn_of_turned_damping(context);
  if (std::string problem = unit_problem(scene); !problem.empty()) {
    scene.warnings.push_back(std::move(problem));
  }
  count_along_edges(context);
  conform(scene, model.kind);
}

}  // namespace der::scenario
