#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "der/catalog/quantities.hpp"
#include "der/scenario/find_support.hpp"
#include "scenario/checks.hpp"
#include "scenario/find_by_name.hpp"

namespace der::scenario {
namespace {

std::vector<std::string> quantities_of(QuantityKind kind) {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities()) {
    if (quantity.kind == kind) names.push_back(quantity.name);
  }
  return names;
}

/// "curvature, moment, strain and tension".
std::string quantities_that_jump() {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities()) {
    if (can_jump(quantity.kind)) names.push_back(quantity.name);
  }
  const auto last = names.end() - 1;
  return fmt::format("{} and {}", fmt::join(names.begin(), last, ", "), *last);
}

/// The quantities of actuations of one kind.
std::vector<std::string> quantities_of(Actuated what) {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities()) {
    if (quantity.actuates == key_of(what)) names.push_back(quantity.name);
  }
  return names;
}

/// Where a probe can stand, by the kind of its quantity.
class ProbeCheck {
 public:
  ProbeCheck(CheckContext& context, Probe& probe)
      : context_(context),
        probe_(probe),
        path_{"output", "probes", probe.name},
        supports_known_(!context.diagnostics.under({"supports"})) {}

  void run() {
    const Quantity& quantity = *find_quantity(probe_.quantity);
    const QuantityKind kind = quantity.kind;
    if (kind == QuantityKind::Support) {
      check_reaction();
    } else if (kind == QuantityKind::Actuation) {
      check_actuation(quantity.actuates);
    } else if (kind == QuantityKind::Joint) {
      check_joint(quantity.of_joint);
    } else if (kind == QuantityKind::Spring) {
      check_spring();
    } else if (probe_.leg) {
      report(path_ / "leg", fmt::format("'{}' is of a joint or a rod and has no 'leg': those that "
                                        "do are force_x, force_y and moment_z",
                                        probe_.quantity));
    } else if (probe_.spring) {
      report(
          path_ / "spring",
          fmt::format("'{}' is no quantity of a spring: those are spring_length and spring_force",
                      probe_.quantity));
    } else if (probe_.support || probe_.actuation) {
      const bool of_support = probe_.support.has_value();
      report(path_ / (of_support ? "support" : "actuation"),
             fmt::format("'{}' is no quantity of {}: those are {}", probe_.quantity,
                         of_support ? "a support" : "an actuation",
                         fmt::join(quantities_of(of_support ? QuantityKind::Support
                                                            : QuantityKind::Actuation),
                                   ", ")));
    } else if (probe_.joint && kind != QuantityKind::Position && kind != QuantityKind::Velocity) {
      report(path_, fmt::format("'{}' is not one for all rods of joint '{}': give 'rod' and 'at' "
                                "in place of 'joint'",
                                probe_.quantity, *probe_.joint));
    } else if (kind == QuantityKind::Energy) {
      check_energy();
    } else if (kind == QuantityKind::Ring) {
      check_ring();
    } else if (!probe_.rod) {
      report(path_, fmt::format("'{}' belongs to a rod: give 'rod'", probe_.quantity));
    } else if (!probe_.at && probe_.over == Reduce::None) {
      report(path_, fmt::format("'{}' varies along the rod: give 'at', or 'over: rod' with "
                                "'reduce: min' or 'max'",
                                probe_.quantity));
    } else if (const auto rod = context_.find_rod(*probe_.rod, path_ / "rod")) {
      check_along(*rod, kind);
    }
  }

 private:
  void report(const Path& where, const std::string& message) {
    context_.diagnostics.add(where, message);
  }

  void check_reaction() {
    const std::size_t count = context_.scene.supports.size();
    if (!probe_.support) {
      report(path_, fmt::format("'{}' belongs to a support: give 'support', its number{}",
                                probe_.quantity, in_place_of()));
    } else if (has_place("support")) {
      return;
    } else if (supports_known_ && !find_support(context_.scene, *probe_.support)) {
      report(path_ / "support",
             fmt::format("there is no support '{}': the scene has {} of them{}", *probe_.support,
                         count, count > 0 ? ", counted from 0" : ""));
    }
  }

  void check_joint(JointQuantity quantity) {
    if (!probe_.joint) {
      report(path_, fmt::format("'{}' belongs to a joint: give 'joint', its name{}",
                                probe_.quantity, in_place_of()));
      return;
    }
    if (probe_.over != Reduce::None || probe_.side) {
      report(path_ / (probe_.side ? "side" : "over"),
             fmt::format("'{}' has the place of its joint: leave this out", probe_.quantity));
      return;
    }
    const Joint* joint = find_joint(context_, *probe_.joint, path_ / "joint");
    if (joint == nullptr) return;
    if (quantity == JointQuantity::Angle) {
      if (joint->kind == JointKind::Hinge && joint->of.size() == 2) return;
      report(path_ / "quantity",
             fmt::format("'{}' is of a hinge of two rods, which joint '{}' is not", probe_.quantity,
                         joint->name));
    } else if (is_rotation(quantity)) {
      if (joint->kind == JointKind::Rigid) return;
      report(path_ / "quantity",
             fmt::format("each rod has its own rotation in {} '{}': take {} of a rod there",
                         in_words(joint->kind), joint->name,
                         joint->kind == JointKind::Ball ? "'tx', 'ty' and 'tz'" : "the 'slope'"));
    } else if (!probe_.leg) {
      report(path_, fmt::format("'{}' is what one rod exerts on the joint: give 'leg', its name",
                                probe_.quantity));
    } else if (std::none_of(joint->of.begin(), joint->of.end(),
                            [&](const JointMember& member) { return member.rod == *probe_.leg; })) {
      std::vector<std::string> rods;
      for (const JointMember& member : joint->of) rods.push_back(member.rod);
      report(path_ / "leg",
             fmt::format("rod '{}' is not in joint '{}', which has {}{}", *probe_.leg, joint->name,
                         fmt::join(rods, ", "), did_you_mean(*probe_.leg, rods)));
    }
  }

  void check_spring() {
    if (!probe_.spring) {
      report(path_,
             fmt::format("'{}' belongs to a spring between joints: give 'spring', its name{}",
                         probe_.quantity, in_place_of()));
      return;
    }
    if (has_place("joints") || context_.diagnostics.under({"springs"})) return;
    const auto& all = context_.scene.springs;
    if (find_by_name(all, *probe_.spring)) return;
    report(path_ / "spring", none_of_that_name("spring", all, *probe_.spring));
  }

  /// `key` is that of the actuations that have the quantity.
  void check_actuation(const std::string& key) {
    if (!probe_.actuation) {
      report(path_, fmt::format("'{}' belongs to an actuation: give 'actuation', its name{}",
                                probe_.quantity, in_place_of()));
      return;
    }
    if (has_place("actuation") || context_.diagnostics.under({"actuation"})) return;
    const auto& all = context_.scene.actuations;
    const auto number = find_by_name(all, *probe_.actuation);
    if (!number) {
      report(path_ / "actuation", none_of_that_name("actuation", all, *probe_.actuation));
      return;
    }
    const Actuated what = all[static_cast<std::size_t>(*number)].what;
    if (key_of(what) == key) return;
    report(path_ / "quantity",
           fmt::format("'{}' is a quantity of '{}', and '{}' has '{}': take '{}'", probe_.quantity,
                       key, *probe_.actuation, key_of(what),
                       fmt::join(quantities_of(what), "' or '")));
  }

  /// The key that stands in the place of the right one.
  [[nodiscard]] std::string in_place_of() const {
    return probe_.rod         ? " in place of 'rod'"
           : probe_.support   ? " in place of 'support'"
           : probe_.actuation ? " in place of 'actuation'"
           : probe_.joint     ? " in place of 'joint'"
           : probe_.spring    ? " in place of 'spring'"
                              : "";
  }

  /// Whether a place is given, which is an error.
  bool has_place(const char* owner) {
    if (!probe_.at && probe_.over == Reduce::None && !probe_.side) return false;
    report(path_ / (probe_.at     ? "at"
                    : probe_.side ? "side"
                                  : "over"),
           fmt::format("'{}' has the place of its {}: leave this out", probe_.quantity, owner));
    return true;
  }

  void check_energy() {
    if (probe_.at || probe_.over != Reduce::None) {
      report(path_ / (probe_.at ? "at" : "over"),
             fmt::format("'{}' is a sum over a rod or the whole model: it has no place",
                         probe_.quantity));
    }
    if (probe_.rod) context_.find_rod(*probe_.rod, path_ / "rod");
  }

  void check_ring() {
    if (!probe_.rod) {
      report(path_, fmt::format("'{}' belongs to a ring: give 'rod'", probe_.quantity));
    } else if (probe_.at || probe_.over != Reduce::None) {
      report(path_ / (probe_.at ? "at" : "over"),
             fmt::format("'{}' is a number of a whole ring: it has no place", probe_.quantity));
    } else if (const auto rod = context_.find_rod(*probe_.rod, path_ / "rod");
               rod && !context_.lines[static_cast<std::size_t>(*rod)]->closed()) {
      report(path_ / "quantity",
             fmt::format("rod '{}' is open, and only a ring has a '{}': for a ring write 'closed: "
                         "true'",
                         *probe_.rod, probe_.quantity));
    }
  }

  void check_along(int rod, QuantityKind kind) {
    if (probe_.side && !can_jump(kind)) {
      report(path_ / "side", fmt::format("'{}' has no sides: only {} jump", probe_.quantity,
                                         quantities_that_jump()));
    } else if (probe_.side && !probe_.at) {
      report(path_ / "side", "a side is that of a place: it goes with 'at'");
    }
    if (kind == QuantityKind::Turn) {
      check_turn(rod);
      return;
    }
    if (kind == QuantityKind::Bend || kind == QuantityKind::Natural) check_bend(rod);
    if (probe_.at) context_.nodes_at(rod, *probe_.at, path_ / "at", false);
  }

  /// A rod without bending stiffness has a curvature at its inner nodes alone.
  void check_bend(int rod) {
    const int nodes = context_.lines[static_cast<std::size_t>(rod)]->num_nodes();
    if (nodes > 2 || !does_not_bend(context_.scene.rods[static_cast<std::size_t>(rod)])) {
      return;
    }
    report(path_ / "quantity", fmt::format("a rod of 2 nodes without a stiffness against "
                                           "bending, EI, has no '{}'",
                                           probe_.quantity));
  }

  void check_turn(int rod) {
    const int last = context_.lines[static_cast<std::size_t>(rod)]->num_nodes() - 1;
    const bool closed = context_.lines[static_cast<std::size_t>(rod)]->closed();
    const auto bends = [&](int node) {
      return closed || (node > 0 && node < last) || !supports_known_ ||
             context_.is_clamped(rod, node);
    };
    if (!probe_.at) {
      if (last < 2 && !bends(0) && !bends(last)) {
        report(path_ / "quantity", fmt::format("a rod of 2 nodes without a clamp does not bend: "
                                               "it has no '{}'",
                                               probe_.quantity));
      }
      return;
    }
    const auto nodes = context_.nodes_at(rod, *probe_.at, path_ / "at", true);
    if (nodes && !bends(nodes->front())) {
      report(path_ / "at", fmt::format("'{}' needs a node that bends: an inner node, or an end "
                                       "that is clamped",
                                       probe_.quantity));
    }
  }

  CheckContext& context_;
  Probe& probe_;
  Path path_;
  bool supports_known_;  // otherwise nobody knows which ends are clamped
};

}  // namespace

void check_probes(CheckContext& context) {
  for (Probe& probe : context.scene.output.probes) {
    if (context.diagnostics.under({"output", "probes", probe.name})) continue;
    ProbeCheck(context, probe).run();
  }
}

}  // namespace der::scenario
