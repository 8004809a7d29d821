#include "statics/equilibrium/load_raising.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "der/model/edge_change.hpp"
#include "der/model/followed.hpp"

namespace der::statics {
namespace {

/// A step changes no edge by more than this [rad], so that it stays on the path of equilibria.
constexpr double kLargestChange = 0.25;
/// The search gives up when a step has shrunk to this share of the loads.
constexpr double kSmallestShare = 1.0 / 4096.0;

/// Takes the loads to a share of them. Returns whether `shape` is now an equilibrium near the one
/// before; if not it stays as it was.
bool take_step(const Model& model, const StaticLoads& loads, double share, StaticNewton& newton,
               Shape& shape, std::optional<FailedSearch>& failed) {
  Shape next = shape;
  if (auto why = newton.balance(scaled(model, loads, share), next)) {
    failed = std::move(why);
    return false;
  }
  if (largest_edge_change(model, next.positions - shape.positions) > kLargestChange ||
      turned_too_far(model, next.positions, loads.controls, shape.followed) >= 0) {
    return false;
  }
  shape = std::move(next);
  return true;
}

/// The failure of a search that has raised the loads to this share of them; `last` is the last
/// reason that stopped a step, if it was not the change of the shape alone.
FailedSearch lost(double share, const std::optional<FailedSearch>& last) {
  if (last && last->cause != EquilibriumFailure::NewtonFailed) return *last;
  return {EquilibriumFailure::PathLost,
          fmt::format("the path of equilibria from the unloaded shape could be followed up to "
                      "{:.3f} times the loads only{}",
                      share, last ? ": " + last->detail : "")};
}

}  // namespace

std::optional<FailedSearch> raise_loads(const Model& model, const StaticLoads& loads,
                                        StaticNewton& newton, PseudoTransient& continuation,
                                        Shape& shape) {
  std::optional<FailedSearch> failed;
  if (take_step(model, loads, 1.0, newton, shape, failed)) return std::nullopt;

  Shape now = shape;
  const StaticLoads none = scaled(model, loads, 0.0);
  if (newton.balance(none, now)) {
    const double inverse_step = newton.force_scale() / model.size();
    if (auto why = continuation.run(none, inverse_step, now).failed) return why;
  }
  double step = 1.0;
  for (double done = 0.0; done < 1.0;) {
    if (take_step(model, loads, done + step, newton, now, failed)) {
      done += step;
      step = std::min(2.0 * step, 1.0 - done);
    } else if (step *= 0.5; step < kSmallestShare) {
      return lost(done, failed);
    }
  }
  shape = std::move(now);
  return std::nullopt;
}

}  // namespace der::statics
