#include <algorithm>
#include <cmath>
#include <utility>

#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"

namespace der::scenario {
namespace {

/// A mesh of more nodes than this is no advice.
constexpr double kMostNodes = 2000.0;

/// Something that turns the rod at a place, or turns with it. On the way from there to the middles
/// of the edges beside it, in the cell of a node, the rod bends.
struct TurningPlace {
  std::optional<int> node;  ///< whose cell it is; none in the middle of an edge
  double at = 0.0;          ///< [m]; in the cell of a ring's start it may be below 0
  std::string what;
  bool bends = false;  ///< whether it bends the rod in the cell
  bool feels = false;  ///< whether what else bends the cell changes what it does
};

/// Whether one of them should feel what the other bends.
bool are_coupled(const TurningPlace& a, const TurningPlace& b) {
  return (a.feels && b.bends) || (b.feels && a.bends);
}

bool resists_turning(const Support& support) {
  if (!support.spring) return false;
  const Components& stiffness = support.spring->rotational_stiffness;
  return std::any_of(stiffness.begin(), stiffness.end(), [](double k) { return k > 0.0; });
}

/// Looks at the cells of one rod.
class CellCheck {
 public:
  CellCheck(CheckContext& context, int rod, ModelChoice model)
      : context_(context),
        rod_(rod),
        name_(context.scene.rods[static_cast<std::size_t>(rod)].name),
        line_(*context.lines[static_cast<std::size_t>(rod)]),
        model_(model) {}

  void run() {
    enter_supports();
    enter_loads();
    std::sort(places_.begin(), places_.end(),
              [](const TurningPlace& a, const TurningPlace& b) { return a.at < b.at; });
    const auto nearest_where = [&](const auto& meet) {
      std::pair<const TurningPlace*, const TurningPlace*> nearest;
      for (std::size_t i = 0; i < places_.size(); ++i) {
        for (std::size_t k = i + 1; k < places_.size(); ++k) {
          const TurningPlace& a = places_[i];
          const TurningPlace& b = places_[k];
          const double apart = b.at - a.at;
          if (apart > two_edges_) break;  // in no cell together, and not beside one end
          if (apart <= line_.same_place() || !are_coupled(a, b) || !meet(a, b)) continue;
          if (nearest.first == nullptr || apart < nearest.second->at - nearest.first->at) {
            nearest = {&a, &b};
          }
        }
      }
      return nearest;
    };
    const auto [first, second] = nearest_where(
        [](const TurningPlace& a, const TurningPlace& b) { return a.node && a.node == b.node; });
    if (first != nullptr) return warn_of_cell(*first, *second);
    const auto [before, behind] = nearest_where([&](const TurningPlace& a, const TurningPlace& b) {
      return meet_beside_start(a, b) || meet_beside_end(a, b);
    });
    if (before != nullptr) warn_of_end(*before, *behind);
  }

 private:
  /// At a free end the outermost edge leans under what bends the rod there, and the edges of the
  /// next cell tell the tangent there with it.
  [[nodiscard]] bool meet_beside_start(const TurningPlace& a, const TurningPlace& b) const {
    return is_free(0) && a.node == 0 && b.at < middle(1) - line_.same_place();
  }
  [[nodiscard]] bool meet_beside_end(const TurningPlace& a, const TurningPlace& b) const {
    const int last = line_.num_nodes() - 1;
    return is_free(last) && b.node == last && a.at > middle(last - 2) + line_.same_place();
  }
  [[nodiscard]] bool is_free(int end) const {
    return !line_.closed() && line_.num_nodes() > 2 && context_.clamp_at(rod_, end) == nullptr;
  }
  [[nodiscard]] double longest_edge() const {
    double longest =
        line_.closed() ? line_.length() - line_.arc_length(line_.num_nodes() - 1) : 0.0;
    for (int node = 1; node < line_.num_nodes(); ++node) {
      longest = std::max(longest, line_.arc_length(node) - line_.arc_length(node - 1));
    }
    return longest;
  }
  /// Arc length of the middle of an edge [m].
  [[nodiscard]] double middle(int edge) const {
    return 0.5 * (line_.arc_length(edge) + line_.arc_length(edge + 1));
  }

  void enter_supports() {
    const auto& supports = context_.scene.supports;
    for (std::size_t i = 0; i < supports.size(); ++i) {
      const Support& support = supports[i];
      if (support.rod != name_) continue;
      if (resists_turning(support)) {
        enter(support.at, fmt::format("supports.{}.spring", i), true, true);
      } else if (is_bearing(support)) {
        enter(support.at, fmt::format("supports.{}.clamp", i), true, true);
      }
    }
  }

  void enter_loads() {
    const auto& loads = context_.scene.loads;
    for (std::size_t i = 0; i < loads.size(); ++i) {
      if (const auto* force = std::get_if<PointForce>(&loads[i].what)) {
        if (force->rod != name_ || !force->follower) continue;
        enter(force->at, fmt::format("loads.{}.point_force", i), false, true);
      } else if (const auto* moment = std::get_if<Moment>(&loads[i].what)) {
        if (moment->rod != name_) continue;
        const bool turns = moment->follower && model_ != ModelChoice::Planar;
        enter(moment->at, fmt::format("loads.{}.moment", i), true, turns);
      }
    }
  }

  void enter(const Location& at, std::string what, bool bends, bool feels) {
    if (at.kind == Location::Kind::All) return;
    double s = line_.arc_length_of(at);
    const std::optional<int> node = line_.cell_at(s);
    if (is_turned_by_clamp(s)) return;
    if (line_.closed() && node == 0 && s > 0.5 * line_.length()) s -= line_.length();
    places_.push_back({node, s, std::move(what), bends, feels});
  }

  /// Whether a clamp holds the section at a place, so that nothing else turns it.
  [[nodiscard]] bool is_turned_by_clamp(double s) const {
    const std::optional<int> node = line_.node_at(s);
    const Support* clamp = node ? context_.clamp_at(rod_, *node) : nullptr;
    return clamp != nullptr && !is_bearing(*clamp);
  }

  [[nodiscard]] bool is_bearing(const Support& support) const {
    if (model_ != ModelChoice::Spatial || support.clamp != Clamp::Tangent) return false;
    const double s = line_.arc_length_of(support.at);
    return line_.closed() || (s > line_.same_place() && line_.length() - s > line_.same_place());
  }

  void warn_of_cell(const TurningPlace& a, const TurningPlace& b) {
    warn(a, b, "no middle of an edge lies between them", line_.length() / (b.at - a.at));
  }
  void warn_of_end(const TurningPlace& a, const TurningPlace& b) {
    const double from_end = meet_beside_start(a, b) ? b.at : line_.length() - a.at;
    warn(a, b, "both act within an edge and a half of its free end",
         1.5 * line_.length() / from_end);
  }
  void warn(const TurningPlace& a, const TurningPlace& b, const char* where, double edges) {
    const double nodes = std::ceil(edges) + 1.0;
    // Straight planar rods are legs between joints in a scene that has any, and tell the two apart.
    const bool may_have_legs = model_ == ModelChoice::Planar && !context_.scene.in_space &&
                               context_.scene.given_rods[static_cast<std::size_t>(rod_)].nodes;
    context_.scene.warnings.push_back(fmt::format(
        "{} and {} act on rod '{}' within {:.3g} m, and {}: neither sees how the other bends the "
        "rod there. The error of the solution is then of first order in the length of the edges. "
        "Put both at one place{}{}",
        a.what, b.what, name_, b.at - a.at, where,
        may_have_legs
            ? fmt::format(", write 'joints: [{{name: here, of: [{{rod: {}, at: {:.6g}}}]}}]'",
                          name_, a.at)
            : std::string(),
        nodes <= kMostNodes ? fmt::format(", or give the rod about {:g} nodes", nodes)
                            : std::string()));
  }

  CheckContext& context_;
  int rod_;
  const std::string& name_;
  const RestLine& line_;
  ModelChoice model_;
  double two_edges_ = 2.0 * longest_edge();  // [m]
  std::vector<TurningPlace> places_;
};

}  // namespace

void check_cells(CheckContext& context, ModelChoice model) {
  for (int rod = 0; rod < static_cast<int>(context.lines.size()); ++rod) {
    CellCheck(context, rod, model).run();
  }
}

}  // namespace der::scenario
