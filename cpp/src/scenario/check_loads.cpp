#include <algorithm>
#include <array>
#include <cmath>

#include "scenario/checks.hpp"

namespace der::scenario {
namespace {

/// The checks of one load; one function for each kind.
class LoadCheck {
 public:
  LoadCheck(CheckContext& context, int number) : context_(context), number_(number) {}

  void operator()(const Gravity& /*load*/) { check_single<Gravity>("gravity"); }

  void operator()(const Fluid& /*load*/) {
    check_single<Fluid>("fluid");
    const auto& rods = context_.scene.given_rods;
    const bool spheres = std::any_of(rods.begin(), rods.end(),
                                     [](const RodText& rod) { return !rod.spheres.empty(); });
    if (!spheres && !context_.complaints.under({"rods"})) {
      complain(path("fluid"),
               "a fluid acts on spheres only, and no rod carries any: give a rod "
               "'spheres', or use 'damping'");
    }
  }

  void operator()(const Damping& load) {
    if (load.rod) context_.find_rod(*load.rod, path("damping") / "rod");
  }

  void operator()(PointForce& load) {
    const Path here = path("point_force");
    check_constant(load.force.constant(), here / "force");
    const auto rod = context_.find_rod(load.rod, here / "rod");
    if (!rod) return;
    const auto nodes = context_.nodes_at(*rod, load.at, here / "at", false);
    if (nodes && !nodes->empty()) check_acts(load, *rod, *nodes);
  }

  void operator()(Moment& load) {
    const Path here = path("moment");
    check_constant(load.moment.constant(), here / "moment");
    const auto rod = context_.find_rod(load.rod, here / "rod");
    if (!rod) return;
    const auto nodes = context_.nodes_at(*rod, load.at, here / "at", false);
    if (!nodes || nodes->empty()) return;
    if (context_.is_clamped(*rod, nodes->front()))
      warn_of_taken(path_text("moment"), load.rod, "angle");
  }

  void operator()(DistributedForce& load) {
    const Path here = path("distributed_force");
    check_constant(load.force.constant(), here / "force");
    const auto rod = context_.find_rod(load.rod, here / "rod");
    if (!rod) return;
    const RestLine& line = *context_.lines[static_cast<std::size_t>(*rod)];
    if (load.from >= line.length()) {
      complain(here / "from", fmt::format("must be less than the rod's length, {:.9g} m, got {} m",
                                          line.length(), load.from));
    }
    if (std::isfinite(load.to) && load.to > line.length() + line.same_place()) {
      complain(here / "to", fmt::format("arc length {} m lies beyond the rod's length, {:.9g} m",
                                        load.to, line.length()));
    }
    load.to = std::min(load.to, line.length());
  }

 private:
  [[nodiscard]] Path path(const char* kind) const { return {"loads", number_, kind}; }
  [[nodiscard]] std::string path_text(const char* kind) const {
    return fmt::format("loads.{}.{}", number_, kind);
  }
  void complain(const Path& where, const std::string& message) {
    context_.complaints.add(where, message);
  }

  /// A force on what supports hold goes into them.
  void check_acts(const PointForce& load, int rod, const std::vector<int>& nodes) {
    constexpr std::array axes{Hold::X, Hold::Y};
    for (std::size_t c = 0; c < axes.size(); ++c) {
      const auto is_zero = [c](const Components& force) { return force[c] == 0.0; };
      if (std::all_of(load.force.values.begin(), load.force.values.end(), is_zero)) continue;
      const bool held = std::all_of(nodes.begin(), nodes.end(), [&](int node) {
        const HeldNode* holding = context_.held_at(rod, node);
        return holding && holding->holds(axes[c]);
      });
      if (held) {
        const char* axis = name_of(axes[c]);
        warn_of_taken(fmt::format("the {} component of {}", axis, path_text("point_force")),
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

  void check_constant(bool constant, const Path& where) {
    if (constant || context_.scene.is_dynamic()) return;
    complain(where, "a static analysis has no time: give a constant in place of a table");
  }

  /// Two of a kind where one is meant are a slip.
  template <class Kind>
  void check_single(const char* kind) {
    for (int i = 0; i < number_; ++i) {
      const Load& earlier = context_.scene.loads[static_cast<std::size_t>(i)];
      if (!std::holds_alternative<Kind>(earlier.what)) continue;
      if (context_.complaints.under({"loads", i})) continue;
      complain(path(kind), fmt::format("'{}' is given twice{}", kind,
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
    if (context.complaints.under({"loads", i})) continue;
    std::visit(LoadCheck(context, i), loads[static_cast<std::size_t>(i)].what);
  }
}

}  // namespace der::scenario
