#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "der/catalog/quantities.hpp"
#include "der/scenario/find_support.hpp"
#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"
#include "scenario/suggestion.hpp"

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

/// The number of what has a name in a list of the scene; nothing if none of its items has it.
template <class Item>
std::optional<int> find_by_name(const std::vector<Item>& items, const std::string& name) {
  const auto found =
      std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
  if (found == items.end()) return std::nullopt;
  return static_cast<int>(found - items.begin());
}

/// `what` is the word for an item: "actuation".
template <class Item>
std::string none_of_that_name(const char* what, const std::vector<Item>& items,
                              const std::string& name) {
  std::vector<std::string> names;
  for (const Item& item : items) {
    if (!item.name.empty()) names.push_back(item.name);
  }
  const std::string near = did_you_mean(name, names);
  return fmt::format("there is no {} '{}'{}", what, name,
                     !near.empty()   ? near
                     : names.empty() ? "; the scene has none with a name"
                                     : "; there is " + listed(names));
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
    } else if (probe_.leg) {
      report(path_ / "leg", fmt::format("'{}' is of a joint or a rod and has no 'leg': those that "
                                        "do are force_x, force_y and moment_z",
                                        probe_.quantity));
    } else if (probe_.support || probe_.actuation) {
      const bool of_support = probe_.support.has_value();
      report(path_ / (of_support ? "support" : "actuation"),
             fmt::format("'{}' is no quantity of {}: those are {}", probe_.quantity,
                         of_support ? "a support" : "an actuation",
                         fmt::join(quantities_of(of_support ? QuantityKind::Support
                                                            : QuantityKind::Actuation),
                                   ", ")));
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
    const auto& joints = context_.scene.joints;
    const auto joint = std::find_if(joints.begin(), joints.end(),
                                    [&](const Joint& each) { return each.name == *probe_.joint; });
    if (joint == joints.end()) {
      find_joint(context_, *probe_.joint, path_ / "joint");
    } else if (quantity == JointQuantity::Rotation) {
      if (joint->kind == JointKind::Rigid) return;
      report(path_ / "quantity",
             fmt::format("each rod has its own rotation in hinge '{}': take the 'slope' of a rod "
                         "there",
                         joint->name));
    } else if (!probe_.leg) {
      report(path_, fmt::format("'{}' is what one rod exerts on the joint: give 'leg', its name",
                                probe_.quantity));
    } else if (std::none_of(joint->of.begin(), joint->of.end(),
                            [&](const JointMember& member) { return member.rod == *probe_.leg; })) {
      report(path_ / "leg", fmt::format("rod '{}' is not in joint '{}'", *probe_.leg, joint->name));
    }
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

bool has_amounts(const Load& load) {
  return std::visit(
      [](const auto& what) { return HasAmounts<std::decay_t<decltype(what)>>::value; }, load.what);
}

bool moves(const Support& support) {
  return !support.prescribe.empty() || support.rotation || support.axis_rotation || support.twist;
}

/// The item that a path varies, "loads.0 (foundation)", or the scene if it varies all.
std::string item_in_words(const Scene& scene, const ContinuationAnalysis& path) {
  if (!path.number) return "the scene";
  if (path.vary == Varied::Supports) return fmt::format("supports.{}", *path.number);
  if (path.vary == Varied::Actuations) return fmt::format("actuation.{}", *path.number);
  const Load& load = scene.loads[static_cast<std::size_t>(*path.number)];
  return fmt::format("loads.{} ({})", *path.number, load_kinds()[load.what.index()]);
}

/// The names that a continuation can vary.
struct VariedKind {
  const char* key;     ///< of the list in the scene
  const char* scaled;  ///< what the factor scales, in words
  const char* remedy;  ///< where no item of the list has that
  std::size_t count;   ///< of the list's items
};

VariedKind varied_kind(const Scene& scene, Varied vary) {
  switch (vary) {
    case Varied::Loads:
      return {"loads", "force or moment", "add a force, a moment or gravity", scene.loads.size()};
    case Varied::Supports:
      return {"supports", "prescribed motion", "give a support 'prescribe'", scene.supports.size()};
    case Varied::Actuations:
      break;
  }
  return {"actuation", "change of a rest shape", "add an item to 'actuation'",
          scene.actuations.size()};
}

bool can_vary(const Scene& scene, Varied vary, std::size_t number) {
  switch (vary) {
    case Varied::Loads:
      return has_amounts(scene.loads[number]);
    case Varied::Supports:
      return moves(scene.supports[number]);
    case Varied::Actuations:
      break;
  }
  return true;
}

/// Puts the number of an item in place of its name; false, with a diagnostic, if there is none of
/// that name.
template <class Item>
bool number_varied(const char* what, const std::vector<Item>& items, const Path& path,
                   Diagnostics& diagnostics, ContinuationAnalysis& continuation) {
  if (continuation.name.empty()) return true;
  continuation.number = find_by_name(items, continuation.name);
  if (!continuation.number) {
    diagnostics.add(path, none_of_that_name(what, items, continuation.name));
  }
  return continuation.number.has_value();
}

bool number_varied(const Scene& scene, const Path& path, Diagnostics& diagnostics,
                   ContinuationAnalysis& continuation) {
  switch (continuation.vary) {
    case Varied::Loads:
      return number_varied("load", scene.loads, path, diagnostics, continuation);
    case Varied::Supports:
      return number_varied("support", scene.supports, path, diagnostics, continuation);
    case Varied::Actuations:
      break;
  }
  return number_varied("actuation", scene.actuations, path, diagnostics, continuation);
}

/// Whether what a continuation varies is there.
void check_continuation(CheckContext& context) {
  auto* continuation = std::get_if<ContinuationAnalysis>(&context.scene.analysis);
  if (!continuation || context.diagnostics.under({"analysis"})) return;
  const auto [kind, scaled, remedy, count] = varied_kind(context.scene, continuation->vary);
  if (context.diagnostics.under({kind})) return;
  const Path path{"analysis", "continuation", "vary"};
  if (!number_varied(context.scene, path, context.diagnostics, *continuation)) return;
  if (continuation->number && static_cast<std::size_t>(*continuation->number) >= count) {
    context.diagnostics.add(path,
                            fmt::format("there is no {}.{}: the scene has {} of them, counted "
                                        "from 0",
                                        kind, *continuation->number, count));
    return;
  }
  std::vector<std::string> others;
  for (std::size_t i = 0; i < count; ++i) {
    if (!can_vary(context.scene, continuation->vary, i)) continue;
    if (!continuation->number || static_cast<std::size_t>(*continuation->number) == i) return;
    others.push_back(fmt::format("{}.{}", kind, i));
  }
  const std::string hint =
      others.empty() ? remedy : fmt::format("write {}", fmt::join(others, " or "));
  context.diagnostics.add(path,
                          fmt::format("{} has no {} that the load factor could scale: {}",
                                      item_in_words(context.scene, *continuation), scaled, hint));
}

}  // namespace

void check_probes(CheckContext& context) {
  for (Probe& probe : context.scene.output.probes) {
    if (context.diagnostics.under({"output", "probes", probe.name})) continue;
    ProbeCheck(context, probe).run();
  }
}

}  // namespace der::scenario
