#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scenario/checks.hpp"

namespace der::scenario {
namespace {

/// Nodes closer than this fraction of the shortest edge beside them are at the same place.
constexpr double kSamePlace = 1e-6;
/// More of these warnings help nobody.
constexpr std::size_t kMostWarnings = 5;

struct Node {
  int rod;
  int number;
  bool is_end;
  double x, y;
  double along;      ///< [m] coordinate along an oblique line, by which nodes are sorted
  double tolerance;  ///< [m]
};

double tolerance_at(const RestLine& line, int node) {
  double shortest = std::numeric_limits<double>::infinity();
  if (node > 0) shortest = line.arc_length(node) - line.arc_length(node - 1);
  if (node + 1 < line.num_nodes()) {
    shortest = std::min(shortest, line.arc_length(node + 1) - line.arc_length(node));
  }
  return kSamePlace * shortest;
}

/// All nodes that could touch another, sorted by `along`.
std::vector<Node> nodes_of(const CheckContext& context) {
  std::vector<Node> nodes;
  const bool single = context.lines.size() == 1;
  for (int rod = 0; rod < static_cast<int>(context.lines.size()); ++rod) {
    const auto& line = context.lines[static_cast<std::size_t>(rod)];
    const RodText& text = context.scene.given_rods[static_cast<std::size_t>(rod)];
    if (!line || (single && text.nodes)) continue;  // a straight rod does not touch itself
    const int last = line->num_nodes() - 1;
    for (int i = 0; i <= last; ++i) {
      const double x = text.points[static_cast<std::size_t>(i)][0];
      const double y = text.points[static_cast<std::size_t>(i)][1];
      nodes.push_back(
          {rod, i, i == 0 || i == last, x, y, 0.7853 * x + 0.6191 * y, tolerance_at(*line, i)});
    }
  }
  std::sort(nodes.begin(), nodes.end(),
            [](const Node& a, const Node& b) { return a.along < b.along; });
  return nodes;
}

bool is_held(const CheckContext& context, const Node& node) {
  const HeldNode* held = context.held_at(node.rod, node.number);
  return held && held->holds(Hold::X) && held->holds(Hold::Y);
}

/// "the start of rod 'a'"
std::string in_words(const CheckContext& context, const Node& node) {
  const std::string& rod = context.scene.given_rods[static_cast<std::size_t>(node.rod)].name;
  if (!node.is_end) return fmt::format("a node of rod '{}'", rod);
  return fmt::format("the {} of rod '{}'", node.number == 0 ? "start" : "end", rod);
}

std::string warning_of(const CheckContext& context, const Node& a, const Node& b) {
  const std::string place = fmt::format("({:.6g}, {:.6g}) m", a.x, a.y);
  if (a.rod == b.rod && a.is_end && b.is_end) {
    const std::string& rod = context.scene.given_rods[static_cast<std::size_t>(a.rod)].name;
    return fmt::format(
        "the last point of rod '{}' is its first, {}, but that does not close the rod: it has two "
        "free ends there, which move apart. This version has no joints: hold both ends by "
        "supports, or move them apart if that is what you mean",
        rod, place);
  }
  return fmt::format(
      "{} and {} are at the same place, {}, but nothing joins them: each moves as if the other "
      "were "
      "not there. This version has no joints: draw both as one rod with 'points', hold both by "
      "supports, or move them apart if that is what you mean",
      in_words(context, a), in_words(context, b), place);
}

class TouchFinder {
 public:
  explicit TouchFinder(CheckContext& context) : context_(context), nodes_(nodes_of(context)) {}

  void run() {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      for (std::size_t k = i + 1; k < nodes_.size() && near(nodes_[i], nodes_[k]); ++k) {
        if (!touch(nodes_[i], nodes_[k])) continue;
        if (++found_ > kMostWarnings) {
          warn("there are more places where rods touch and nothing joins them");
          return;
        }
        warn(nodes_[i], nodes_[k]);
      }
    }
  }

 private:
  /// Whether they may touch, by the order in which they are sorted.
  static bool near(const Node& a, const Node& b) { return b.along - a.along <= 2.0 * a.tolerance; }

  [[nodiscard]] bool touch(const Node& a, const Node& b) const {
    if (!a.is_end && !b.is_end) return false;  // rods may cross
    if (std::hypot(a.x - b.x, a.y - b.y) > std::min(a.tolerance, b.tolerance)) return false;
    return !is_held(context_, a) || !is_held(context_, b);
  }

  void warn(const Node& a, const Node& b) {
    const bool in_order = a.rod != b.rod ? a.rod < b.rod : a.number < b.number;
    warn(in_order ? warning_of(context_, a, b) : warning_of(context_, b, a));
  }
  void warn(std::string message) { context_.scene.warnings.push_back(std::move(message)); }

  CheckContext& context_;
  std::vector<Node> nodes_;
  std::size_t found_ = 0;
};

}  // namespace

void warn_of_touching_rods(CheckContext& context) { TouchFinder(context).run(); }

}  // namespace der::scenario
