#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/scenario/load.hpp"
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
    double operator()(StressFreeReference /*none*/) const { return 0.0; }
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

/// A clamp that holds the section, and how its tables twist it about the tangent.
struct TwistedClamp {
  double arc_length = 0.0;        // [m]
  std::vector<const Series*> by;  // `sign` times the first of them, plus the others [rad]
  double sign = 1.0;

  [[nodiscard]] double twist(double time) const {
    double sum = 0.0;
    for (const Series* table : by) {
      sum += (table == by.front() ? sign : 1.0) * value_at(*table, time);
    }
    return sum;
  }
};

/// The sine of the angle between two directions below which they are one.
constexpr double kParallel = 1e-9;

/// Rotations twist a straight rod where they are about its own axis.
TwistedClamp twisted_clamp(const Support& clamp, const Rod& rod, const RestLine& line) {
  TwistedClamp result;
  result.arc_length = line.arc_length_of(clamp.at);
  if (clamp.axis_rotation && is_straight(rod)) {
    const Vec3 along =
        (in_space(rod.points.back()) - in_space(rod.points.front())).stableNormalized();
    const Vec3 axis = in_space(clamp.axis_rotation->axis).stableNormalized();
    if (axis.cross(along).norm() <= kParallel) {
      result.by.push_back(&clamp.axis_rotation->angle);
      result.sign = axis.dot(along);
    }
  }
  if (clamp.twist) result.by.push_back(&*clamp.twist);
  return result;
}

/// The instants of a run until `end` [s] at which tables have their entries; of a sine many.
std::vector<double> instants_of(const TwistedClamp& clamp, double end) {
  constexpr int kMany = 400;
  std::vector<double> instants{0.0, end};
  for (const Series* table : clamp.by) {
    if (table->course.kind == Course::Kind::Sine) {
      for (int i = 1; i < kMany; ++i) instants.push_back(end * i / kMany);
    } else {
      for (const double time : table->times) instants.push_back(std::min(time, end));
    }
  }
  return instants;
}

double largest_difference(const TwistedClamp& a, const TwistedClamp& b, double end) {
  double largest = 0.0;
  for (const TwistedClamp* clamp : {&a, &b}) {
    for (const double time : instants_of(*clamp, end)) {
      largest = std::max(largest, std::abs(a.twist(time) - b.twist(time)));
    }
  }
  return largest;
}

/// A rod of so many nodes or more has lost its bending to rounding: the error of the stiffness of
/// its edges grows with the fourth power of their number against that of the whole rod, and is
/// 1e5 times that of a cantilever by then.
constexpr int kTooManyNodes = 100'000;
/// From so many on a search may take minutes and end as `too_fine`, by the load and by EA. Of 26
/// with 20,000 to 80,000 nodes and EA L^2/EI from 1e4 to 1e8, 4 failed and 7 took more than a
/// minute. All others found the right shape.
constexpr int kManyNodes = 20'000;

/// Of all rods of a scene together: a run takes 0.6 GB and a search 1.5 GB, or more.
constexpr double kManyInScene = 500'000;

/// Memory that is taken for each node at least [bytes].
struct NodeMemory {
  double in_plane;
  double in_space;
};
constexpr NodeMemory kOfRun{1200.0, 2000.0};     // over time
constexpr NodeMemory kOfSearch{3000.0, 6000.0};  // of an equilibrium

/// "20000 nodes take 0.06 GB of memory or more"
std::string takes_memory(double nodes, bool is_searched, int dimension) {
  const NodeMemory& of_node = is_searched ? kOfSearch : kOfRun;
  const double memory = nodes * (dimension == 2 ? of_node.in_plane : of_node.in_space);
  return fmt::format("{:.0f} nodes take {:.2g} GB of memory or more", nodes, 1e-9 * memory);
}

/// Whether an equilibrium is searched for.
bool searches(const SceneText& scene) {
  return !scene.is_dynamic() || scene.start_from == "equilibrium";
}

/// Warns of a scene whose rods have too many nodes together, each of them no matter how few.
void check_size(CheckContext& context) {
  double nodes = 0.0;
  for (const auto& line : context.lines) nodes += line ? line->num_nodes() : 0;
  if (nodes < kManyInScene) return;
  const bool is_searched = searches(context.scene);
  context.scene.warnings.push_back(fmt::format(
      "the scene is large: its {} rods of {}{}: write fewer, 200 a rod resolve most shapes and "
      "2000 nearly all",
      context.lines.size(), takes_memory(nodes, is_searched, context.dimension),
      is_searched ? ". The search can take many minutes" : ""));
}

/// Whether a load bends a straight rod: it has a part across it, or may have one.
struct Bends {
  const std::string& rod;
  const Vec3& along;

  bool operator()(const Gravity& load) const { return has_part_across(load.acceleration); }
  bool operator()(const PointForce& load) const {
    return load.rod == rod && has_part_across(load.force);
  }
  bool operator()(const DistributedForce& load) const {
    return load.rod == rod && has_part_across(load.force);
  }
  bool operator()(const Damping& /*load*/) const { return false; }
  template <class Other>
  bool operator()(const Other& /*load*/) const {
    return true;
  }

 private:
  [[nodiscard]] bool has_part_across(const VectorSeries& force) const {
    return std::any_of(force.values.begin(), force.values.end(), [&](const Components& value) {
      const Vec3 vector = in_space(value);
      return vector.cross(along).norm() > kRounding * vector.norm();
    });
  }
};

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

  /// Reports so many nodes that no equilibrium, mode or buckling load of a rod that bends can be
  /// found, and warns of them in a run over time. Warns of fewer that may be too many.
  void check_fineness() {
    const bool is_searched = searches(context_.scene);
    if (line_.num_nodes() < (is_searched ? kManyNodes : kTooManyNodes)) return;
    if (is_cable(rod_) || is_only_pulled()) return;
    const std::string takes =
        fmt::format("{}, and rounding hides how a rod of so many bends",
                    takes_memory(line_.num_nodes(), is_searched, context_.dimension));
    constexpr const char* kAdvice = "write fewer, 200 resolve most shapes and 2000 nearly all";
    if (!is_searched) {
      context_.scene.warnings.push_back(
          fmt::format("rod '{}' is too fine: {}: {}", rod_.name, takes, kAdvice));
      return;
    }
    if (line_.num_nodes() < kTooManyNodes) {
      context_.scene.warnings.push_back(
          fmt::format("rod '{}' may be too fine: {}. The search can take minutes and end as "
                      "'too_fine': {}",
                      rod_.name, takes, kAdvice));
      return;
    }
    const RodText& given = context_.scene.given_rods[static_cast<std::size_t>(number_)];
    context_.diagnostics.add(
        Path{"rods", number_, given.given_points.empty() ? "nodes" : "points"},
        fmt::format("{}, so that the search would fail as 'too_fine': {}", takes, kAdvice));
  }

  /// Sections without a direction may turn by any angle.
  void check_twist() {
    if (is_isotropic(rod_.cross_section) && size_at(rod_.natural_curvature, 0) == 0.0) return;
    if (std::holds_alternative<StressFreeReference>(rod_.natural_twist)) {
      const Turning drawn = largest_turning(NaturalTwist(rod_.initial_twist), line_);
      if (drawn.angle > kCoarseTurn) warn("initial_twist", "the sections", drawn);
    } else {
      const Turning largest = largest_turning(rod_.natural_twist, line_);
      if (largest.angle > kCoarseTurn) warn("natural_twist", "the sections", largest);
    }
    check_prescribed_twist();
  }

 private:
  /// Whether the static shape of a planar rod is straight for certain. In space the directions
  /// across it have to be told as well.
  [[nodiscard]] bool is_only_pulled() const {
    const Scene& scene = context_.scene;
    if (!std::holds_alternative<StaticAnalysis>(scene.analysis) || context_.dimension != 2 ||
        !std::holds_alternative<StressFreeReference>(rod_.natural_curvature) ||
        !is_straight(rod_)) {
      return false;
    }
    const Vec3 along =
        (in_space(rod_.points.back()) - in_space(rod_.points.front())).stableNormalized();
    const Bends bends{rod_.name, along};
    const auto is_load = [&](const Load& load) { return std::visit(bends, load.what); };
    const auto moves = [&](const Support& support) {
      bool any = false;
      if (support.rod == rod_.name) for_each_motion(support, [&](auto&&...) { any = true; });
      return any;
    };
    return scene.actuations.empty() &&
           std::none_of(scene.loads.begin(), scene.loads.end(), is_load) &&
           std::none_of(scene.supports.begin(), scene.supports.end(), moves);
  }

  /// Neighbouring clamps spread the twist between them over its edges.
  void check_prescribed_twist() {
    std::vector<TwistedClamp> clamps;
    for (const Support& support : context_.scene.supports) {
      const bool is_single = support.at.kind != Location::Kind::All;
      if (support.rod == rod_.name && support.clamp == Clamp::Section && is_single) {
        clamps.push_back(twisted_clamp(support, rod_, line_));
      }
    }
    std::sort(clamps.begin(), clamps.end(), [](const TwistedClamp& a, const TwistedClamp& b) {
      return a.arc_length < b.arc_length;
    });
    const double end = context_.scene.is_dynamic() ? context_.scene.time.duration : 0.0;
    const int more = line_.closed() ? 0 : 1;  // nodes than edges
    const double edge = line_.length() / (line_.num_nodes() - more);
    Turning largest;
    for (std::size_t i = 0; i + 1 < clamps.size(); ++i) {
      const double length = clamps[i + 1].arc_length - clamps[i].arc_length;
      if (length <= line_.same_place()) continue;
      largest.enter(largest_difference(clamps[i], clamps[i + 1], end) * edge / length, 0);
    }
    if (largest.angle <= kCoarseTurn) return;
    context_.scene.warnings.push_back(fmt::format(
        "rod '{}' is too coarse for the twist that its clamps prescribe: the sections turn by "
        "{:.2g} rad from edge to edge. Give it about {:g} nodes",
        rod_.name, largest.angle, fine_nodes(largest, line_)));
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
    resolution.check_fineness();
    resolution.check_curvature();
    resolution.check_twist();
  }
  if (context.lines.size() > 1) check_size(context);
}

}  // namespace der::scenario
