#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/scenario/stretch_profile.hpp"
#include "scenario/checks.hpp"
#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

/// The largest turning angle of a rod, and the first node that has it.
struct Turning {
  double angle = 0.0;  ///< [rad]
  int node = 0;

  void enter(double other, int at) {
    if (!(other > (1.0 + kRounding) * angle)) return;
    angle = other;
    node = at;
  }
};

double size_of(double curvature) { return std::abs(curvature); }
double size_of(const CurvaturePair& curvature) {
  return std::hypot(curvature.first, curvature.second);
}

/// The absolute value that a natural curvature or twist has at a node [1/m].
template <class Natural>
double size_at(const Natural& natural, int node) {
  struct Visitor {
    std::size_t node;
    double operator()(AsDrawn /*none*/) const { return 0.0; }
    double operator()(double one) const { return size_of(one); }
    double operator()(const CurvaturePair& one) const { return size_of(one); }
    double operator()(const std::vector<double>& list) const { return size_of(list[node]); }
    double operator()(const std::vector<CurvaturePair>& list) const { return size_of(list[node]); }
  };
  return std::visit(Visitor{static_cast<std::size_t>(node)}, natural);
}

/// At nodes with two edges, each of which stands for half of these.
template <class Natural>
Turning largest_turning(const Natural& natural, const RestLine& line) {
  const int last = line.num_nodes() - 1;
  const int outermost = line.closed() ? 0 : 1;
  Turning largest;
  for (int node = outermost; node <= last - outermost; ++node) {
    const double before =
        node > 0 ? line.arc_length(node - 1) : line.arc_length(last) - line.length();
    const double after = node < last ? line.arc_length(node + 1) : line.length();
    largest.enter(size_at(natural, node) * 0.5 * (after - before), node);
  }
  return largest;
}

/// The number of nodes with which neighbouring edges turn by half of a coarse angle.
double fine_nodes(const Turning& largest, const RestLine& line) {
  const int more = line.closed() ? 0 : 1;  // nodes than edges
  return more + std::round((line.num_nodes() - more) * largest.angle / (0.5 * kCoarseTurn));
}

Series twist_of(const Support& clamp) { return clamp.twist.value_or(Series()); }

/// The greatest difference of two tables; of sines that of their greatest values.
double largest_difference(const Series& a, const Series& b) {
  const auto greatest = [](const Series& sine) {
    return std::abs(sine.values[0]) + std::abs(sine.values[1]);
  };
  const bool a_is_sine = a.course.kind == Course::Kind::Sine;
  const bool b_is_sine = b.course.kind == Course::Kind::Sine;
  double largest = 0.0;
  if (a_is_sine || b_is_sine) {
    largest += a_is_sine ? greatest(a) : std::abs(value_at(a, 0.0));
    largest += b_is_sine ? greatest(b) : std::abs(value_at(b, 0.0));
    return largest;
  }
  for (const Series* series : {&a, &b}) {
    for (const double time : series->times) {
      largest = std::max(largest, std::abs(value_at(a, time) - value_at(b, time)));
    }
  }
  return largest;
}

class Resolution {
 public:
  Resolution(CheckContext& context, int rod)
      : context_(context),
        number_(rod),
        rod_(context.scene.rods[static_cast<std::size_t>(rod)]),
        line_(*context.lines[static_cast<std::size_t>(rod)]) {}

  void check_curvature() {
    const Turning largest = largest_turning(rod_.natural_curvature, line_);
    if (rod_.curvature == CurvatureMeasure::Angle && largest.angle >= kPi) {
      context_.diagnostics.add(
          Path{"rods", number_, "natural_curvature"},
          fmt::format("asks for a turn of {:.3g} rad between the edges at node {}, and edges turn "
                      "by less than half a turn: give the rod more nodes, about {:g} for this "
                      "curvature",
                      largest.angle, largest.node, fine_nodes(largest, line_)));
    } else if (largest.angle > kCoarseTurn) {
      warn("natural_curvature", "the edges", largest);
    }
  }

  /// Sections without a direction may turn by any angle.
  void check_twist() {
    if (is_isotropic(rod_.cross_section) && size_at(rod_.natural_curvature, 0) == 0.0) return;
    if (std::holds_alternative<AsDrawn>(rod_.natural_twist)) {
      const Turning drawn = largest_turning(NaturalTwist(rod_.initial_twist), line_);
      if (drawn.angle > kCoarseTurn) warn("initial_twist", "the sections", drawn);
    } else {
      const Turning largest = largest_turning(rod_.natural_twist, line_);
      if (largest.angle > kCoarseTurn) warn("natural_twist", "the sections", largest);
    }
    check_prescribed_twist();
  }

 private:
  /// Two clamps that twist a rod between them spread the twist over its edges.
  void check_prescribed_twist() {
    std::vector<const Support*> clamps;
    for (const Support& support : context_.scene.supports) {
      if (support.rod == rod_.name && support.clamp == Clamp::Section) clamps.push_back(&support);
    }
    if (clamps.size() != 2) return;
    const double between = largest_difference(twist_of(*clamps[0]), twist_of(*clamps[1]));
    const int more = line_.closed() ? 0 : 1;  // nodes than edges
    const Turning mean{between / (line_.num_nodes() - more), 0};
    if (mean.angle <= kCoarseTurn) return;
    context_.scene.warnings.push_back(fmt::format(
        "rod '{}' is too coarse for the twist that its clamps prescribe: the sections turn by "
        "{:.2g} rad from edge to edge. Give it about {:g} nodes",
        rod_.name, mean.angle, fine_nodes(mean, line_)));
  }

  void warn(const char* key, const char* what, const Turning& largest) {
    context_.scene.warnings.push_back(fmt::format(
        "rod '{}' is too coarse for its {}: without stress {} turn by {:.2g} rad at node {}. Give "
        "it about {:g} nodes",
        rod_.name, key, what, largest.angle, largest.node, fine_nodes(largest, line_)));
  }

  CheckContext& context_;
  int number_;
  const Rod& rod_;
  const RestLine& line_;
};

}  // namespace

void check_resolution(CheckContext& context) {
  for (int rod = 0; rod < static_cast<int>(context.lines.size()); ++rod) {
    const Path path{"rods", rod};
    if (context.diagnostics.under(path) || !context.lines[static_cast<std::size_t>(rod)]) continue;
    Resolution resolution(context, rod);
    resolution.check_curvature();
    resolution.check_twist();
  }
}

}  // namespace der::scenario
