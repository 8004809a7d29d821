#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "scenario/curve_parts.hpp"
#include "scenario/directions.hpp"
#include "scenario/rest_line.hpp"
#include "scenario/scene_text.hpp"

/// Rods drawn by segments: the exact curve, and nodes on it.
namespace der::scenario {

/// Where two parts meet that do not go on as one curve.
struct CurveBorder {
  double arc_length = 0.0;   ///< [m]; at the start of a ring 0
  bool corner = false;       ///< whether the tangent jumps; else the curvature does
  Vec3 jump = Vec3::Zero();  ///< of the curvature, after less before [1/m]
};

/// The curve of a rod that is drawn by `from` and `to`, or by `from` and `shape`.
class DrawnCurve {
 public:
  /// At least one part, each of which begins where the one before ends.
  DrawnCurve(std::vector<std::shared_ptr<const CurvePart>> parts, bool closed,
             std::size_t dimension);

  [[nodiscard]] double length() const { return starts_.back(); }  ///< [m]
  [[nodiscard]] bool closed() const { return closed_; }
  /// Whether it is a polyline, whose length is that of its edges.
  [[nodiscard]] bool is_polyline() const;
  /// Ascending.
  [[nodiscard]] const std::vector<CurveBorder>& borders() const { return borders_; }
  /// The arc lengths [m] of its start, its borders and its end.
  [[nodiscard]] std::vector<double> bounds() const;
  /// The point at a share of the way between two arc lengths [m].
  [[nodiscard]] Components between(double from, double to, double share) const;
  /// By how much the curve turns between two arc lengths [m] if its curvature is that of the middle
  /// [rad].
  [[nodiscard]] double turn_between(double from, double to) const;

 private:
  void find_borders();
  /// Number of the part that has an arc length [m].
  [[nodiscard]] std::size_t part_at(double s) const;

  std::vector<std::shared_ptr<const CurvePart>> parts_;
  std::vector<double> starts_;  // of the parts, and the end of the last [m]
  std::vector<CurveBorder> borders_;
  bool closed_;
  std::size_t dimension_;
};

/// The curve of a rod with `from`; none after diagnostics.
std::optional<DrawnCurve> drawn_curve(const RodText& rod, const Path& path,
                                      Diagnostics& diagnostics);

/// Shares cells out among parts of these lengths, one each at least, so that the longest cell is as
/// short as can be.
std::vector<int> share_out(int cells, const std::vector<double>& lengths);

/// Nodes of a curve: even cells between bounds.
struct CurveMesh {
  std::vector<Components> points;
  std::vector<double> arc_length;  ///< along the curve [m]
};
/// `bounds` [m] begin and end with the curve; each two have a number of `cells` in between. The
/// end of a ring is its first node.
CurveMesh mesh_of(const DrawnCurve& curve, const std::vector<double>& bounds,
                  const std::vector<int>& cells);

/// Arc lengths along a curve with these nodes at `points` [m]; `rest_length` as that of RestLine.
RestLine rest_line(const DrawnCurve& curve, const CurveMesh& mesh,
                   const std::vector<Components>& points, std::optional<double> rest_length);

/// Tells a rod the nodes at which its curve has corners and its curvature jumps.
void enter_borders(const DrawnCurve& curve, const CurveMesh& mesh, Rod& rod);

}  // namespace der::scenario
