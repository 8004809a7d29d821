#pragma once

#include <memory>
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

/// The segments of `shape:`. Each begins where the one before ends.
struct LineTo {
  Components to;
};
/// `through`, or `centre`, or `radius` [m], in the plane.
struct ArcTo {
  Components to;
  std::optional<Components> through;
  std::optional<Components> centre;
  std::optional<double> radius;
  bool longer = false;  ///< the longer one of the two arcs about a centre or with a radius
};
/// `centre` or `radius` [m].
struct HelixAround {
  Components axis;
  std::optional<Components> centre;
  std::optional<double> radius;
  double pitch = 0.0;  ///< [m]
  double turns = 0.0;
};
struct SplineThrough {
  std::vector<Components> points;
};
struct SegmentText {
  std::variant<LineTo, ArcTo, HelixAround, SplineThrough> what;
};

class DrawnCurve;

struct RodText : Rod {
  SectionText section;
  std::vector<Components> given_points;  ///< or:
  std::optional<int> nodes;
  std::optional<int> subdivide;
  Components from;
  Components to;
  std::vector<SegmentText> shape;           ///< in place of `to`
  std::shared_ptr<const DrawnCurve> curve;  ///< of a rod with `from`
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
Format<AxialSpring> axial_spring_format();
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
