#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scenario/checks.hpp"
#include "scenario/directions.hpp"

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
  Vec3 position;
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
  const Vec3 oblique = Vec3(0.7853, 0.6191, 0.4142).normalized();
  const bool single = context.lines.size() == 1;
  for (int rod = 0; rod < static_cast<int>(context.lines.size()); ++rod) {
    const auto& line = context.lines[static_cast<std::size_t>(rod)];
    const auto number = static_cast<std::size_t>(rod);
    const RodText& given = context.scene.given_rods[number];
    const bool straight = given.nodes.has_value() && given.shape.empty();
    if (!line || (single && straight)) continue;  // a straight rod does not touch itself
    const int last = line->num_nodes() - 1;
    for (int i = 0; i <= last; ++i) {
      const Vec3 position =
          in_space(context.scene.rods[number].points[static_cast<std::size_t>(i)]);
      nodes.push_back({rod, i, !line->closed() && (i == 0 || i == last), position,
                       position.dot(oblique), tolerance_at(*line, i)});
    }
  }
  std::sort(nodes.begin(), nodes.end(),
            [](const Node& a, const Node& b) { return a.along < b.along; });
  return nodes;
}

bool is_held(const CheckContext& context, const Node& node) {
  return context.is_fixed(node.rod, node.number);
}

/// "the start of rod 'a'"
std::string in_words(const CheckContext& context, const Node& node) {
  const std::string& rod = context.scene.rods[static_cast<std::size_t>(node.rod)].name;
  if (!node.is_end) return fmt::format("a node of rod '{}'", rod);
  return fmt::format("the {} of rod '{}'", node.number == 0 ? "start" : "end", rod);
}

/// As it is written in a joint.
std::string as_member(const CheckContext& context, const Node& node) {
  const std::string& rod = context.scene.rods[static_cast<std::size_t>(node.rod)].name;
  const std::string at = !node.is_end       ? fmt::format("{{node: {}}}", node.number)
                         : node.number == 0 ? "start"
                                            : "end";
  return fmt::format("{{rod: {}, at: {}}}", rod, at);
}

std::string warning_of(const CheckContext& context, const Node& a, const Node& b) {
  const Vec3& at = a.position;
  const std::string place = context.dimension == 2
                                ? fmt::format("({:.6g}, {:.6g}) m", at.x(), at.y())
                                : fmt::format("({:.6g}, {:.6g}, {:.6g}) m", at.x(), at.y(), at.z());
  if (a.rod == b.rod && a.is_end && b.is_end) {
    const std::string& rod = context.scene.rods[static_cast<std::size_t>(a.rod)].name;
    return fmt::format(
        "the last point of rod '{}' is its first, {}, but that does not close the rod: it has two "
        "free ends there, which move apart. For a ring leave the last point out and write "
        "'closed: true'; or hold both ends by supports, or move them apart if that is what you "
        "mean",
        rod, place);
  }
  return fmt::format(
      "{} and {} are at the same place, {}, but nothing joins them: each moves as if the other "
      "were "
      "not there. {}, or move them apart if that is what you mean",
      in_words(context, a), in_words(context, b), place,
      fmt::format("To join them write 'joints: [{{name: corner, of: [{}, {}]}}]'",
                  as_member(context, a), as_member(context, b)));
}

class TouchFinder {
 public:
  explicit TouchFinder(CheckContext& context)
      : context_(context), nodes_(nodes_of(context)), next_end_(nodes_.size() + 1) {
    next_end_.back() = nodes_.size();
    for (std::size_t k = nodes_.size(); k-- > 0;) {
      next_end_[k] = nodes_[k].is_end ? k : next_end_[k + 1];
    }
  }

  void run() {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      // Only ends touch. In a scene that lies across the axis of `along` all nodes are near.
      const auto candidate = [&](std::size_t k) { return nodes_[i].is_end ? k : next_end_[k]; };
      for (std::size_t k = candidate(i + 1); k < nodes_.size() && near(nodes_[i], nodes_[k]);
           k = candidate(k + 1)) {
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
    if ((a.position - b.position).norm() > std::min(a.tolerance, b.tolerance)) return false;
    if (are_joined(a, b)) return false;
    return !is_held(context_, a) || !is_held(context_, b);
  }

  [[nodiscard]] bool are_joined(const Node& a, const Node& b) const {
    const auto found = context_.joined.find(CheckContext::node_key(a.rod, a.number));
    if (found == context_.joined.end()) return false;
    const auto& others = found->second.others;
    const std::int64_t other = CheckContext::node_key(b.rod, b.number);
    return std::find(others.begin(), others.end(), other) != others.end();
  }

  void warn(const Node& a, const Node& b) {
    const bool in_order = a.rod != b.rod ? a.rod < b.rod : a.number < b.number;
    warn(in_order ? warning_of(context_, a, b) : warning_of(context_, b, a));
  }
  void warn(std::string message) { context_.scene.warnings.push_back(std::move(message)); }

  CheckContext& context_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> next_end_;  // the first end from each node on; as many as nodes: none
  std::size_t found_ = 0;
};

}  // namespace

void warn_of_touching_rods(CheckContext& context) { TouchFinder(context).run(); }

}  // namespace der::scenario
