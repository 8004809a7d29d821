#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "der/scenario/scenario.hpp"
#include "scenario/format.hpp"

/// The types that the tables read a text into, where the text has more forms than the scene.
namespace der::scenario {

/// One vector for all nodes, or one for each.
using Velocities = std::variant<std::monostate, Components, std::vector<Components>>;

/// `cross_section:`.
struct SectionText {
  CrossSection shape;
  std::optional<Components> director;
};

struct RodText : Rod {
  SectionText section;
  std::vector<Components> given_points;  ///< or:
  std::optional<int> nodes;
  std::optional<int> subdivide;
  Components from;
  Components to;
  Velocities given_velocity;
};

struct OutputText : Output {
  std::optional<double> given_every;
};

/// `step: auto`.
struct AutomaticStep {};

struct TimeText : Time {
  std::optional<std::variant<double, AutomaticStep>> given_step;
  std::optional<double> given_tolerance;
  std::optional<double> given_minimum_step;
  std::optional<double> given_spectral_radius;
};

/// The scene's own `rods`, `time` and `output` are completed by the checks.
struct SceneText : Scene {
  std::vector<RodText> given_rods;
  TimeText given_time;
  OutputText given_output;
};

Format<RodText> rod_format();
Format<Joint> joint_format();
Format<Support> support_format();
/// A part of a rod without `to` reaches to infinity until the checks know the rod, as the stretch
/// of an actuation does.
Format<Load> load_format();
Format<Actuation> actuation_format();
Format<TimeText> time_format();
Format<Analysis> analysis_format();
Format<Solver> solver_format();
Format<OutputText> output_format();

/// The whole scene: the root of all tables.
const Format<SceneText>& scene_format();

/// Checks the conditions that involve several keys, which the tables cannot see, and completes the
/// scene.
void check_scene(SceneText& scene, Diagnostics& diagnostics);

}  // namespace der::scenario
