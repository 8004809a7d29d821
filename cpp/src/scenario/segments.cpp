#include "scenario/segments.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/core/constants.hpp"
#include "der/core/nearest_node.hpp"
#include "scenario/checks.hpp"

namespace der::scenario {
namespace {

/// Coordinates in a text are rounded: tangents that differ by no more than this [rad] are one.
constexpr double kSameTangent = 1e-4;
/// So are curvatures that differ by no more than this share of the larger one.
constexpr double kSameCurvature = 1e-3;
/// A centre is as far from both ends as numbers of four digits say.
constexpr double kSameRadius = 1e-4;

using Part = std::shared_ptr<const CurvePart>;

/// Makes the parts of one shape; reports segments that are none.
class ShapeReader {
 public:
  ShapeReader(const RodText& rod, Path path, Diagnostics& diagnostics)
      : rod_(rod),
        path_(std::move(path)),
        diagnostics_(diagnostics),
        flat_(rod.from.size() == 2),
        here_(in_space(rod.from)) {}

  std::optional<DrawnCurve> read() {
    const std::size_t before = diagnostics_.size();
    std::vector<Part> parts;
    for (const SegmentText& segment : rod_.shape) {
      const int number = static_cast<int>(parts.size());
      Part part =
          std::visit([&](const auto& what) { return make(what, path_ / number); }, segment.what);
      if (!part) return std::nullopt;
      if (!std::isfinite(part->length())) {
        diagnostics_.add(path_ / number, "is too large for double-precision numbers");
        return std::nullopt;
      }
      here_ = part->point(1.0);
      parts.push_back(std::move(part));
    }
    check_parts(parts);
    if (diagnostics_.size() > before) return std::nullopt;
    return DrawnCurve(std::move(parts), rod_.closed, rod_.from.size());
  }

 private:
  /// No part without length, none that leads straight back; a ring is one.
  void check_parts(const std::vector<Part>& parts) {
    double length = 0.0;
    for (const Part& part : parts) length += part->length();
    const double gap = (here_ - in_space(rod_.from)).norm();
    if (rod_.closed && gap > 1e-6 * length) {
      diagnostics_.add(path_, fmt::format("ends {:.6g} m from where it begins: the shape of a "
                                          "closed rod leads back to 'from'",
                                          gap));
    }
    const int count = static_cast<int>(parts.size());
    for (int i = 0; i < count; ++i) {
      const Part& part = parts[static_cast<std::size_t>(i)];
      if (part->length() <= 1e-9 * length) {
        diagnostics_.add(path_ / i, "has no length: it ends where it begins");
        return;
      }
      if (i == 0 && !rod_.closed) continue;
      const Part& before = parts[static_cast<std::size_t>((i + count - 1) % count)];
      if ((before->tangent(1.0) + part->tangent(0.0)).norm() > 1e-9) continue;
      diagnostics_.add(path_ / i,
                       "turns straight back where it begins, through 180 degrees: the rod's side "
                       "of bending is not defined");
    }
  }

  Part make(const LineTo& line, const Path& path) {
    const Vec3 to = in_space(line.to);
    if (to == here_) return refuse(path / "line", "ends where it begins: a line needs a length");
    return std::make_shared<StraightPart>(here_, to);
  }

  Part make(const ArcTo& arc, const Path& where) {
    const Path path = where / "arc";
    const Vec3 to = in_space(arc.to);
    if (to == here_) {
      return refuse(path / "to", "ends where it begins: draw a whole circle by two arcs");
    }
    Vec3 centre = Vec3::Zero();
    Vec3 axis = Vec3::UnitZ();
    if (arc.through) {
      if (arc.longer) {
        return refuse(path / "longer", "'through' says already which of the two arcs it is");
      }
      const Vec3 first = in_space(*arc.through) - here_;
      const Vec3 whole = to - here_;
      axis = first.cross(whole);
      if (axis.norm() <= 1e-9 * first.norm() * whole.norm() || in_space(*arc.through) == to) {
        return refuse(path / "through",
                      "lies on the straight line through the arc's ends: write a 'line', or a "
                      "point beside it");
      }
      centre = here_ + (first.squaredNorm() * whole - whole.squaredNorm() * first).cross(axis) /
                           (2.0 * axis.squaredNorm());
      axis.normalize();
    } else if (arc.centre) {
      if (!turn_about(in_space(*arc.centre), to, arc.longer, path, centre, axis)) return nullptr;
    } else {
      if (!turn_with_radius(*arc.radius, to, arc.longer, path, centre, axis)) return nullptr;
    }
    const Vec3 start = here_ - centre;
    const Vec3 end = to - centre;
    double angle = std::atan2(axis.dot(start.cross(end)), start.dot(end));
    if (angle <= 0.0) angle += 2.0 * kPi;
    auto part = std::make_shared<TurningPart>(here_, centre, axis, angle);
    part->end_at(to);
    return part;
  }

  /// The shorter arc about a centre, or the longer one.
  bool turn_about(const Vec3& given, const Vec3& to, bool longer, const Path& path, Vec3& centre,
                  Vec3& axis) {
    const double from_start = (here_ - given).norm();
    const double from_end = (to - given).norm();
    const double radius = std::max(from_start, from_end);
    if (std::abs(from_start - from_end) > kSameRadius * radius) {
      refuse(path / "centre",
             fmt::format("is {:.9g} m from where the arc begins and {:.9g} m from where it ends: "
                         "a centre is as far from both",
                         from_start, from_end));
      return false;
    }
    const Vec3 chord = to - here_;
    centre = given + (0.5 * (here_ + to) - given).dot(chord) / chord.squaredNorm() * chord;
    axis = (here_ - centre).cross(to - centre);
    if (axis.norm() <= kSameRadius * radius * radius) {
      refuse(path / "centre", fmt::format("lies in the middle between the arc's ends, and both "
                                          "halves of the circle have it: write 'through'{}",
                                          flat_ ? " or a 'radius'" : ""));
      return false;
    }
    axis = longer ? -axis.normalized() : axis.normalized();
    return true;
  }

  /// In the plane: the shorter arc that turns to the left with a radius > 0, or the longer one.
  bool turn_with_radius(double given, const Vec3& to, bool longer, const Path& path, Vec3& centre,
                        Vec3& axis) {
    if (!flat_) {
      refuse(path / "radius",
             "leaves open in which plane an arc in space lies: write 'through', a point on it, or "
             "'centre'");
      return false;
    }
    const Vec3 chord = to - here_;
    const double half = 0.5 * chord.norm();
    const double radius = std::abs(given);
    if (radius < half * (1.0 - 1e-9)) {
      refuse(path / "radius",
             fmt::format("is too small: the ends of the arc are {:.9g} m apart, so write {:.9g} or "
                         "more (negative: it turns to the right)",
                         2.0 * half, half));
      return false;
    }
    const Vec3 left = Vec3::UnitZ().cross(chord) / (2.0 * half);
    const double away = std::sqrt(std::max(0.0, (radius - half) * (radius + half)));
    const double side = (given > 0.0) == longer ? -1.0 : 1.0;
    centre = 0.5 * (here_ + to) + side * away * left;
    axis = given > 0.0 ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ());
    return true;
  }

  Part make(const HelixAround& helix, const Path& where) {
    const Path path = where / "helix";
    const Vec3 given = in_space(helix.axis);
    if (given.isZero(0.0)) {
      return refuse(path / "axis", "an axis needs a direction: its components are all 0");
    }
    const Vec3 axis = given.stableNormalized();
    Vec3 centre;
    if (helix.centre) {
      centre = in_space(*helix.centre);
      Vec3 outwards = here_ - centre;
      const double apart = outwards.norm();
      outwards -= outwards.dot(axis) * axis;
      if (outwards.norm() <= 1e-9 * apart || apart == 0.0) {
        return refuse(path / "centre",
                      "the axis through it meets the point where the helix begins: a helix goes "
                      "around its axis at a distance");
      }
    } else {
      // The start is on the side of +x of the axis, of +y if that is the axis.
      Vec3 outwards = Vec3::UnitX() - axis.x() * axis;
      if (outwards.norm() < 1e-6) outwards = Vec3::UnitY() - axis.y() * axis;
      centre = here_ - *helix.radius * outwards.normalized();
    }
    return std::make_shared<TurningPart>(here_, centre, axis, 2.0 * kPi * helix.turns,
                                         helix.pitch * helix.turns);
  }

  Part make(const SplineThrough& spline, const Path& where) {
    const Path path = where / "spline";
    std::vector<Vec3> points{here_};
    for (const Components& point : spline.points) points.push_back(in_space(point));
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (points[i] != points[i - 1]) continue;
      return refuse(path / static_cast<int>(i - 1), "coincides with the point before it");
    }
    const std::size_t last = points.size() - 1;
    const bool is_ring =
        rod_.closed && rod_.shape.size() == 1 && last >= 3 && points.front() == points.back();
    if (!is_ring) return std::make_shared<SplinePart>(std::move(points), 0, last);
    // On a ring a spline of so many points more, around it, is periodic to rounding.
    constexpr std::size_t around = 25;
    std::vector<Vec3> more;
    for (std::size_t i = 0; i < last + 2 * around + 1; ++i) {
      more.push_back(points[(i + last * around - around) % last]);
    }
    return std::make_shared<SplinePart>(std::move(more), around, around + last);
  }

  Part refuse(const Path& path, std::string message) {
    diagnostics_.add(path, std::move(message));
    return nullptr;
  }

  const RodText& rod_;
  Path path_;
  Diagnostics& diagnostics_;
  bool flat_;
  Vec3 here_;  // the end of the curve so far
};

Components components_of(const Vec3& vector, std::size_t dimension) {
  return {vector.data(), vector.data() + dimension};
}

}  // namespace

DrawnCurve::DrawnCurve(std::vector<std::shared_ptr<const CurvePart>> parts, bool closed,
                       std::size_t dimension)
    : parts_(std::move(parts)), closed_(closed), dimension_(dimension) {
  starts_.push_back(0.0);
  for (const auto& part : parts_) starts_.push_back(starts_.back() + part->length());
  find_borders();
}

void DrawnCurve::find_borders() {
  for (std::size_t i = closed_ ? 0 : 1; i < parts_.size(); ++i) {
    const CurvePart& before = *parts_[(i + parts_.size() - 1) % parts_.size()];
    const CurvePart& after = *parts_[i];
    const Vec3 in = before.tangent(1.0);
    const Vec3 out = after.tangent(0.0);
    CurveBorder border;
    border.arc_length = starts_[i];
    border.corner = std::atan2(in.cross(out).norm(), in.dot(out)) > kSameTangent;
    if (!border.corner) {
      const Vec3 k_in = before.curvature(1.0);
      const Vec3 k_out = after.curvature(0.0);
      border.jump = k_out - k_in;
      const double size = std::max(k_in.norm(), k_out.norm());
      const double jump = border.jump.norm();
      if (jump <= kSameCurvature * size || jump * length() <= 1e-9) continue;
    }
    borders_.push_back(border);
  }
}

bool DrawnCurve::is_polyline() const {
  return std::all_of(parts_.begin(), parts_.end(),
                     [](const auto& part) { return part->straight(); });
}

std::vector<double> DrawnCurve::bounds() const {
  std::vector<double> bounds{0.0};
  for (const CurveBorder& border : borders_) {
    if (border.arc_length > 0.0) bounds.push_back(border.arc_length);
  }
  bounds.push_back(length());
  return bounds;
}

std::size_t DrawnCurve::part_at(double s) const {
  const auto above = std::upper_bound(starts_.begin() + 1, starts_.end() - 1, s);
  return static_cast<std::size_t>(above - starts_.begin()) - 1;
}

double DrawnCurve::turn_between(double from, double to) const {
  const double s = 0.5 * (from + to);
  const std::size_t number = part_at(s);
  const double share = (s - starts_[number]) / (starts_[number + 1] - starts_[number]);
  return parts_[number]->curvature(share).norm() * (to - from);
}

Components DrawnCurve::between(double from, double to, double share) const {
  const double s = from + share * (to - from);
  const std::size_t number = part_at(s);
  const double start = starts_[number];
  const double end = starts_[number + 1];
  const bool whole = from == start && to == end;  // the ends are then met exactly
  const double along = whole ? share : std::clamp((s - start) / (end - start), 0.0, 1.0);
  return components_of(parts_[number]->point(along), dimension_);
}

std::optional<DrawnCurve> drawn_curve(const RodText& rod, const Path& path,
                                      Diagnostics& diagnostics) {
  if (!rod.shape.empty()) return ShapeReader(rod, path / "shape", diagnostics).read();
  if (rod.from == rod.to) {
    diagnostics.add(path / "to", "must differ from 'from': the rod has no length");
    return std::nullopt;
  }
  return DrawnCurve({std::make_shared<StraightPart>(in_space(rod.from), in_space(rod.to))}, false,
                    rod.from.size());
}

std::vector<int> share_out(int cells, const std::vector<double>& lengths) {
  double whole = 0.0;
  for (const double length : lengths) whole += length;
  std::vector<int> counts;
  int given = 0;
  for (const double length : lengths) {
    counts.push_back(std::max(1, static_cast<int>(cells * (length / whole) * (1.0 - 1e-12))));
    given += counts.back();
  }
  constexpr double kLonger = 1.0 + 1e-9;  // of equal parts the first has one more, whatever rounds
  const auto cell = [&](std::size_t leg, int more) { return lengths[leg] / (counts[leg] + more); };
  for (; given != cells; given += given < cells ? 1 : -1) {
    std::size_t chosen = lengths.size();
    for (std::size_t leg = 0; leg < lengths.size(); ++leg) {
      if (given > cells && counts[leg] == 1) continue;
      const bool better =
          chosen == lengths.size() || (given < cells ? cell(leg, 0) > kLonger * cell(chosen, 0)
                                                     : cell(leg, -1) * kLonger < cell(chosen, -1));
      if (better) chosen = leg;
    }
    counts[chosen] += given < cells ? 1 : -1;
  }
  return counts;
}

CurveMesh mesh_of(const DrawnCurve& curve, const std::vector<double>& bounds,
                  const std::vector<int>& cells) {
  CurveMesh mesh;
  mesh.points.push_back(curve.between(bounds[0], bounds[1], 0.0));
  mesh.arc_length.push_back(0.0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (int k = 1; k <= cells[i]; ++k) {
      const double share = static_cast<double>(k) / cells[i];
      mesh.points.push_back(curve.between(bounds[i], bounds[i + 1], share));
      mesh.arc_length.push_back(bounds[i] + share * (bounds[i + 1] - bounds[i]));
    }
  }
  if (curve.closed()) {
    mesh.points.pop_back();
    mesh.arc_length.pop_back();
  }
  return mesh;
}

RestLine rest_line(const DrawnCurve& curve, const CurveMesh& mesh,
                   const std::vector<Components>& points, std::optional<double> rest_length) {
  if (curve.is_polyline()) return RestLine(points, curve.closed(), rest_length);
  return {mesh.arc_length, curve.length(), curve.closed(), rest_length};
}

void enter_borders(const DrawnCurve& curve, const CurveMesh& mesh, Rod& rod) {
  DrawnBorders& known = rod.borders.emplace();
  for (const CurveBorder& border : curve.borders()) {
    const auto node = static_cast<int>(nearest_node(mesh.arc_length, border.arc_length));
    if (border.corner) {
      known.corners.push_back(node);
    } else {
      known.jumps.push_back({node, {border.jump.x(), border.jump.y(), border.jump.z()}});
    }
  }
}

}  // namespace der::scenario
