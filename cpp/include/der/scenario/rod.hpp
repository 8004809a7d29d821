#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "der/scenario/cross_section.hpp"
#include "der/scenario/curvature_measure.hpp"
#include "der/scenario/location.hpp"
#include "der/scenario/mark.hpp"
#include "der/scenario/series.hpp"

namespace der::scenario {

/// Rigid spheres threaded on nodes. The reader leaves the list in the order of the text; a later
/// entry replaces an earlier one on the same node.
struct Sphere {
  Location at;
  double radius = 0.0;   ///< [m]
  double density = 0.0;  ///< [kg/m^3]
};

/// The rod is stress-free in its initial shape.
struct AsDrawn {};
/// Signed natural curvature [1/m], positive counter-clockwise: one value, or one for each node.
using NaturalCurvature = std::variant<AsDrawn, double, std::vector<double>>;

struct Rod {
  std::string name;
  /// Initial node positions [m], one per node (from `points`, or spaced evenly over `from`..`to`).
  std::vector<Components> points;
  CrossSection cross_section;
  std::optional<Material> material;  ///< absent only with `Stiffness`
  CurvatureMeasure curvature = CurvatureMeasure::Angle;
  NaturalCurvature natural_curvature = AsDrawn{};
  /// Initial velocities [m/s], one per node; empty: at rest.
  std::vector<Components> initial_velocity;
  std::vector<Sphere> spheres;
  Mark mark;
};

}  // namespace der::scenario
