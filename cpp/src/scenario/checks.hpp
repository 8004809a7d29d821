#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "der/scenario/model_choice.hpp"
#include "scenario/rest_line.hpp"
#include "scenario/scene_text.hpp"

/// The checks that tie several keys of a scene together. Each skips what could not be read, so that
/// one mistake does not cause a second diagnostic.
namespace der::scenario {

/// The components of a node that supports can hold: of its position, and the angle of the tangent.
enum class Hold { X, Y, Z, Angle };
inline constexpr std::array kHolds{Hold::X, Hold::Y, Hold::Z, Hold::Angle};

/// The `Hold` of a component of the position.
Hold hold_of(Component component);
/// "x", or "the angle".
const char* name_of(Hold hold);

/// The components of a node that supports hold.
class HeldNode {
 public:
  /// Number of the support that holds it; none: no support does.
  [[nodiscard]] std::optional<int> holder(Hold hold) const { return by_[slot(hold)]; }
  [[nodiscard]] bool holds(Hold hold) const { return holder(hold).has_value(); }
  void enter(Hold hold, int support) { by_[slot(hold)] = support; }

 private:
  static std::size_t slot(Hold hold) { return static_cast<std::size_t>(hold); }
  std::array<std::optional<int>, kHolds.size()> by_;
};

/// Those that a joint joins with a node, by their keys.
struct JoinedNode {
  bool rigid = true;
  std::vector<std::int64_t> others;
};

/// Everything that the checks share.
struct CheckContext {
  SceneText& scene;
  Diagnostics& diagnostics;
  std::vector<std::optional<RestLine>> lines{};  ///< by rod; none where the rod has mistakes
  std::unordered_map<std::string, int> rods{};   ///< number of the rod with a name
  std::unordered_map<std::int64_t, HeldNode> held{};
  std::unordered_map<std::int64_t, JoinedNode> joined{};  ///< of nodes that are in joints
  /// Components of the motion of nodes: 2 in the planar model, else 3. Where the scene has mistakes
  /// nobody knows the model: 2, so that no further mistake is seen where there is none.
  int dimension = 2;

  [[nodiscard]] static std::int64_t node_key(int rod, int node) {
    return (std::int64_t{rod} << 32) | node;
  }
  /// Null where no support holds the node.
  [[nodiscard]] const HeldNode* held_at(int rod, int node) const;
  [[nodiscard]] bool is_clamped(int rod, int node) const;
  /// The support that clamps the node; null where none does.
  [[nodiscard]] const Support* clamp_at(int rod, int node) const;
  /// Whether supports hold all components of its position.
  [[nodiscard]] bool is_fixed(int rod, int node) const;

  /// The rod with this name, if its geometry is known; reports at `path` where there is none.
  std::optional<int> find_rod(const std::string& name, const Path& path);
  /// The nodes that a location names, none for a place between nodes. Reports at `path` a
  /// place that the rod does not have and, with `needs_node`, one between nodes.
  std::optional<std::vector<int>> nodes_at(int rod, Location& at, const Path& path,
                                           bool needs_node);
};

/// Whether a rod has no stiffness against bending, EI.
bool does_not_bend(const Rod& rod);

/// A line of text asks for a million nodes: reports the rod with which all together are too many,
/// if there is one, and returns whether there is none. Nothing else is to be checked then.
bool fit_into_memory(CheckContext& context);
/// Checks the rods by themselves and completes `Scene::rods`.
void check_rods(CheckContext& context);
/// Moves the nodes of straight rods in a scene with joints to where anything acts at a point, so
/// that legs end there (leg_mesh.cpp); reports rods with too few nodes.
void place_leg_ends(CheckContext& context);
/// Makes arc lengths along the curves of rods those along their edges, as the model counts them.
void count_along_edges(CheckContext& context);
/// The joint of this name; null, and a report at `path`, where there is none.
const Joint* find_joint(CheckContext& context, const std::string& name, const Path& path);
/// That the rods of each joint meet, and that this version has all that a scene with joints needs.
void check_joints(CheckContext& context);
/// That springs between joints have two, and a direction.
void check_axial_springs(CheckContext& context);
/// Reports a table in statics.
void check_constant(CheckContext& context, bool constant, const Path& path);
/// Reports a prescribed motion that has a table in statics, or that begins a run with a jump.
void check_motion(CheckContext& context, const Series& motion, const Path& path);
/// All but the springs, which depend on what other supports hold.
void check_supports(CheckContext& context);
void check_springs(CheckContext& context);
/// Masses and bending, which depend on the supports.
void check_free_nodes(CheckContext& context);
void check_loads(CheckContext& context);
void check_actuations(CheckContext& context);
/// That no two parts of the scene which programs call by name have the same.
void check_names(CheckContext& context);
/// Whether what a continuation varies is there.
void check_continuation(CheckContext& context);
void check_time(CheckContext& context);
void check_probes(CheckContext& context);
/// Checks that the model that the scene asks for can represent it, and that this version has in
/// the chosen model all that the scene needs.
void check_model(const SceneText& scene, const ChosenModel& model, Diagnostics& diagnostics);
/// Reports what this version does not have in a model (check_spatial.cpp).
void check_availability(const SceneText& scene, ModelChoice kind, Diagnostics& diagnostics);
/// Reports natural shapes that a mesh cannot take, and warns of those that it hardly resolves.
void check_resolution(CheckContext& context);
/// Warns of what turns a rod, or turns with it, so near another that the mesh does not part the
/// two.
void check_cells(CheckContext& context, ModelChoice model);
/// Warns of a clamp that rotates a rod with internal damping over time, unless the integrator has
/// moments there as accurate as motions.
void warn_of_turned_damping(CheckContext& context);
/// Warns of ends of rods that lie on a node: nothing joins them, unless supports hold both.
void warn_of_touching_rods(CheckContext& context);

}  // namespace der::scenario
