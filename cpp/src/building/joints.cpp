#include "building/joints.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <variant>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/kinematics/section_frame.hpp"
#include "der/model/frames.hpp"
#include "der/model/location.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "model/corner.hpp"
#include "model/legs.hpp"
#include "model/reference_edge.hpp"
#include "scenario/rest_line.hpp"
#include "supports/leg_clamp.hpp"

namespace der {
namespace {

/// The parts that the nodes of one rod play.
struct RodPoints {
  std::vector<bool> ends_leg;
  std::vector<bool> turns;  ///< whether something holds or loads the rotation there
  std::vector<int> joint;   ///< number in the scene; -1: none
};

/// Whether the rods of a joint have rotations there of which something is asked.
bool turns_rods(const scenario::Scene& scene, const scenario::Joint& joint) {
  const auto has_moment = [&](const scenario::Load& load) {
    const auto* moment = std::get_if<scenario::Moment>(&load.what);
    return moment != nullptr && moment->joint == joint.name;
  };
  // A rotation of its own counts whole turns.
  const auto reads_angle = [&](const scenario::Probe& probe) {
    return probe.joint && *probe.joint == joint.name && probe.quantity == "angle";
  };
  const auto& probes = scene.output.probes;
  return joint.has_sides() || std::any_of(scene.loads.begin(), scene.loads.end(), has_moment) ||
         std::any_of(probes.begin(), probes.end(), reads_angle);
}

RodPoints points_of(const scenario::Scene& scene, const RodMesh& rod, const Model& model) {
  const std::size_t count = rod.nodes.size();
  RodPoints points{std::vector<bool>(count), std::vector<bool>(count), std::vector<int>(count, -1)};
  points.ends_leg.front() = true;
  if (!rod.closed) points.ends_leg.back() = true;
  const auto enter = [&](const std::string& name, const scenario::Location& at, bool turns) {
    if (name != rod.name) return;
    const bool all = at.kind == scenario::Location::Kind::All;
    for (const Index place : nodes_at(at, rod)) {
      if (!all || turns) points.ends_leg[to_size(place)] = true;
      if (turns) points.turns[to_size(place)] = true;
    }
  };
  for (const auto& support : scene.supports) {
    const bool turns =
        support.clamps() || (support.spring && !support.spring->rotational_stiffness.empty());
    enter(support.rod, support.at, turns);
  }
  for (const auto& load : scene.loads) {
    if (const auto* force = std::get_if<scenario::PointForce>(&load.what)) {
      enter(force->rod, force->at, force->follower);
    } else if (const auto* moment = std::get_if<scenario::Moment>(&load.what)) {
      enter(moment->rod, moment->at, true);
    }
  }
  for (const auto& actuation : scene.actuations) {
    if (actuation.rod != rod.name || actuation.what == scenario::Actuated::Length) continue;
    for (const double s : {actuation.from, actuation.to}) {
      scenario::Location at;
      at.kind = scenario::Location::Kind::ArcLength;
      at.arc_length = s;
      enter(rod.name, at, false);
    }
  }
  const bool is_planar = model.dimension == 2;
  for (const Index place : is_planar ? leg_bounds(rod, model) : corners_of(rod, model)) {
    points.ends_leg[to_size(place)] = true;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (rod.sphere_radius[i] > 0.0) points.ends_leg[i] = true;
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const bool turns = turns_rods(scene, scene.joints[j]);
    for (const auto& member : scene.joints[j].of) {
      if (turns) enter(member.rod, member.at, true);
      if (member.rod != rod.name) continue;
      const std::size_t place = to_size(node_at(member.at, rod));
      points.joint[place] = static_cast<int>(j);
      points.ends_leg[place] = true;
    }
  }
  return points;
}

/// Ends legs beside their ends where two cells there are of unlike lengths, too: the end of a leg
/// is one for cells that are nearly equal.
void end_uneven_legs(const RodMesh& rod, std::vector<bool>& ends_leg) {
  constexpr double kMost = 2.0;
  const Index last = rod.num_edges();
  const auto length = [&](Index edge) { return rod.edge_length[to_size(rod.position(edge))]; };
  const auto ends = [&](Index place) -> std::vector<bool>::reference {
    return ends_leg[to_size(rod.position(place))];
  };
  const auto is_uneven = [&](Index place) {
    const double ratio = length(place) / length(place - 1);
    return ratio > kMost || ratio * kMost < 1.0;
  };
  for (Index place = 1; place < last; ++place) {
    if (ends(place - 1) && is_uneven(place)) ends(place) = true;
  }
  for (Index place = last - 1; place > 0; --place) {
    if (ends(place + 1) && is_uneven(place)) ends(place) = true;
  }
}

/// Gives joints their rotations. The rods of a rigid joint follow one; each other node of a rod has
/// one of its own.
class Rotations {
 public:
  Rotations(const scenario::Scene& scene, const Model& model) : scene_(scene), model_(model) {}

  /// That of a rod at one of its nodes where a leg ends; -1: the rod needs none there.
  Index of(std::size_t rod, Index place, const RodPoints& points) {
    const RodMesh& mesh = model_.rods[rod];
    if (mesh.EI == 0.0 && mesh.EI_1 == 0.0) return -1;
    const int joint = points.joint[to_size(place)];
    const bool rigid = joint >= 0 && scene_.joints[to_size(joint)].shares_rotation();
    if (!rigid && !mesh.is_inner(place) && !points.turns[to_size(place)]) return -1;
    const auto key = rigid ? std::tuple<Index, Index>(-1, joint)
                           : std::tuple<Index, Index>(static_cast<Index>(rod), place);
    const auto [known, is_new] = numbers_.emplace(key, static_cast<Index>(nodes_.size()));
    if (is_new) nodes_.insert(nodes_.end(), model_.dimension == 3 ? 3 : 1, mesh.node(place));
    return known->second;
  }
  /// The node of each rotation, in space of each of its three coordinates.
  [[nodiscard]] const std::vector<Index>& nodes() const { return nodes_; }

 private:
  const scenario::Scene& scene_;
  const Model& model_;
  std::map<std::tuple<Index, Index>, Index> numbers_;
  std::vector<Index> nodes_;
};

/// The part of the turn at the node next to an end of a leg by which its outermost edge leans
/// against the drawn tangent at the end: half of the turn from one node to the next.
double share_of_turn(const RodMesh& rod, Index edge, Index node) {
  return 0.5 * rod.edge_length[to_size(edge)] / rod.voronoi_length(node);
}

/// Angle [rad] of the drawn tangent at an end of a leg.
double tangent_direction(const RodMesh& rod, const Leg& leg, bool at_end, const Model& model) {
  const Index edge = at_end ? leg.last - 1 : leg.first;
  const Vec2 vector = reference_edge(rod, edge, model);
  const double direction = std::atan2(vector.y(), vector.x());
  if (leg.last - leg.first == 1) return direction;
  const Index node = at_end ? leg.last - 1 : leg.first + 1;
  const double turn =
      angle_between(reference_edge(rod, node - 1, model), reference_edge(rod, node, model));
  const double half = share_of_turn(rod, edge, node) * turn;
  return at_end ? direction + half : direction - half;
}

/// How far the edges of a leg turn as drawn [rad].
double reference_turn(const RodMesh& rod, const Leg& leg, const Model& model) {
  double turn = 0.0;
  for (Index node = leg.first + 1; node < leg.last; ++node) {
    turn += angle_between(reference_edge(rod, node - 1, model), reference_edge(rod, node, model));
  }
  return turn;
}

/// The drawn section at an end of a leg in space.
SectionFrame section_at_end(const RodMesh& rod, const Leg& leg, bool at_end, const Model& model) {
  const Index edge = at_end ? leg.last - 1 : leg.first;
  Vec3 tangent = reference_edge<3>(rod, edge, model).normalized();
  if (leg.last - leg.first > 1) {
    const Index node = at_end ? leg.last - 1 : leg.first + 1;
    const Vec3 before = reference_edge<3>(rod, node - 1, model);
    const Vec3 after = reference_edge<3>(rod, node, model);
    const Vec3 axis = before.cross(after);
    const double sine = axis.norm();
    if (sine > 0.0) {
      const double half = share_of_turn(rod, edge, node) * std::atan2(sine, before.dot(after));
      tangent = Eigen::AngleAxisd(at_end ? half : -half, axis / sine) * tangent;
    }
  }
  return reference_section_at_end(rod, edge, at_end, tangent);
}

/// The first node of each edge that has an angle.
std::vector<Index> edge_starts(const Model& model) {
  std::vector<Index> starts;
  for (const RodMesh& rod : model.rods) {
    for (Index edge = 0; model.has_sections() && edge < rod.num_edges(); ++edge) {
      starts.push_back(rod.node(edge));
    }
  }
  return starts;
}

/// Enters the rotations of joints in space behind the frames of the edges.
void draw_joints(Model& model) {
  if (model.dimension != 3) return;
  const Index frames = static_cast<Index>(model.initial_frames.size());
  const Index joints = model.dofs.num_rotations() / 3;
  model.initial_frames.conservativeResize(frames + JointBlock::kSize * joints);
  for (Index joint = 0; joint < joints; ++joint) {
    const Index first = joint_block(model, 3 * joint).first;
    model.initial_frames.segment<JointBlock::kSize>(first) << 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0;
  }
}

}  // namespace

std::vector<std::vector<JoinedPlace>> joined_places(const scenario::Scene& scene) {
  std::vector<std::vector<JoinedPlace>> joints;
  for (const auto& joint : scene.joints) {
    auto& places = joints.emplace_back();
    for (const auto& member : joint.of) {
      const auto rod = std::find_if(scene.rods.begin(), scene.rods.end(),
                                    [&](const auto& other) { return other.name == member.rod; });
      const scenario::RestLine line(rod->points, rod->closed, rod->rest_length);
      places.push_back({static_cast<std::size_t>(rod - scene.rods.begin()),
                        *line.node_at(line.arc_length_of(member.at))});
    }
  }
  return joints;
}

void find_joints(const scenario::Scene& scene, Model& model) {
  if (scene.joints.empty()) return;
  Rotations rotations(scene, model);
  for (std::size_t i = 0; i < model.rods.size(); ++i) {
    RodMesh& rod = model.rods[i];
    RodPoints points = points_of(scene, rod, model);
    end_uneven_legs(rod, points.ends_leg);
    Leg leg;
    // The last leg of a ring ends where the first one starts.
    for (Index place = 0; place <= rod.num_edges(); ++place) {
      if (!points.ends_leg[to_size(rod.position(place))]) continue;
      const Index rotation = rotations.of(i, rod.position(place), points);
      if (place > 0) {
        leg.last = place;
        leg.end.rotation = rotation;
        for (const bool at_end : {false, true}) {
          LegEnd& end = at_end ? leg.end : leg.start;
          if (model.dimension == 3) {
            end.section = section_at_end(rod, leg, at_end, model);
          } else {
            // Whole turns count along the rod.
            const double near = at_end ? leg.start.direction + reference_turn(rod, leg, model)
                                : rod.legs.empty() ? 0.0
                                                   : rod.legs.back().end.direction;
            end.direction = nearest_turn(tangent_direction(rod, leg, at_end, model), near);
          }
        }
        rod.legs.push_back(leg);
      }
      leg = {};
      leg.first = leg.last = place;
      leg.start.rotation = rotation;
    }
  }
  const double length = model.dofs.length();
  model.dofs = DofMap(model.dimension, model.num_nodes, edge_starts(model), rotations.nodes());
  model.dofs.set_length(length);
  for (const RodMesh& rod : model.rods) {
    if (rod.closed) model.dofs.close(rod.nodes);
  }
  draw_joints(model);
  for (Vector* v : {&model.initial_positions, &model.reference_positions, &model.initial_velocities,
                    &model.mass.lumped, &model.damping, &model.gravity_force, &model.dead_force}) {
    v->conservativeResize(model.num_dofs());
    v->tail(model.dofs.num_rotations()).setZero();
  }
}

}  // namespace der
