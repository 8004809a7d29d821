#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"
#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

/// Members of a joint may be apart by this share of the longest of their rods, by rounding.
constexpr double kApart = 1e-9;
/// Their initial velocities may differ by this share of the largest of their rods.
constexpr double kSlower = 1e-9;

Path joint_path(int joint) { return {"joints", joint}; }

/// A node of a rod.
struct Member {
  int rod = 0;
  int node = 0;
};

class JointCheck {
 public:
  explicit JointCheck(CheckContext& context) : context_(context) {}

  void run() {
    for (int i = 0; i < static_cast<int>(context_.scene.joints.size()); ++i) {
      if (!context_.diagnostics.under(joint_path(i))) check(i);
    }
  }

 private:
  void check(int number) {
    Joint& joint = joint_of(number);
    std::vector<Member> members;
    for (int k = 0; k < static_cast<int>(joint.of.size()); ++k) {
      const auto member = find(number, k);
      if (!member) return;
      members.push_back(*member);
    }
    if (!meet(number, members)) return;
    if (joint.kind != JointKind::Rigid && members.size() < 2) {
      report(joint_path(number) / "kind",
             fmt::format("{} joins rods, and there is one: name another in 'of', or remove 'kind'",
                         in_words(joint.kind)));
    }
    check_sides(number, members);
    for (std::size_t k = 0; k < members.size(); ++k) enter(number, members, k);
  }

  std::optional<Member> find(int number, int k) {
    JointMember& member = joint_of(number).of[static_cast<std::size_t>(k)];
    const Path path = joint_path(number) / "of" / k;
    const std::optional<int> rod = context_.find_rod(member.rod, path / "rod");
    if (!rod) return std::nullopt;
    if (member.at.kind == Location::Kind::All) {
      report(path / "at", "'all' is not a single place, and rods are joined at one");
      return std::nullopt;
    }
    const auto nodes = context_.nodes_at(*rod, member.at, path / "at", true);
    if (!nodes) return std::nullopt;
    const Member found{*rod, nodes->front()};
    const auto known = joint_at_.find(CheckContext::node_key(found.rod, found.node));
    if (known != joint_at_.end()) {
      report(path,
             fmt::format("this place of rod '{}' is in joint '{}' already: name all rods that "
                         "meet at a point in one joint",
                         member.rod, joint_of(known->second).name));
      return std::nullopt;
    }
    joint_at_.emplace(CheckContext::node_key(found.rod, found.node), number);
    return found;
  }

  bool meet(int number, const std::vector<Member>& members) {
    const Components first = point_of(members.front());
    for (std::size_t k = 1; k < members.size(); ++k) {
      Components& here = point_of(members[k]);
      const double apart = distance(first, here);
      const double length = std::max(length_of(members.front()), length_of(members[k]));
      if (apart > kApart * length) {
        const Joint& joint = joint_of(number);
        report(joint_path(number) / "of" / static_cast<int>(k),
               fmt::format("rod '{}' is {:.6g} m away from rod '{}' at the joint: draw the rods so "
                           "that they meet",
                           joint.of[k].rod, apart, joint.of.front().rod));
        return false;
      }
      const double slower = distance(velocity_of(members[k]), velocity_of(members.front()));
      if (slower > kSlower * std::max(fastest(members[k].rod), fastest(members.front().rod))) {
        report(joint_path(number) / "of" / static_cast<int>(k),
               fmt::format("rods '{}' and '{}' begin with different velocities at the joint: give "
                           "both one 'initial_velocity' there",
                           joint_of(number).of.front().rod, joint_of(number).of[k].rod));
        return false;
      }
      here = first;
    }
    return true;
  }

  /// A spring, a damping or a drive acts between the two rods of a hinge.
  void check_sides(int number, const std::vector<Member>& members) {
    const Joint& joint = joint_of(number);
    if (!joint.has_sides() && !joint.prescribe) return;
    const Path path = joint_path(number) / (joint.prescribe ? "prescribe"
                                            : joint.spring  ? "spring"
                                                            : "damping");
    if (joint.kind == JointKind::Rigid) {
      report(path,
             "the rods of a rigid joint do not turn against one another: write 'kind: hinge', "
             "or remove it");
      return;
    }
    if (joint.kind == JointKind::Ball) {
      report(path, "this version has it between the rods of a hinge alone: remove it");
      return;
    }
    if (members.size() != 2) {
      report(path, fmt::format("acts between two rods, and {} meet in this hinge", members.size()));
      return;
    }
    for (const Member& member : members) {
      const Rod& rod = context_.scene.rods[static_cast<std::size_t>(member.rod)];
      if (!does_not_bend(rod)) continue;
      report(path, fmt::format("rod '{}' has no stiffness against bending, EI: it bears no moment",
                               rod.name));
    }
    if (joint.prescribe) check_drive(number, members, path);
  }

  /// A driven hinge has one rotation, which its second rod follows as far as it is turned.
  void check_drive(int number, const std::vector<Member>& members, const Path& path) {
    const Joint& joint = joint_of(number);
    if (joint.has_sides()) {
      report(path,
             "holds the angle, so that a spring or a damping does nothing: remove one of them");
    }
    check_motion(context_, joint.prescribe->angle, path / "angle");
    for (const Member& member : members) {
      const Rod& rod = context_.scene.rods[static_cast<std::size_t>(member.rod)];
      if (!damping_of(rod).any()) continue;
      report(path,
             fmt::format("this version does not have it beside a rod with internal damping, as "
                         "'{}' is",
                         rod.name));
    }
    const auto is_turned = [&](const std::string& rod, const Location& at) {
      return rod == joint.of[1].rod && is_at(members[1], at);
    };
    const auto& scene = context_.scene;
    for (int i = 0; i < static_cast<int>(scene.supports.size()); ++i) {
      const Support& support = scene.supports[static_cast<std::size_t>(i)];
      const bool holds =
          support.clamps() || (support.spring && !support.spring->rotational_stiffness.empty());
      if (holds && is_turned(support.rod, support.at)) report_turned(joint, {"supports", i});
    }
    for (int i = 0; i < static_cast<int>(scene.loads.size()); ++i) {
      const auto* force = std::get_if<PointForce>(&scene.loads[static_cast<std::size_t>(i)].what);
      if (force != nullptr && force->follower && is_turned(force->rod, force->at)) {
        report_turned(joint, {"loads", i, PointForce::kKey});
      }
      const auto* moment = std::get_if<Moment>(&scene.loads[static_cast<std::size_t>(i)].what);
      if (moment == nullptr || moment->joint != joint.name) continue;
      report(
          Path{"loads", i, Moment::kKey} / "joint",
          fmt::format("the angle of hinge '{}' is prescribed, so that a moment between its sides "
                      "does nothing: remove it, or 'prescribe'",
                      joint.name));
    }
  }
  void report_turned(const Joint& joint, const Path& path) {
    report(path,
           fmt::format("turns with rod '{}', which hinge '{}' turns against its other rod. "
                       "Name '{}' first in 'of' of the hinge, and prescribe the opposite angle",
                       joint.of[1].rod, joint.name, joint.of[1].rod));
  }
  bool is_at(const Member& member, const Location& at) {
    if (at.kind == Location::Kind::All) return true;
    const RestLine& line = *context_.lines[static_cast<std::size_t>(member.rod)];
    const bool is_node = at.kind == Location::Kind::Node;
    if (is_node && (at.node >= line.num_nodes() || at.node < -line.num_nodes())) return false;
    return line.node_at(line.arc_length_of(at)) == member.node;
  }

  /// Tells who else is at the place of a member.
  void enter(int number, const std::vector<Member>& members, std::size_t k) {
    JoinedNode joined{joint_of(number).shares_rotation(), {}};
    for (std::size_t other = 0; other < members.size(); ++other) {
      if (other == k) continue;
      joined.others.push_back(CheckContext::node_key(members[other].rod, members[other].node));
    }
    context_.joined.emplace(CheckContext::node_key(members[k].rod, members[k].node),
                            std::move(joined));
  }

  Joint& joint_of(int number) { return context_.scene.joints[static_cast<std::size_t>(number)]; }
  Components& point_of(const Member& member) {
    return context_.scene.rods[static_cast<std::size_t>(member.rod)]
        .points[static_cast<std::size_t>(member.node)];
  }
  Components velocity_of(const Member& member) {
    const Rod& rod = context_.scene.rods[static_cast<std::size_t>(member.rod)];
    return rod.initial_velocity.empty()
               ? Components(point_of(member).size(), 0.0)
               : rod.initial_velocity[static_cast<std::size_t>(member.node)];
  }
  /// The largest initial velocity of a rod's nodes [m/s].
  double fastest(int rod) {
    double fastest = 0.0;
    for (const Components& v :
         context_.scene.rods[static_cast<std::size_t>(rod)].initial_velocity) {
      fastest = std::max(fastest, distance(v, Components(v.size(), 0.0)));
    }
    return fastest;
  }
  double length_of(const Member& member) {
    return context_.lines[static_cast<std::size_t>(member.rod)]->length();
  }
  void report(const Path& where, const std::string& message) {
    context_.diagnostics.add(where, message);
  }

  CheckContext& context_;
  std::map<std::int64_t, int> joint_at_;
};

/// Reports what a scene with joints cannot have in this version.
class JointedSceneCheck {
 public:
  explicit JointedSceneCheck(CheckContext& context) : context_(context) {}

  void run() {
    const SceneText& scene = context_.scene;
    const bool in_space = context_.diagnostics.dimension() == 3;
    for (int i = 0; i < static_cast<int>(scene.joints.size()) && !in_space; ++i) {
      if (scene.joints[static_cast<std::size_t>(i)].kind != JointKind::Ball) continue;
      report(joint_path(i) / "kind", "in a plane a ball is a hinge: write 'hinge'");
    }
    if (in_space) check_in_space();
    const ModelChoice needed = in_space ? ModelChoice::Spatial : ModelChoice::Planar;
    if (scene.model != ModelChoice::Auto && scene.model != needed) {
      lacks({"model"}, fmt::format("'{}' with {} components", name_of(scene.model),
                                   in_space ? "three" : "two"));
    }
    for (int i = 0; i < static_cast<int>(scene.rods.size()); ++i) {
      check_rod(i);
    }
    for (int i = 0; i < static_cast<int>(scene.supports.size()); ++i) {
      Support& support = context_.scene.supports[static_cast<std::size_t>(i)];
      need_point(support.rod, support.at, Path{"supports", i} / "at");
    }
    for (int i = 0; i < static_cast<int>(scene.loads.size()); ++i) {
      std::visit(
          [&](auto& what) {
            using Kind = std::decay_t<decltype(what)>;
            if constexpr (std::is_base_of_v<AtPlace, Kind>) {
              need_point(what.rod, what.at, Path{"loads", i, Kind::kKey} / "at");
            }
            if constexpr (std::is_same_v<Kind, Moment>) need_bending(what.rod, i, Kind::kKey);
            if constexpr (std::is_same_v<Kind, PointForce>) {
              if (what.follower) need_bending(what.rod, i, Kind::kKey);
            }
          },
          context_.scene.loads[static_cast<std::size_t>(i)].what);
    }
    for (int i = 0; i < static_cast<int>(scene.actuations.size()); ++i) {
      const Actuation& actuation = scene.actuations[static_cast<std::size_t>(i)];
      if (actuation.what == Actuated::Length) continue;
      for (const auto& [key, s] : {std::pair{"from", actuation.from}, {"to", actuation.to}}) {
        Location at;
        at.kind = Location::Kind::ArcLength;
        at.arc_length = s;
        if (std::isfinite(s)) need_point(actuation.rod, at, Path{"actuation", i} / key);
      }
    }
    if (scene.is_dynamic() && scene.given_time.integrator == "energy_momentum") {
      lacks({"time", "integrator"}, "'energy_momentum'");
    }
  }

 private:
  void need_bending(const std::string& name, int load, const char* key) {
    const auto rod = context_.rods.find(name);
    if (rod == context_.rods.end()) return;
    if (!does_not_bend(context_.scene.rods[static_cast<std::size_t>(rod->second)])) return;
    report(
        Path{"loads", load, key},
        fmt::format("rod '{}' has no stiffness against bending, EI: it neither bears a moment nor "
                    "turns a force",
                    name));
  }
  /// On a rod drawn by points all that acts at a point, and each border of an actuation, is at one.
  void need_point(const std::string& name, Location& at, const Path& path) {
    const auto rod = context_.rods.find(name);
    if (rod == context_.rods.end() || context_.diagnostics.under(path)) return;
    const auto number = static_cast<std::size_t>(rod->second);
    if (!context_.lines[number] || context_.scene.given_rods[number].nodes) return;
    context_.nodes_at(rod->second, at, path, true);
  }

  /// Reports what joints in space lack besides.
  void check_in_space() {
    const SceneText& scene = context_.scene;
    for (int i = 0; i < static_cast<int>(scene.joints.size()); ++i) {
      const Joint& joint = scene.joints[static_cast<std::size_t>(i)];
      if (joint.kind == JointKind::Hinge) {
        lacks(joint_path(i) / "kind", "a hinge in space, but a 'ball',");
      }
    }
    for (int i = 0; i < static_cast<int>(scene.supports.size()); ++i) {
      const Support& support = scene.supports[static_cast<std::size_t>(i)];
      const Path path{"supports", i};
      if (support.clamp == Clamp::Tangent) lacks(path / "clamp", "'clamp: tangent' in space");
      if (support.axis_rotation && support.twist) {
        lacks(path / "prescribe", "a clamp in space with a 'rotation' and a 'twist'");
      }
    }
    if (!scene.actuations.empty()) lacks({"actuation"}, "actuations in space");
    if (std::holds_alternative<BucklingAnalysis>(scene.analysis)) {
      lacks({"analysis"}, "linear buckling in space");
    }
  }
  void check_rod(int number) {
    const Rod& rod = context_.scene.rods[static_cast<std::size_t>(number)];
    const Path path{"rods", number};
    if (context_.diagnostics.dimension() != 3) return;
    if (rod.closed) lacks(path / "closed", "a closed rod in space");
    if (damping_of(rod).any()) lacks(path, "internal damping in space");
  }
  void lacks(const Path& where, const std::string& what) {
    report(where, fmt::format("this version does not have {} in a scene with joints", what));
  }
  void report(const Path& where, const std::string& message) {
    context_.diagnostics.add(where, message);
  }

  CheckContext& context_;
};

}  // namespace

void check_joints(CheckContext& context) {
  if (context.scene.joints.empty()) return;
  JointCheck(context).run();
  JointedSceneCheck(context).run();
}

}  // namespace der::scenario
