#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"
#include "scenario/find_by_name.hpp"

namespace der::scenario {
namespace {

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

/// All prescribed motions are those of supports and of hinges.
bool drives_a_hinge(const Scene& scene) {
  return std::any_of(scene.joints.begin(), scene.joints.end(),
                     [](const Joint& joint) { return joint.prescribe.has_value(); });
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

}  // namespace

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
  if (continuation->vary == Varied::Supports && !continuation->number &&
      drives_a_hinge(context.scene)) {
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

}  // namespace der::scenario
