#include "der/output/start.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

#include "der/building/builder.hpp"
#include "der/core/constants.hpp"
#include "der/model/location.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/output/io_error.hpp"
#include "der/output/run_folder.hpp"
#include "der/output/saved_run.hpp"
#include "der/scenario/scenario.hpp"
#include "der/scenario/series.hpp"
#include "der/scenario/support.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "der/supports/written_turns.hpp"

namespace der {
namespace {

namespace fs = std::filesystem;

/// Rest lengths closer than this share of a rod's length are the same: texts have that many digits.
constexpr double kSameAngle = 1e-6;  // [rad]
constexpr double kSameLength = 1e-6;

std::string names_of(const std::vector<SavedRod>& rods) {
  std::string names;
  for (const SavedRod& rod : rods) names += (names.empty() ? "'" : ", '") + rod.name + "'";
  return names;
}

/// Describes how a rod differs; empty if it does not.
std::string difference(const SavedRod& there, const RodMesh& here) {
  if (there.nodes.size() != here.nodes.size()) {
    return fmt::format("rod '{}' has {} nodes there and {} here", here.name, there.nodes.size(),
                       here.nodes.size());
  }
  if (there.nodes != here.nodes) {
    return fmt::format(
        "the nodes of rod '{}' begin with number {} there and {} here: list the "
        "rods in the same order",
        here.name, there.nodes.front(), here.nodes.front());
  }
  if (there.closed != here.closed) {
    return fmt::format("rod '{}' is {} there and {} here", here.name,
                       there.closed ? "closed" : "open", here.closed ? "closed" : "open");
  }
  const double length = here.arc_length.back();
  const double before = there.arc_length.back();
  const double allowed = kSameLength * length;
  if (std::abs(before - length) > allowed) {
    return fmt::format("rod '{}' is {:.6g} m long there and {:.6g} m here", here.name, before,
                       length);
  }
  for (std::size_t i = 0; i < here.arc_length.size(); ++i) {
    if (std::abs(there.arc_length[i] - here.arc_length[i]) > allowed) {
      return fmt::format("node {} of rod '{}' is at {:.6g} m along it there and at {:.6g} m here",
                         i, here.name, there.arc_length[i], here.arc_length[i]);
    }
  }
  return {};
}

std::string difference(const std::vector<SavedRod>& there, const std::vector<RodMesh>& here) {
  for (const RodMesh& rod : here) {
    const auto same = std::find_if(there.begin(), there.end(),
                                   [&](const SavedRod& saved) { return saved.name == rod.name; });
    if (same == there.end()) {
      return fmt::format("it has no rod '{}' but {}", rod.name, names_of(there));
    }
    std::string found = difference(*same, rod);
    if (!found.empty()) return found;
  }
  if (there.size() == here.size()) return {};
  return fmt::format("it has {} rods, {}, and this scene {}", there.size(), names_of(there),
                     here.size());
}

/// Throws IoError where supports hold a node of a run over time elsewhere than it is in that frame:
/// it would begin with a jump.
void check_held_nodes(const std::string& from, const LastFrame& last, const Model& model,
                      const State& state) {
  constexpr double kSame = 1e-6;  // of the rod's length
  for (const RodMesh& rod : model.rods) {
    for (Index place = 0; place < static_cast<Index>(rod.nodes.size()); ++place) {
      const Index dof = model.dof(rod.node(place), 0);
      const double jump = (state.positions.segment(dof, model.dimension) -
                           last.positions.segment(dof, model.dimension))
                              .norm();
      if (jump <= kSame * rod.rest_length()) continue;
      const Vector there = last.positions.segment(dof, model.dimension);
      throw IoError(fmt::format(
          "start_from: the supports hold node {} of rod '{}' {:.3g} m from where it is in the last "
          "frame of '{}', ({}): the run would begin with a jump. Let the tables of 'prescribe' "
          "begin there; supports without a table hold nodes as they are drawn",
          place, rod.name, jump, from, fmt::join(there.begin(), there.end(), ", ")));
    }
  }
}

/// How a clamp has turned by its tables from where it is drawn.
struct ClampTurn {
  double angle = 0.0;                ///< in a plane [rad]
  Mat3 rotation = Mat3::Identity();  ///< in space, of the section if it is held
  double winding = 0.0;              ///< about the tangent, whole turns included [rad]
  bool may_be_moved = false;         ///< by a program: a table holds it as drawn
  bool holds_section = false;        ///< in space
};

ClampTurn turn_of(const scenario::Support& clamp, double time, const Vec3& tangent) {
  ClampTurn turn;
  turn.holds_section = clamp.clamp == scenario::Clamp::Section;
  if (clamp.rotation) turn.angle = value_at(*clamp.rotation, time);
  if (clamp.twist) turn.winding = value_at(*clamp.twist, time);
  turn.rotation = Eigen::AngleAxisd(turn.winding, tangent);
  if (clamp.axis_rotation) {
    const Vec3 axis = Eigen::Map<const Vec3>(clamp.axis_rotation->axis.data()).stableNormalized();
    const double angle = value_at(clamp.axis_rotation->angle, time);
    turn.rotation = Eigen::AngleAxisd(angle, axis) * turn.rotation;
    turn.winding += angle * axis.dot(tangent);
  }
  const bool has_table = clamp.rotation || clamp.twist || clamp.axis_rotation;
  turn.may_be_moved = has_table && turn.angle == 0.0 && turn.rotation.isIdentity(0.0);
  return turn;
}

/// By how much the two hold the rod otherwise [rad], which may be by whole turns about the tangent.
double difference(const ClampTurn& a, const ClampTurn& b, const Vec3& tangent) {
  const Mat3 between = a.rotation.transpose() * b.rotation;
  double difference = std::abs(a.angle - b.angle);
  if (a.holds_section && b.holds_section) {
    difference += Eigen::AngleAxisd(between).angle();
    if (const double wound = std::abs(a.winding - b.winding); wound > kPi) difference += wound;
  } else {
    difference +=
        std::atan2(tangent.cross(between * tangent).norm(), tangent.dot(between * tangent));
  }
  return difference;
}

/// Throws IoError where a clamp of a run over time begins turned otherwise than the same clamp was
/// in that frame, by their tables. What these hold as drawn there a program may have turned.
void check_clamps(const std::string& from, const LastFrame& last, const Simulation& simulation) {
  const Scenario before = Scenario::parse(last.scene);
  const auto& analysis = before.scene().analysis;
  if (std::holds_alternative<scenario::ContinuationAnalysis>(analysis))
    return;  // times are factors
  const Model& model = simulation.model();
  for (const scenario::Support& clamp : simulation.scenario().scene().supports) {
    if (!clamp.clamps()) continue;
    const RodMesh& rod = model.rod(clamp.rod);
    const std::vector<Index> places = nodes_at(clamp.at, rod);
    const Vec3 tangent =
        model.dimension == 3 ? initial_tangent(rod, places.front(), model) : Vec3(Vec3::UnitX());
    for (const scenario::Support& other : before.scene().supports) {
      if (!other.clamps() || other.rod != clamp.rod || nodes_at(other.at, rod) != places) continue;
      const ClampTurn was = turn_of(other, last.time, tangent);
      const double jump = difference(was, turn_of(clamp, 0.0, tangent), tangent);
      if (was.may_be_moved || jump <= kSameAngle) continue;
      throw IoError(fmt::format(
          "start_from: a clamp of rod '{}' begins {:.3g} rad from how it was turned in the last "
          "frame of '{}': the run would begin with a jump. Let the tables of its 'prescribe' begin "
          "with the values that they have there",
          clamp.rod, jump, from));
    }
  }
}

/// The same for a driven hinge, and where it was not driven there.
void check_hinges(const std::string& from, const LastFrame& last, const Simulation& simulation) {
  const Scenario before = Scenario::parse(last.scene);
  if (std::holds_alternative<scenario::ContinuationAnalysis>(before.scene().analysis))
    return;  // times are factors
  for (const scenario::Joint& hinge : simulation.scenario().scene().joints) {
    if (!hinge.prescribe) continue;
    const auto& others = before.scene().joints;
    const auto other =
        std::find_if(others.begin(), others.end(),
                     [&](const scenario::Joint& joint) { return joint.name == hinge.name; });
    if (other == others.end()) continue;
    if (other->kind == scenario::JointKind::Hinge && !other->prescribe) {
      throw IoError(fmt::format(
          "start_from: hinge '{}' turned freely in '{}', and a prescribed angle would begin with a "
          "jump. Prescribe it there, too",
          hinge.name, from));
    }
    const double was = other->prescribe ? value_at(other->prescribe->angle, last.time) : 0.0;
    const double begins = value_at(hinge.prescribe->angle, 0.0);
    const bool may_be_moved = other->prescribe && was == 0.0;
    if (may_be_moved || std::abs(begins - was) <= kSameAngle) continue;
    throw IoError(fmt::format(
        "start_from: hinge '{}' begins at an angle of {:.3g} rad, and it was at {:.3g} rad in the "
        "last frame of '{}': the run would begin with a jump. Let the table of its 'prescribe' "
        "begin with that",
        hinge.name, begins, was, from));
  }
}

/// The angle [rad] by which a clamp in space is rotated about `axis` at a time, if it is about this
/// axis that it turns, and how far it is twisted.
struct SpatialTurn {
  double angle = 0.0;
  double twist = 0.0;
};

std::optional<SpatialTurn> spatial_turn(const scenario::Support& clamp, double time,
                                        const Vec3& axis) {
  constexpr double kSameAxis = 1e-12;
  SpatialTurn turn;
  if (clamp.twist) turn.twist = value_at(*clamp.twist, time);
  Vec3 own = Vec3::UnitZ();
  if (clamp.axis_rotation) {
    own = Eigen::Map<const Vec3>(clamp.axis_rotation->axis.data()).stableNormalized();
    turn.angle = value_at(clamp.axis_rotation->angle, time);
  } else if (clamp.rotation) {
    turn.angle = value_at(*clamp.rotation, time);
  }
  if (turn.angle == 0.0) return turn;
  if (own.cross(axis).norm() > kSameAxis) return std::nullopt;
  if (own.dot(axis) < 0.0) turn.angle = -turn.angle;
  return turn;
}

/// The ways of the clamps in space of a static scene from where the tables of that run had turned
/// them: the rods have followed them there.
std::vector<Ramp> ways_of_clamps(const LastFrame& last, const Simulation& simulation) {
  const Model& model = simulation.model();
  const Scenario before = Scenario::parse(last.scene);
  if (model.dimension != 3 || simulation.scenario().scene().is_dynamic() || model.load_variation ||
      std::holds_alternative<scenario::ContinuationAnalysis>(before.scene().analysis)) {
    return {};
  }
  std::vector<Ramp> ways;
  const double time = simulation.state().time;
  for (const RodMesh& rod : model.rods) {
    for (const Clamp& clamp : rod.clamps) {
      for (const scenario::Support& other : before.scene().supports) {
        if (!other.clamps() || other.rod != rod.name) continue;
        const std::vector<Index> places = nodes_at(other.at, rod);
        if (std::find(places.begin(), places.end(), clamp.place) == places.end()) continue;
        const auto was = spatial_turn(other, last.time, clamp.held.axis);
        if (!was) continue;
        const auto add = [&](Index control, double from) {
          if (control < 0) return;
          const double to = control_value(model, simulation.state(), control);
          if (from != to) ways.push_back({control, time, time, from, to});
        };
        add(clamp.held.rotation, was->angle);
        add(clamp.held.twist, was->twist);
      }
    }
  }
  return ways;
}

bool follows_edges_of(const LastFrame& last, const Model& model) {
  if (last.turns.size() != num_turns(model)) return false;
  const Model there = build_model(Scenario::parse(last.scene).scene());
  return std::equal(there.followed_edges.begin(), there.followed_edges.end(),
                    model.followed_edges.begin(), model.followed_edges.end(),
                    [](const FollowedEdge& a, const FollowedEdge& b) {
                      return a.edge.first == b.edge.first && a.edge.last == b.edge.last;
                    });
}

/// Takes over whole turns if that run followed the same edges; else they count from its shape.
/// Angles of edges count from the frames of sections, which come with them.
void take_over_turns(const LastFrame& last, const Model& model, State& state) {
  if (last.section_frames.size() > 0) edge_frames(model, state.followed) = last.section_frames;
  if (model.has_rotations() && last.turns.size() == num_saved_turns(model)) {
    return restore_turns(model, last.turns, state);
  }
  if (!follows_edges_of(last, model)) return follow_written(model, state);
  state.followed.head(last.turns.size()) = last.turns;
  follow(model, state);
}

LastFrame read_start(const std::string& from) {
  const RunFolder folder{fs::path(from)};
  std::error_code error;
  if (!fs::exists(folder.results(), error)) {
    throw IoError(fmt::format(
        "start_from: there is no run in '{}': no file '{}'. The path counts from the folder in "
        "which the program runs, '{}'. Name the folder that a run was written to, or 'equilibrium'",
        from, folder.results().string(), fs::current_path(error).string()));
  }
  try {
    return read_last_frame(folder.results());
  } catch (const IoError& failure) {
    throw IoError(std::string("start_from: ") + failure.what());
  }
}

}  // namespace

void apply_start(Simulation& simulation, const CancelCallback& beat) {
  const std::string& from = simulation.scenario().scene().start_from;
  if (from.empty()) return;
  if (from == "equilibrium") {
    simulation.settle(true, beat);
    simulation.check_first_step();
    return;
  }
  const LastFrame last = read_start(from);
  const Model& model = simulation.model();
  const std::string found = difference(last.rods, model.rods);
  if (!found.empty()) {
    throw IoError(fmt::format(
        "start_from: the run in '{}' is not one of the same rods: {}. Give the scene the rods of "
        "that run ('{}'), or run that scene with these rods first",
        from, found, RunFolder(from).scene().string()));
  }
  if (last.model != model.name) {
    throw IoError(fmt::format(
        "start_from: the run in '{}' is one of the model '{}', and this scene is one of the model "
        "'{}' ({}). Write 'model: {}' in this scene, or in that one and run it again",
        from, last.model, model.name, model.reason, last.model));
  }
  State& state = simulation.state();
  state.positions.head(last.positions.size()) = last.positions;
  state.velocities.head(last.velocities.size()) = last.velocities;
  // Supports are where this scene has them. The search for an equilibrium takes them there itself,
  // in steps: at once they might fold the edges beside them.
  if (simulation.scenario().scene().is_dynamic()) {
    Vector controls;
    model.tables.evaluate(state.time, controls);
    apply_prescribed_motion(model, controls, state.positions);
    check_held_nodes(from, last, model, state);
    check_clamps(from, last, simulation);
    check_hinges(from, last, simulation);
  }
  // Frames are followed with the clamps as they were.
  state.ramps = ways_of_clamps(last, simulation);
  for (Ramp& way : state.ramps) way.end = way.start + 1.0;
  take_over_turns(last, model, state);
  for (Ramp& way : state.ramps) way.end = way.start;
  simulation.start_anew();
  simulation.check_first_step();
}

}  // namespace der
