#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"

namespace der::scenario {
namespace {

constexpr std::array kAxes{Hold::X, Hold::Y, Hold::Z};

/// Where a load acts: its rod, and the nodes at its place.
struct Where {
  int rod = -1;
  std::vector<int> nodes{};  ///< none for a place between nodes
};

/// The checks of one load. Names, places and tables are those that its kind declares in load.hpp;
/// `check_own` has what is particular to a kind.
class LoadCheck {
 public:
  LoadCheck(CheckContext& context, int number) : context_(context), number_(number) {}

  template <class Kind>
  void operator()(Kind& load) {
    const Path here{"loads", number_, Kind::kKey};
    check_tables(load, here);
    Where where;
    if constexpr (std::is_base_of_v<OnRod, Kind>) {
      const auto rod = context_.find_rod(load.rod, here / "rod");
      if (!rod) return;
      where.rod = *rod;
      check_place(load, here, where);
    }
    check_own(load, here, where);
  }

 private:
  template <class Kind>
  void check_tables(const Kind& load, const Path& here) {
    if (context_.scene.is_dynamic()) return;
    for_each_amount(load, [&](const char* key, const auto& amount) {
      if (amount.constant()) return;
      report(*key == '\0' ? here : here / key,
             "a static analysis has no time: give a constant in place of a table");
    });
  }

  void check_place(const OnRod& /*load*/, const Path& /*here*/, Where& /*where*/) {}
  void check_place(AtPlace& load, const Path& here, Where& where) {
    if (auto nodes = context_.nodes_at(where.rod, load.at, here / "at", false)) {
      where.nodes = std::move(*nodes);
    }
  }
  void check_place(OnPart& load, const Path& here, Where& where) {
    const RestLine& line = *context_.lines[static_cast<std::size_t>(where.rod)];
    if (load.from >= line.length()) {
      report(here / "from", fmt::format("must be less than the rod's length, {:.9g} m, got {} m",
                                        line.length(), load.from));
    }
    if (std::isfinite(load.to) && load.to > line.length() + line.same_place()) {
      report(here / "to", fmt::format("arc length {} m lies beyond the rod's length, {:.9g} m",
                                      load.to, line.length()));
    }
    load.to = std::min(load.to, line.length());
  }

  template <class Kind>
  void check_own(const Kind& /*load*/, const Path& /*here*/, const Where& /*where*/) {}

  void check_own(const Gravity& load, const Path& here, const Where& /*where*/) {
    check_single(load, here);
  }

  void check_own(const Fluid& load, const Path& here, const Where& /*where*/) {
    check_single(load, here);
    const auto& rods = context_.scene.rods;
    const bool spheres =
        std::any_of(rods.begin(), rods.end(), [](const Rod& rod) { return !rod.spheres.empty(); });
    if (!spheres && !context_.diagnostics.under({"rods"})) {
      report(here,
             "a fluid acts on spheres only, and no rod carries any: give a rod "
             "'spheres', or use 'damping'");
    }
  }

  void check_own(const Damping& load, const Path& here, const Where& /*where*/) {
    if (load.rod) context_.find_rod(*load.rod, here / "rod");
  }

  void check_own(const PointForce& load, const Path& here, const Where& where) {
    if (load.follower) {
      if (load.at.kind == Location::Kind::All) {
        report(here / "at",
               "'all' is not a single place, and a force that turns with the rod acts "
               "at one");
      } else if (!where.nodes.empty() && is_held(load, where)) {
        warn_of_taken(fmt::format("loads.{}.point_force", number_), load.rod, "position");
      }
      return;
    }
    if (!where.nodes.empty()) check_acts(load, where.rod, where.nodes);
  }

  void check_own(const Moment& load, const Path& /*here*/, const Where& where) {
    if (where.nodes.empty()) return;
    const Support* clamp = context_.clamp_at(where.rod, where.nodes.front());
    if (clamp == nullptr) return;
    const bool may_spin = clamp->clamp == Clamp::Tangent;
    if (context_.dimension == 3 && may_spin) return;  // the rod has the torque
    warn_of_taken(fmt::format("loads.{}.moment", number_), load.rod, "angle");
  }

  void report(const Path& where, const std::string& message) {
    context_.diagnostics.add(where, message);
  }

  /// Whether supports hold a node along all axes, wherever a force turns.
  [[nodiscard]] bool is_held(const PointForce& load, const Where& where) const {
    const HeldNode* holding = context_.held_at(where.rod, where.nodes.front());
    const auto components = static_cast<std::ptrdiff_t>(load.force.values.front().size());
    return holding != nullptr && std::all_of(kAxes.begin(), kAxes.begin() + components,
                                             [&](Hold axis) { return holding->holds(axis); });
  }

  /// Warns of a force on a held component: the support takes it.
  void check_acts(const PointForce& load, int rod, const std::vector<int>& nodes) {
    const std::size_t components = load.force.values.front().size();
    for (std::size_t c = 0; c < components; ++c) {
      const auto is_zero = [c](const Components& force) { return force[c] == 0.0; };
      if (std::all_of(load.force.values.begin(), load.force.values.end(), is_zero)) continue;
      const bool held = std::all_of(nodes.begin(), nodes.end(), [&](int node) {
        const HeldNode* holding = context_.held_at(rod, node);
        return holding && holding->holds(kAxes[c]);
      });
      if (held) {
        const char* axis = name_of(kAxes[c]);
        warn_of_taken(fmt::format("the {} component of loads.{}.point_force", axis, number_),
                      load.rod, axis);
      }
    }
  }

  void warn_of_taken(const std::string& what, const std::string& rod, const char* held) {
    context_.scene.warnings.push_back(
        fmt::format("{} acts on a node of rod '{}' whose {} a support holds: the support takes it "
                    "up without any effect on the rod",
                    what, rod, held));
  }

  /// Reports a second load of a kind that a scene can have only once.
  template <class Kind>
  void check_single(const Kind& /*load*/, const Path& here) {
    for (int i = 0; i < number_; ++i) {
      const Load& earlier = context_.scene.loads[static_cast<std::size_t>(i)];
      if (!std::holds_alternative<Kind>(earlier.what)) continue;
      if (context_.diagnostics.under({"loads", i})) continue;
      report(here, fmt::format("'{}' is given twice{}", Kind::kKey,
                               earlier.mark.line > 0
                                   ? fmt::format(" (first in line {})", earlier.mark.line)
                                   : std::string()));
      return;
    }
  }

  CheckContext& context_;
  int number_;
};

}  // namespace

void check_loads(CheckContext& context) {
  auto& loads = context.scene.loads;
  for (int i = 0; i < static_cast<int>(loads.size()); ++i) {
    if (context.diagnostics.under({"loads", i})) continue;
    std::visit(LoadCheck(context, i), loads[static_cast<std::size_t>(i)].what);
  }
}

}  // namespace der::scenario
