#pragma once

#include <array>
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
struct StressFreeReference {};
/// Curvature [1/m] toward directors 1 and 2 of the section.
struct CurvaturePair {
  double first = 0.0;
  double second = 0.0;
};
/// Natural curvature [1/m]: one value, or one for each node. Scenes of the planar model have signed
/// values, positive counter-clockwise; scenes of the spatial models have pairs.
using NaturalCurvature = std::variant<StressFreeReference, double, std::vector<double>,
                                      CurvaturePair, std::vector<CurvaturePair>>;
/// Natural twist [rad/m]: one value, or one for each node, linear in between.
using NaturalTwist = std::variant<StressFreeReference, double, std::vector<double>>;

/// The corners and jumps of curvature of a rod that is drawn by `from`. Those of one drawn by
/// `points` have to be guessed.
struct DrawnBorders {
  struct Jump {
    int node = 0;
    std::array<double, 3> turn{};  ///< of the curvature, after less before [1/m]
  };
  std::vector<int> corners;  ///< nodes, ascending
  std::vector<Jump> jumps;   ///< ascending
};

struct Rod {
  std::string name;
  /// Initial node positions [m], one per node (from `points`, or spaced evenly over `from`..`to`,
  /// or over each part of the curve of a `shape`).
  std::vector<Components> points;
  std::optional<DrawnBorders> borders;  ///< absent: drawn by `points`
  bool closed = false;                  ///< whether an edge joins the last node and the first
  /// Length without stress [m]; absent: as drawn. All edges share the difference alike.
  std::optional<double> rest_length;
  CrossSection cross_section;
  /// Direction of director 1, that of the section's width, at the rod's start: any length, three
  /// components, made perpendicular to the first edge. Absent: +z, or where the rod begins along z
  /// (of sections whose two bending stiffnesses are equal only) any direction.
  std::optional<Components> director;
  std::optional<Material> material;  ///< absent only with `Stiffness`
  CurvatureMeasure curvature = CurvatureMeasure::Angle;
  NaturalCurvature natural_curvature = StressFreeReference{};
  NaturalTwist natural_twist = StressFreeReference{};
  /// Twist of the drawn frames [rad/m] against frames that are transported without twist.
  double initial_twist = 0.0;
  /// Initial velocities [m/s], one per node; empty: at rest.
  std::vector<Components> initial_velocity;
  std::vector<Sphere> spheres;
  Mark mark;

  [[nodiscard]] int num_edges() const { return static_cast<int>(points.size()) - (closed ? 0 : 1); }
};

/// By how much the rod without stress is longer than drawn; exactly 1 without a `rest_length`.
double rest_scale(const Rod& rod);

}  // namespace der::scenario
