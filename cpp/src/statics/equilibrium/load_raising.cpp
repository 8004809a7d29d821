#include "statics/equilibrium/load_raising.hpp"

#include <algorithm>
#include <utility>

#include "der/model/edge_change.hpp"
#include "der/model/followed.hpp"

namespace der::statics {
namespace {

/// A step changes no edge by more than this [rad], so that it stays on the path of equilibria.
constexpr double kLargestChange = 1.0;
/// The search gives up when a step has shrunk to this share of the loads.
constexpr double kSmallestStep = 1.0 / 4096.0;

}  // namespace

std::optional<FailedSearch> raise_loads(const Model& model, const StaticLoads& loads,
                                        StaticNewton& newton, Shape& shape) {
  Shape now = shape;
  double done = 0.0;
  double step = 1.0;
  std::optional<FailedSearch> failed;
  while (done < 1.0) {
    Shape next = now;
    auto why = newton.balance(scaled(model, loads, done + step), next);
    const bool near =
        !why && largest_edge_change(model, next.positions - now.positions) <= kLargestChange &&
        turned_too_far(model, next.positions, loads.controls, now.followed) < 0;
    if (near) {
      now = std::move(next);
      done += step;
      step = std::min(2.0 * step, 1.0 - done);
      continue;
    }
    if (why) failed = std::move(why);
    step *= 0.5;
    if (step < kSmallestStep) {
      return failed ? failed : FailedSearch{EquilibriumFailure::StepsUsedUp, {}};
    }
  }
  shape = std::move(now);
  return std::nullopt;
}

}  // namespace der::statics
